//! The stages of a bake: the time of each, and its progress.

use super::schedule::Schedule;
use crate::console::Bar;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use taotie::asset::StageTime;

/// Hears of stages, shows how far they are and how long all of them will take, and measures them.
#[derive(Default)]
pub struct Clock {
    told: Mutex<Told>,
}

#[derive(Default)]
struct Told {
    done: Vec<StageTime>,
    running: Option<Running>,
    expected: Option<Expected>,
}

/// The stages to come.
struct Expected {
    schedule: Schedule,
    start: Instant,
}

/// The stage that runs.
struct Running {
    stage: &'static str,
    start: Instant,
    bar: Bar,
}

impl Clock {
    /// Expects the stages of a schedule from now on.
    pub fn expect(&self, schedule: Schedule) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.expected = Some(Expected { schedule, start: Instant::now() });
    }

    /// Hears that a fraction of a stage is done.
    pub fn hear(&self, stage: &'static str, fraction: f64) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if !stage.is_empty() && told.running.as_ref().is_none_or(|running| running.stage != stage) {
            told.end();
            told.running = Some(Running { stage, start: Instant::now(), bar: Bar::new(stage) });
        }
        if let Some(running) = &told.running {
            running.bar.tell(fraction, told.left(running.stage, fraction));
        }
    }

    /// Ends the stage that runs; gives back all stages that are done, in order.
    pub fn done(&self) -> Vec<StageTime> {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.end();
        told.done.clone()
    }
}

impl Told {
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
