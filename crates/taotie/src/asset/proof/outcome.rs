//! The outcome of a requirement: its figure, compared with the limit.

use super::figures::{AskedLimits, Figures, LevelFigures, ViewFigures};
use crate::asset::ask::{
    Figure, FigureUnit, Lod, Looking, Requirement, name_within, shown_unit, title_within,
};
use std::borrow::Cow;
use taotie_engine::length::Unit;
use taotie_engine::proof::{Estimate, Exceedance, Patch};

/// The outcome of a requirement at one level of detail, or for the whole asset.
///
/// ```
/// use taotie::asset::RequirementOutcome;
///
/// /// Returns a line for each requirement that is not met.
/// fn shortfalls(met: &[RequirementOutcome]) -> Vec<String> {
///     let line = |met: &RequirementOutcome| format!("{}: {}", met.name(), met.text());
///     met.iter().filter(|met| !met.met).map(line).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct RequirementOutcome {
    /// The limited figure.
    pub figure: Figure,
    /// The limit: degrees, ΔE, a fraction of 1, pixels, or bytes; metres if `is_length`.
    pub most: f64,
    /// `true` if limit, value and interval are lengths in metres.
    #[serde(default)]
    pub is_length: bool,
    /// The level of detail, 0 the finest; `None` for a figure of the whole asset.
    pub level: Option<usize>,
    /// For figures that are the share of the surface within a limit: that limit, in degrees, ΔE, or as a fraction of
    /// the diagonal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// The figure's value; `None` if it could not be measured.
    pub value: Option<f64>,
    /// The bounds of the figure, with a confidence of 99 % if it is estimated from samples; equal if it is known
    /// exactly. `None` if it could not be measured.
    pub interval: Option<[f64; 2]>,
    /// `true` if the whole interval meets the limit.
    pub met: bool,
}

impl RequirementOutcome {
    /// Returns the name of the figure, like [`Requirement::name`].
    pub fn name(&self) -> Cow<'static, str> {
        name_within(self.figure, self.within)
    }

    /// Returns the figure's title, including the limit if it is a share within one: `normal error, mean`, `surface
    /// within a normal error of 5°`.
    pub fn title(&self) -> Cow<'static, str> {
        title_within(self.figure, self.within)
    }

    /// Returns `true` if the limit lies within the interval, so that more samples may decide it.
    pub fn is_undecided(&self) -> bool {
        let Some([low, high]) = self.interval else { return false };
        !self.met && if self.figure.is_at_least() { high >= self.most } else { low <= self.most }
    }

    /// Returns the factor by which to increase the samples so that they are likely to decide the requirement, since
    /// intervals shrink with the square root of their number: at least 2, or 1 if it is decided.
    pub fn samples_to_decide(&self) -> f64 {
        let (Some(value), Some([low, high]), true) = (self.value, self.interval, self.is_undecided()) else {
            return 1.0;
        };
        let ratio = (high - low) / 2.0 / (value - self.most).abs().max(f64::MIN_POSITIVE);
        (ratio * ratio).max(2.0)
    }

    /// Returns the display unit of value and limit: the figure's own, or a unit of length by the limit's size.
    pub fn unit(&self) -> FigureUnit {
        shown_unit(self.figure, self.most, self.is_length)
    }

    /// Returns value and limit in [`RequirementOutcome::unit`], such as `is 0.02 %, at most 0.1 %`. Both have all their digits if
    /// fewer would hide that the limit is exceeded.
    pub fn text(&self) -> String {
        let [value, limit] = self.value_and_limit();
        match (self.value, self.is_undecided()) {
            (None, _) => format!("could not be measured, {limit}"),
            (_, true) => format!("is undecided: {value}, {limit}"),
            _ => format!("is {value}, {limit}"),
        }
    }

    /// Returns name, value and limit for a list of several requirements, such as `missed 0.2 % (at most 0.1 %)`.
    pub(super) fn in_list(&self) -> String {
        let [value, limit] = self.value_and_limit();
        format!("{} {value} ({limit})", self.name())
    }

    /// Returns the value, or its bounds if the requirement is undecided, and the limit.
    fn value_and_limit(&self) -> [String; 2] {
        let (unit, most) = (self.unit(), self.most);
        let bound = if self.figure.is_at_least() { "at least" } else { "at most" };
        let (Some(value), Some(interval)) = (self.value, self.interval) else {
            return ["not measured".into(), format!("{bound} {}", unit.text(most))];
        };
        let [mut shown, mut limit] = [value, most].map(|number| unit.text(number));
        if self.is_undecided() {
            let [low, high] = interval.map(|number| unit.text(number));
            shown = format!("between {low} and {high}");
        } else if !self.met && shown == limit {
            [shown, limit] = [value, most].map(|number| unit.exact_text(number));
        }
        [shown, format!("{bound} {limit}")]
    }
}

impl Figures {
    /// Compares each requirement with the measurements: a figure of levels of detail at every level, unless one is
    /// named. A figure that could not be measured, or a level that does not exist, is not met.
    pub fn evaluate(&self, requirements: &[Requirement]) -> Vec<RequirementOutcome> {
        requirements.iter().flat_map(|requirement| requirement.against(self, requirements)).collect()
    }
}

impl Requirement {
    /// Compares the requirement with the measurements, level by level.
    fn against(&self, figures: &Figures, all: &[Self]) -> Vec<RequirementOutcome> {
        if !self.figure.is_of_level() {
            let bytes = match self.figure {
                Figure::GpuMemory => figures.gpu_bytes,
                _ => Some(figures.bytes_out),
            };
            let bytes = bytes.filter(|_| self.level.is_none()).map(|bytes| bytes as f64);
            let exactly = bytes.map(|value| Value { value, interval: [value; 2] });
            return vec![self.outcome(self.level, exactly)];
        }
        let is_compared = |LevelFigures { overview, .. }: &LevelFigures| match self.figure {
            Figure::MeanMaterial | Figure::PatchMaterial => overview.material.is_some(),
            _ => overview.color.is_some(),
        };
        if self.if_compared && !figures.finest().is_none_or(is_compared) {
            return Vec::new();
        }
        let levels = match self.level {
            Some(level) => vec![level],
            None => self.levels_of(figures, all),
        };
        let value = |level: &LevelFigures| match self.is_length {
            true => self.length_of(level, figures.unit?),
            false => self.value(level),
        };
        let outcome = |level| self.outcome(Some(level), figures.levels.get(level).and_then(value));
        levels.into_iter().map(outcome).collect()
    }

    /// Returns the levels to which it applies if it names none: those displayed at the distance of the figure. Levels
    /// for small objects are never seen close up.
    fn levels_of(&self, figures: &Figures, all: &[Self]) -> Vec<usize> {
        let is_anywhere = matches!(self.figure.looking(), Looking::Overview | Looking::Files);
        let is_whole = |level: &LevelFigures| level.overview.across >= Lod::FINEST as f32;
        let counts = |(number, level): &(usize, &LevelFigures)| {
            self.counts_at(*number, all) && (*number == 0 || is_anywhere || is_whole(level))
        };
        let levels = figures.levels.iter().enumerate().filter(counts).map(|(number, _)| number);
        if figures.levels.is_empty() { vec![0] } else { levels.collect() }
    }

    /// Returns the outcome for a figure and its interval.
    fn outcome(&self, level: Option<usize>, measured: Option<Value>) -> RequirementOutcome {
        let meets =
            |value: f64| if self.figure.is_at_least() { value >= self.most } else { value <= self.most };
        let (value, interval) = (measured.map(|of| of.value), measured.map(|of| of.interval));
        let met = interval.is_some_and(|interval| interval.into_iter().all(meets));
        let Self { figure, most, is_length, within, .. } = *self;
        RequirementOutcome { figure, most, is_length, level, within, value, interval, met }
    }

    /// Returns a length of a level in metres.
    fn length_of(&self, level: &LevelFigures, unit: Unit) -> Option<Value> {
        let [value, low, high] = match self.figure {
            Figure::Hausdorff => [level.hausdorff.upper, level.hausdorff.lower, level.hausdorff.upper],
            Figure::Silhouette => [level.silhouette.max_length; 3],
            Figure::Texel => [level.resolution?.texel; 3],
            _ => return None,
        }
        .map(|length| length * unit.metres());
        Some(Value { value, interval: [low, high] })
    }

    /// Returns a figure and its bounds, with a confidence of 99 % if it is estimated.
    fn value(&self, level: &LevelFigures) -> Option<Value> {
        let (angles, surface) = (level.overview.angles.as_ref(), level.surface_angles.as_ref());
        // Non-finite colours have an unbounded error; a mean over the others would hide it.
        let is_finite = level.material.not_finite == 0.0;
        let color = level.overview.color.as_ref().filter(|_| is_finite);
        let exactly = |value: Option<f64>| value.map(|value| Value { value, interval: [value; 2] });
        let patch =
            |patch: &Option<Patch>| patch.map(|patch| Value { value: patch.mean, interval: patch.interval });
        let coverage = &level.coverage;
        let bounds = level.hausdorff_of_diagonal;
        match self.figure {
            Figure::MeanAngle => angles.map(Value::mean),
            Figure::P95Angle => angles.map(Value::p95),
            Figure::MaxAngle => exactly(angles.map(|angles| angles.summary.max)),
            Figure::PatchAngle => patch(&level.patches.angle),
            Figure::PatchDetail => patch(&level.patches.detail),
            Figure::MeanColor => color.map(Value::mean),
            Figure::P95Color => color.map(Value::p95),
            Figure::PatchColor => patch(&level.patches.color).filter(|_| is_finite),
            Figure::MeanMaterial => level.overview.material.as_ref().filter(|_| is_finite).map(Value::mean),
            Figure::PatchMaterial => patch(&level.patches.material).filter(|_| is_finite),
            Figure::SurfaceMeanAngle => exactly(surface.map(|summary| summary.mean)),
            Figure::SurfaceP95Angle => exactly(surface.map(|summary| summary.p95)),
            Figure::SurfaceMaxAngle => exactly(surface.map(|summary| summary.max)),
            Figure::Missed => Some(Value { value: coverage.missed(), interval: coverage.missed_interval }),
            Figure::Completeness => exactly(Some(coverage.completeness)),
            Figure::WithinAngle => self.share_within(level.beyond.angle.as_ref(), 1.0),
            Figure::WithinColor => self.share_within(level.beyond.color.as_ref().filter(|_| is_finite), 1.0),
            Figure::WithinDistance => self.share_within(level.beyond.distance.as_ref(), PER_CENT),
            Figure::Hausdorff => Some(Value { value: bounds.upper, interval: [bounds.lower, bounds.upper] }),
            Figure::Silhouette => exactly(Some(level.silhouette.max_pixels)),
            Figure::Flip => exactly(mean_of(&level.views, |view| view.flip)),
            Figure::WorstView => exactly(level.views.iter().map(|view| view.flip).reduce(f64::max)),
            Figure::Ssim => exactly(level.views.iter().map(|view| view.ssim).reduce(f64::min)),
            Figure::Triangles => exactly(Some(level.triangles as f64)),
            Figure::Texel | Figure::Bytes | Figure::GpuMemory => None,
        }
    }

    /// Returns the share of the surface within the limit; `scale` converts the limit's unit to that of the curve.
    fn share_within(&self, curve: Option<&Exceedance>, scale: f64) -> Option<Value> {
        let beyond = curve?.beyond(self.within? * scale);
        let [low, high] = beyond.interval;
        Some(Value { value: 1.0 - beyond.value, interval: [1.0 - high, 1.0 - low] })
    }
}

/// Returns the limits of all requirements that are a share within one.
pub(super) fn asked_limits(requirements: &[Requirement]) -> AskedLimits {
    let of = |figure: Figure, scale: f64| {
        let those = requirements.iter().filter(|requirement| requirement.figure == figure);
        those.filter_map(|requirement| Some(requirement.within? * scale)).collect()
    };
    AskedLimits {
        angles: of(Figure::WithinAngle, 1.0),
        colors: of(Figure::WithinColor, 1.0),
        distances: of(Figure::WithinDistance, PER_CENT),
    }
}

/// Converts distances from fractions of the diagonal to the unit of their curve.
const PER_CENT: f64 = 100.0;

/// A figure and its interval.
#[derive(Clone, Copy)]
struct Value {
    value: f64,
    interval: [f64; 2],
}

impl Value {
    fn mean(estimate: &Estimate) -> Self {
        Self { value: estimate.summary.mean, interval: estimate.mean_interval }
    }

    fn p95(estimate: &Estimate) -> Self {
        Self { value: estimate.summary.p95, interval: estimate.p95_interval }
    }
}

fn mean_of(views: &[ViewFigures], figure: fn(&ViewFigures) -> f64) -> Option<f64> {
    let sum: f64 = views.iter().map(figure).sum();
    (!views.is_empty()).then(|| sum / views.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::super::figures::Resolution;
    use super::*;
    use taotie_engine::error::Result;
    use taotie_engine::names::Named;
    use taotie_engine::proof::DistanceBounds;

    fn read(text: &str) -> Result<Requirement> {
        text.parse()
    }

    /// A level with all angles equal to `degrees`, colours off by half as much, and a surface at this fraction of the
    /// diagonal from the scan.
    fn level(degrees: f32, hausdorff: f64) -> LevelFigures {
        let all = |value: f32| Estimate::of(&[value]).unwrap();
        let mut level = LevelFigures::default();
        (level.overview.angles, level.overview.color) = (all(degrees), all(degrees / 2.0));
        level.hausdorff_of_diagonal = DistanceBounds::exactly(hausdorff);
        level.hausdorff = DistanceBounds::exactly(180.0 * hausdorff);
        level.silhouette.max_length = 1.5;
        level.resolution = Some(Resolution { texel: 0.05, ..Resolution::default() });
        level.coverage.missed_interval = [0.001; 2];
        level
    }

    fn figures(levels: Vec<LevelFigures>) -> Figures {
        Figures { unit: Some(Unit::Millimetre), bytes_out: 3_000_000, levels, ..Figures::default() }
    }

    fn outcomes(text: &str, figures: &Figures) -> Vec<bool> {
        figures.evaluate(&[read(text).unwrap()]).iter().map(|met| met.met).collect()
    }

    /// For each figure and unit: a limit just above the measured value, and one just below.
    #[test]
    fn every_unit_holds_from_both_sides() {
        let figures = figures(vec![level(2.0, 0.005)]);
        let cases = [
            ("mean-angle=2.001", "mean-angle=1.999"),
            ("p95-angle=2.001°", "p95-angle=1.999°"),
            ("max-angle=2.001deg", "max-angle=1.999deg"),
            ("mean-color=1.001", "mean-color=0.999"),
            ("mean-color=1.001ΔE", "mean-color=0.999 ΔE"),
            ("p95-color=1.001ΔE00", "p95-color=0.999ΔE00"),
            ("missed=0.101", "missed=0.099"),
            ("missed=0.101%", "missed=0.099 %"),
            ("hausdorff=0.501", "hausdorff=0.499"),
            ("hausdorff=0.501%", "hausdorff=0.499%"),
            ("bytes=3000000", "bytes=2999999"),
            ("bytes=3000000B", "bytes=2999999B"),
            ("bytes=3000kB", "bytes=2999.999kB"),
            ("bytes=3MB", "bytes=2.999MB"),
            ("bytes=0.003GB", "bytes=0.002999GB"),
            ("bytes=2930KiB", "bytes=2929KiB"),
            ("bytes=2.87MiB", "bytes=2.86MiB"),
            ("hausdorff=0.91mm", "hausdorff=0.89mm"),
            ("hausdorff=910um", "hausdorff=890 µm"),
            ("hausdorff=0.091cm", "hausdorff=0.00089m"),
            ("hausdorff=0.036in", "hausdorff=0.035in"),
            ("silhouette=1.51mm", "silhouette=1.49mm"),
            ("texel=51um", "texel=49μm"),
            ("bytes=0.0028GiB", "bytes=0.0027GiB"),
        ];
        for (above, below) in cases {
            let both = (outcomes(above, &figures), outcomes(below, &figures));
            assert_eq!(both, (vec![true], vec![false]), "{above}, {below}");
        }
        let names = ["°", "deg", "ΔE", "ΔE00", "%", "px", "", "B", "kB", "MB", "GB", "KiB", "MiB", "GiB"];
        let lengths = ["um", "µm", "μm", "mm", "cm", "m", "in"];
        let names = [&names[..], &lengths[..]].concat();
        let mut known = Figure::NAMES.iter().flat_map(|(_, figure)| figure.units());
        assert!(known.all(|unit| names.contains(&unit.name)), "a unit is not tested");
    }

    #[test]
    fn lengths_are_shown_in_the_unit_of_their_limit() {
        let figures = figures(vec![level(2.0, 0.005)]);
        let text = |text: &str| figures.evaluate(&[read(text).unwrap()])[0].text();
        assert_eq!(text("hausdorff=0.2mm"), "is 0.9 mm, at most 0.2 mm");
        assert_eq!(text("hausdorff=1cm"), "is 0.9 mm, at most 10 mm");
        assert_eq!(text("texel=60um"), "is 50 µm, at most 60 µm");
        assert_eq!(text("texel@1=50um"), "could not be measured, at most 50 µm");
    }

    #[test]
    fn a_length_needs_a_scan_with_a_unit() {
        let lengths = read("hausdorff=0.2mm").unwrap();
        let error = Requirement::check_unit(&[lengths], None).unwrap_err().to_string();
        assert!(error.contains("hausdorff=0.2 mm") && error.contains("--unit"), "{error}");
        assert!(Requirement::check_unit(&[lengths], Some(Unit::Inch)).is_ok());
        assert!(Requirement::check_unit(&[read("hausdorff=0.2").unwrap()], None).is_ok());
        let unknown = Figures { unit: None, ..figures(vec![level(0.2, 0.0)]) };
        assert_eq!(outcomes("hausdorff=1m", &unknown), [false], "its size is unknown");
    }

    #[test]
    fn every_level_counts_unless_one_is_named() {
        let figures = figures(vec![level(0.2, 0.001), level(0.9, 0.002), level(5.0, 0.01)]);
        assert_eq!(outcomes("mean-angle=1", &figures), [true, true, false]);
        assert_eq!(outcomes("hausdorff=0.15", &figures), [true, false, false]);
        assert_eq!(outcomes("mean-angle@1=1", &figures), [true]);
        assert_eq!(outcomes("mean-angle@2=1", &figures), [false]);
        assert_eq!(outcomes("mean-angle@3=90", &figures), [false], "there is no such level");
        assert_eq!(outcomes("bytes=3MB", &figures), [true], "the asset has only one size");
        let met = figures.evaluate(&[read("mean-angle=1").unwrap()]);
        assert_eq!((met[2].level, met[2].text().as_str()), (Some(2), "is 5°, at most 1°"));
    }

    #[test]
    fn levels_for_small_objects_are_judged_as_seen() {
        let mut small = level(0.9, 0.01);
        small.overview.across = 64.0;
        let figures = figures(vec![level(0.2, 0.001), small]);
        assert_eq!(outcomes("mean-angle=0.5", &figures), [true, false]);
        assert_eq!(outcomes("hausdorff=0.15", &figures), [true], "it is never seen close up");
        assert_eq!(outcomes("hausdorff@1=0.15", &figures), [false], "unless it is named");
        let all = ["mean-angle=0.5", "mean-angle@1=1"].map(|text| read(text).unwrap());
        let met: Vec<_> = figures.evaluate(&all).iter().map(|met| (met.level, met.met)).collect();
        assert_eq!(met, [(Some(0), true), (Some(1), true)], "a level may have its own limit");
    }

    #[test]
    fn a_share_within_a_limit_is_at_least_what_is_demanded() {
        // 2 % of 10,000 points beyond 5°; 0.3 % beyond ΔE 3 and 1 % of the diagonal.
        let curve = |limit: f32, beyond: usize| {
            let values: Vec<f32> =
                (0..10_000).map(|i| if i < beyond { limit * 2.0 } else { limit / 2.0 }).collect();
            Exceedance::of([&values, &values], &[])
        };
        let mut of = level(1.0, 0.0);
        of.beyond.angle = curve(5.0, 200);
        (of.beyond.color, of.beyond.distance) = (curve(3.0, 30), curve(1.0, 30));
        let figures = figures(vec![of]);
        let verdict = |text: &str| outcomes(text, &figures)[0];
        assert_eq!(
            ["within-5deg=97%", "within-5°@0=97", "within-5deg=99%"].map(verdict),
            [true, true, false]
        );
        assert_eq!(["within-3dE=99%", "within-3ΔE=99.9%"].map(verdict), [true, false]);
        assert_eq!(["within-1%=99%", "within-1%=99.9%", "within-3%=99.9%"].map(verdict), [true, false, true]);
        let met = |text: &str| figures.evaluate(&[read(text).unwrap()])[0];
        assert_eq!(met("within-0.5%=99%").name(), "within-0.5%");
        assert_eq!(
            (met("within-5°=99%").name(), met("missed=1%").name()),
            ("within-5deg".into(), "missed".into())
        );
        assert_eq!(met("within-5deg=99%").text(), "is 98 %, at least 99 %");
        let titles = ["within-5deg=99%", "within-3dE=99%", "within-0.5%=99%", "missed=1%"]
            .map(|text| met(text).title().into_owned());
        let wanted = [
            "surface within a normal error of 5°",
            "surface within a colour error of 3 ΔE",
            "surface within a distance of 0.5 % of the diagonal",
            "visible surface that the other lacks",
        ];
        assert_eq!(titles, wanted);
        let near = met("within-5deg=98%");
        assert!(near.is_undecided() && !near.met, "the samples cannot decide: {near:?}");
    }

    #[test]
    fn a_value_just_above_its_limit_is_told_exactly() {
        let exactly = |value| Some(Value { value, interval: [value; 2] });
        let of = |figure, value| Requirement::of(figure, 1.0).outcome(Some(0), exactly(value)).text();
        assert_eq!(of(Figure::MeanAngle, 1.000_03), "is 1.00003°, at most 1°");
        assert_eq!(of(Figure::MeanAngle, 0.999_999), "is 1°, at most 1°");
        assert_eq!(of(Figure::MeanColor, 1.000_03), "is 1.00003 ΔE, at most 1 ΔE");
        let bytes = Requirement::of(Figure::Bytes, 999.5).outcome(None, exactly(1000.0));
        assert_eq!(bytes.text(), "is 1000 B, at most 999.5 B");
    }

    #[test]
    fn a_limit_within_the_interval_is_undecided() {
        let mut between = level(1.0, 0.005);
        between.hausdorff_of_diagonal.lower = 0.003;
        let figures = figures(vec![between]);
        let of = |text: &str| figures.evaluate(&[read(text).unwrap()])[0];
        assert_eq!(
            [of("hausdorff=0.6"), of("hausdorff=0.2")].map(|met| (met.met, met.is_undecided())),
            [(true, false), (false, false)]
        );
        let undecided = of("hausdorff=0.4");
        assert!(undecided.is_undecided() && !undecided.met);
        assert_eq!(undecided.text(), "is undecided: between 0.3 % and 0.5 %, at most 0.4 %");
        let complete = of("completeness=99%");
        assert_eq!((complete.met, complete.text().as_str()), (false, "is 0 %, at least 99 %"));
    }

    #[test]
    fn standard_drops_colours_that_nobody_states() {
        let mut plain = level(0.5, 0.001);
        plain.coverage.missed_interval = [0.0; 2];
        let patch = |mean: f64| Patch { mean, interval: [mean; 2], ..Patch::default() };
        (plain.patches.angle, plain.patches.detail) = (Some(patch(3.0)), Some(patch(0.1)));
        plain.overview.material.clone_from(&plain.overview.color);
        let colored = plain.clone();
        (plain.overview.color, plain.overview.material) = (None, None);
        let standard = Requirement::read("standard").unwrap();
        let count = |level: LevelFigures| figures(vec![level]).evaluate(&standard).len();
        assert_eq!((count(plain.clone()), count(colored.clone())), (6, 10));
        assert!(figures(vec![plain]).evaluate(&standard).iter().all(|met| met.met));
        let met = figures(vec![colored]).evaluate(&standard);
        assert!(!met[7].met && met[7].value.is_none(), "no patch of colours was measured: {met:?}");
    }

    #[test]
    fn what_was_not_measured_is_not_met() {
        assert_eq!(outcomes("mean-angle=180", &figures(Vec::new())), [false]);
        let nowhere = LevelFigures::default();
        assert_eq!(outcomes("mean-color=100", &figures(vec![nowhere.clone()])), [false]);
        let mut broken = level(0.2, 0.0);
        broken.material.not_finite = 0.01;
        assert_eq!(
            outcomes("mean-color=100", &figures(vec![broken])),
            [false],
            "some colours are not finite"
        );
        let met = figures(vec![nowhere]).evaluate(&[read("max-angle=180").unwrap()]);
        assert_eq!((met[0].met, met[0].text().as_str()), (false, "could not be measured, at most 180°"));
    }
}
