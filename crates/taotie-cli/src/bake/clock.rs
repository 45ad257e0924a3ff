//! The stages of a bake: the time of each, its progress, and the time left for all of them.
//!
//! The time left is estimated from the relative costs of the stages and the time of the completed ones.

use crate::console::Bar;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use taotie::asset::{BakeOptions, Lod, ScanSize, StageTime};
use taotie_engine::bake::MapKind;
use taotie_engine::surface::NoiseHandling;

/// Shows the progress of stages and the time left of all of them, and measures their times.
#[derive(Default)]
pub struct Clock {
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    done: Vec<StageTime>,
    running: Option<Running>,
    expected: Option<Expected>,
}

/// The stages to come.
struct Expected {
    schedule: Schedule,
    start: Instant,
}

/// The running stage.
struct Running {
    stage: &'static str,
    start: Instant,
    bar: Bar,
}

impl Clock {
    /// Sets the schedule of the stages to come.
    pub fn expect(&self, schedule: Schedule) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.expected = Some(Expected { schedule, start: Instant::now() });
    }

    /// Updates the fraction of a stage that is done.
    pub fn hear(&self, stage: &'static str, fraction: f64) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if !stage.is_empty() && state.running.as_ref().is_none_or(|running| running.stage != stage) {
            state.end();
            state.running = Some(Running { stage, start: Instant::now(), bar: Bar::new(stage) });
        }
        if let Some(running) = &state.running {
            running.bar.show(fraction, state.left(running.stage, fraction));
        }
    }

    /// Ends the running stage; returns all completed stages, in order.
    pub fn done(&self) -> Vec<StageTime> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.end();
        state.done.clone()
    }
}

impl State {
    /// Returns the time left of all stages.
    fn left(&self, stage: &str, fraction: f64) -> Option<Duration> {
        let Expected { schedule, start } = self.expected.as_ref()?;
        schedule.left(start.elapsed(), stage, fraction)
    }

    fn end(&mut self) {
        self.done.extend(self.running.take().map(|running| StageTime {
            stage: running.stage,
            milliseconds: running.start.elapsed().as_secs_f64() * 1e3,
        }));
    }
}

/// Fraction of the work to finish before estimating the remaining time.
const LEAST: f64 = 0.02;

/// The stages of a bake in order, each with its cost.
///
/// Costs are milliseconds measured on two cores. Only their proportions matter: the completed stages show how fast
/// the machine is.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    stages: Vec<(&'static str, f64)>,
}

/// The work of a bake, as far as its time depends on it.
struct Work<'a> {
    options: &'a BakeOptions,
    /// Millions of triangles of the scan.
    scan: f64,
    /// Millions of texels of a map.
    texels: f64,
    /// True if textures are packed smaller than PNG does.
    is_packed: bool,
}

impl Schedule {
    /// Makes the schedule of everything after reading the scan; `None` for a search, whose number of trials is
    /// unknown.
    pub fn of(options: &BakeOptions, scan: ScanSize, is_packed: bool) -> Option<Self> {
        if options.searches() {
            return None;
        }
        let options = &options.sized(scan);
        let texels = f64::from(options.size) * f64::from(options.height.unwrap_or(options.size)) / 1e6;
        let work = Work { options, scan: scan.triangles as f64 / 1e6, texels, is_packed };
        Some(Self { stages: work.making().into_iter().chain(work.writing()).chain(work.proving()).collect() })
    }

    /// Returns the time left after `elapsed`, with `fraction` of a stage done; `None` for stages that are not in the
    /// schedule, and before enough is done for an estimate.
    fn left(&self, elapsed: Duration, stage: &str, fraction: f64) -> Option<Duration> {
        let at = self.stages.iter().position(|(name, _)| *name == stage)?;
        let cost = |stages: &[(&str, f64)]| stages.iter().map(|(_, cost)| cost).sum::<f64>();
        let all = cost(&self.stages);
        let done = cost(&self.stages[..at]) + self.stages[at].1 * fraction.clamp(0.0, 1.0);
        (done > LEAST * all).then(|| elapsed.mul_f64((all - done).max(0.0) / done))
    }
}

impl Work<'_> {
    fn making(&self) -> Vec<(&'static str, f64)> {
        let (scan, texels) = (self.scan, self.texels);
        let made = if self.options.low.is_none() { 1.0 } else { 0.0 };
        let sort = ("sort the scan", 500.0 * scan);
        let lightening = match self.options.remesh {
            true => vec![sort, ("remesh the scan", 3000.0), ("simplify", 600.0)],
            false => vec![("simplify", 1200.0 * scan * made), sort],
        };
        let removes = self.options.noise == Some(NoiseHandling::Remove);
        let before = [
            ("join the scan", 5.0 + 100.0 * scan),
            ("read the low-poly mesh", 10.0 * (1.0 - made)),
            ("inspect the scan", if self.options.inspect { 200.0 * scan } else { 0.0 }),
            ("measure the noise", if self.options.noise.is_some() { 200.0 * scan } else { 0.0 }),
            ("remove the noise", if removes { 1500.0 * scan } else { 0.0 }),
        ];
        let after = [
            ("fit normals", 600.0 * made),
            ("unwrap", (200.0 + 900.0 * texels) * made),
            ("tangents", 10.0),
            ("measure the gap", 10.0 + 500.0 * scan),
            ("bake", texels * self.samples()),
            ("store", 100.0 * texels),
            ("levels of detail", self.levels()),
        ];
        before.into_iter().chain(lightening).chain(after).collect()
    }

    /// Returns the cost of a million texels: projection rays and lookups for each sample, and rays over the
    /// hemisphere.
    fn samples(&self) -> f64 {
        let is_sky = |map: &MapKind| {
            matches!(map, MapKind::Occlusion | MapKind::Bent | MapKind::Thickness | MapKind::Bevel)
        };
        let sky = if self.options.maps.iter().any(is_sky) { f64::from(self.options.ao_rays) } else { 0.0 };
        let material = if self.options.carry { 1000.0 } else { 0.0 };
        let samples = f64::from(self.options.side * self.options.side) / 4.0;
        samples * (500.0 + material + 250.0 * sky)
    }

    /// Returns the cost of coarser levels: for triangles, two maps of a quarter of the texels and views at a few
    /// sizes; for pixels, two maps per try.
    fn levels(&self) -> f64 {
        const TRIES: f64 = 9.0;
        let of_map = 0.25 * self.texels * self.samples() + 300.0;
        let tries = |level: &Lod| if matches!(level, Lod::Pixels(_)) { TRIES } else { 1.0 };
        self.options.lods.iter().map(|level| 1500.0 + tries(level) * of_map).sum()
    }

    fn writing(&self) -> [(&'static str, f64); 1] {
        [("write", 5.0 + self.texels * if self.is_packed { 2500.0 } else { 40.0 })]
    }

    fn proving(&self) -> Vec<(&'static str, f64)> {
        if !self.options.inspect {
            return Vec::new();
        }
        let coarser = self.options.lods.len() as f64;
        vec![
            ("read back", 30.0 * self.texels),
            ("measure normals", 600.0),
            ("map errors", 500.0 * self.texels.min(1.0)),
            ("measure levels", 150.0 * coarser),
            ("compare views", 1500.0 + 600.0 * coarser + 1000.0 * self.scan),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::asset::MeshSource;

    fn scan(triangles: u64) -> ScanSize {
        ScanSize { triangles, vertices: triangles / 2, ..ScanSize::default() }
    }

    fn schedule(options: &BakeOptions) -> Schedule {
        Schedule::of(options, scan(1_000_000), false).expect("not a search")
    }

    /// Simulates a bake in tenths of stages, each of which takes `pace` times its cost in milliseconds.
    /// Returns the estimated and the true time left, seconds.
    fn course(schedule: &Schedule, pace: impl Fn(&str) -> f64) -> Vec<[f64; 2]> {
        let time = |(name, cost): &(&'static str, f64)| cost * pace(name) * 1e-3;
        let all: f64 = schedule.stages.iter().map(time).sum();
        let (mut passed, mut estimates) = (0.0, Vec::new());
        for stage in &schedule.stages {
            for tenth in 0..=10 {
                let fraction = f64::from(tenth) / 10.0;
                let now = passed + time(stage) * fraction;
                let left = schedule.left(Duration::from_secs_f64(now), stage.0, fraction);
                estimates.extend(left.map(|left| [left.as_secs_f64(), all - now]));
            }
            passed += time(stage);
        }
        estimates
    }

    #[test]
    fn on_a_machine_of_any_speed_the_time_left_is_that_of_all_stages() {
        for pace in [0.5, 1.0, 7.0] {
            let estimates = course(&schedule(&BakeOptions::default()), |_| pace);
            assert!(estimates.len() > 50);
            for [estimate, truth] in estimates {
                assert!((estimate - truth).abs() < 1e-6, "{estimate} {truth}");
            }
        }
    }

    #[test]
    fn a_stage_that_takes_longer_than_foretold_is_made_up_for() {
        let slow = |stage: &str| if stage == "bake" { 3.0 } else { 1.0 };
        let estimates = course(&schedule(&BakeOptions::default()), slow);
        let [first, last] = [estimates[0], estimates[estimates.len() - 1]];
        assert!(first[0] < first[1], "{first:?}");
        assert!(last[0].abs() < 1e-6 && last[1].abs() < 1e-6, "{last:?}");
    }

    #[test]
    fn nothing_is_foretold_from_nothing() {
        let schedule = schedule(&BakeOptions::default());
        let second = Duration::from_secs(1);
        assert_eq!(schedule.left(second, "join the scan", 0.0), None);
        assert_eq!(schedule.left(second, "read the scan", 1.0), None);
        let search = BakeOptions { goal: Some(Vec::new()), ..BakeOptions::default() };
        assert_eq!(Schedule::of(&search, scan(1000), false), None);
    }

    #[test]
    fn more_work_takes_longer() {
        let cost = |options: &BakeOptions| schedule(options).stages.iter().map(|(_, cost)| cost).sum::<f64>();
        let plain = BakeOptions { carry: false, ..BakeOptions::default() };
        let sky = BakeOptions { maps: vec![MapKind::Normal, MapKind::Occlusion], ..plain.clone() };
        let fine = BakeOptions { size: 4096, ..plain.clone() };
        let given = BakeOptions { low: Some(MeshSource::File("low.glb".into())), ..plain.clone() };
        let blind = BakeOptions { inspect: false, ..plain.clone() };
        assert!(cost(&sky) > cost(&plain) && cost(&fine) > cost(&plain));
        assert!(cost(&given) < cost(&plain) && cost(&blind) < cost(&plain));
    }
}
