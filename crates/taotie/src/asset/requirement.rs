//! The requirements that a proof must meet.

use super::beyond::AskedLimits;
use super::figure::{Figure, FigureUnit, split};
use super::figures::Figures;
use super::level_figures::LevelFigures;
use super::met::{RequirementOutcome, length_unit, shown_unit};
use super::view_figures::ViewFigures;
use super::within;
use crate::error::{Error, Result};
use crate::length::Unit;
use crate::names::Named;
use crate::proof::{Estimate, Exceedance, Patch};
use std::borrow::Cow;
use std::str::FromStr;

/// A figure and its limit: a maximum, or a minimum for completeness, SSIM and the share within a limit. It applies to
/// one level of detail, or to every level that is shown at the figure's viewing distance.
///
/// ```
/// use taotie::asset::{Figure, Requirement};
///
/// assert_eq!("mean-angle=2".parse::<Requirement>()?, Requirement::mean_angle_deg(2.0));
/// assert_eq!("mean-angle@1=5°".parse::<Requirement>()?, Requirement::mean_angle_deg(5.0).at_level(1));
/// assert_eq!("missed=0.5".parse::<Requirement>()?, Requirement::missed(0.005), "per cent");
/// assert_eq!("hausdorff=0.25mm".parse::<Requirement>()?, Requirement::length(Figure::Hausdorff, 0.00025));
/// let within: Requirement = "within-5deg=99%".parse()?;
/// assert_eq!((within.within, within.most), (Some(5.0), 0.99), "at most 1 % of the surface is off by more");
/// assert!("mean-angle=2%".parse::<Requirement>().is_err(), "an angle is not a fraction");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Requirement {
    /// The limited figure.
    pub figure: Figure,
    /// The limit: degrees, ΔE, a fraction of 1, pixels, or bytes; metres if `is_length`.
    pub most: f64,
    /// `true` if the limit is a length, in metres.
    #[cfg_attr(feature = "serde", serde(default))]
    pub is_length: bool,
    /// The level of detail it applies to, 0 the finest; `None` for every level except those named by others for the
    /// same figure: as seen, each at its display size; otherwise, only those displayed close up. Figures of the whole
    /// asset have none.
    #[cfg_attr(feature = "serde", serde(default))]
    pub level: Option<usize>,
    /// For figures that are the share of the surface within a limit: that limit, in degrees, ΔE, or as a fraction of
    /// the diagonal.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub within: Option<f64>,
    /// `true` if the requirement is dropped when the scan specifies no colour and no material, so that there is
    /// nothing to compare.
    #[cfg_attr(feature = "serde", serde(default))]
    pub if_compared: bool,
}

impl Requirement {
    /// Requires a figure to be at most `most`, in its own unit: degrees, ΔE, a fraction of 1, pixels, metres or
    /// bytes.
    pub fn of(figure: Figure, most: f64) -> Self {
        let is_length = figure == Figure::Texel;
        Self { figure, most, is_length, level: None, within: None, if_compared: false }
    }

    /// Requires a distance, or the width of a texel, to be at most this many metres.
    pub fn length(figure: Figure, metres: f64) -> Self {
        Self { is_length: true, ..Self::of(figure, metres) }
    }

    /// Checks that a proof of a scan in this unit can decide all requirements.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a limit that is a length if the unit is unknown.
    pub fn check_unit(requirements: &[Self], unit: Option<Unit>) -> Result<()> {
        match requirements.iter().find(|requirement| requirement.is_length && unit.is_none()) {
            None => Ok(()),
            Some(requirement) => {
                let text = length_unit(requirement.most).text(requirement.most);
                let why = "the scan's file does not specify the unit of its coordinates; set it with --unit mm, cm, m or in \
                           (`unit` in Python and in collection.toml)";
                Err(Error::invalid(format!("the limit {}={text}", requirement.name()), why))
            }
        }
    }

    /// Returns the display unit of its limit.
    pub(super) fn unit(&self) -> FigureUnit {
        shown_unit(self.figure, self.most, self.is_length)
    }

    /// Requires a mean angle between normals of at most `most` degrees.
    pub fn mean_angle_deg(most: f64) -> Self {
        Self::of(Figure::MeanAngle, most)
    }

    /// Requires a mean CIEDE2000 difference of base colours of at most `most`; about 1 is just visible.
    pub fn mean_color(most: f64) -> Self {
        Self::of(Figure::MeanColor, most)
    }

    /// Requires that at most this fraction of the texels has a ray that missed, [0, 1].
    pub fn missed(most: f64) -> Self {
        Self::of(Figure::Missed, most)
    }

    /// Requires that the largest distance between the surfaces is at most this fraction of the diagonal.
    pub fn hausdorff(most: f64) -> Self {
        Self::of(Figure::Hausdorff, most)
    }

    /// Requires an asset of at most `most` bytes.
    pub fn bytes(most: u64) -> Self {
        Self::of(Figure::Bytes, most as f64)
    }

    /// Requires that at least the share `least` of the visible surface is within a limit: [`Figure::WithinAngle`] in
    /// degrees, [`Figure::WithinColor`] in ΔE, or [`Figure::WithinDistance`] as a fraction of the diagonal.
    pub fn within(figure: Figure, limit: f64, least: f64) -> Self {
        Self { within: Some(limit), ..Self::of(figure, least) }
    }

    /// Returns the same requirement for only one level of detail, 0 the finest.
    pub fn at_level(self, level: usize) -> Self {
        Self { level: Some(level), ..self }
    }

    /// Returns the name of the figure, including the limit if it is a share within one: `mean-angle`, `within-5deg`.
    pub fn name(&self) -> Cow<'static, str> {
        within::name_of(self.figure, self.within)
    }

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
        let has_color = figures.finest().is_none_or(|finest| finest.overview.color.is_some());
        if self.if_compared && !has_color {
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
            Figure::MeanColor => color.map(Value::mean),
            Figure::P95Color => color.map(Value::p95),
            Figure::PatchColor => patch(&level.patches.color).filter(|_| is_finite),
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

impl FromStr for Requirement {
    type Err = Error;

    /// Parses `mean-angle=2`, `mean-angle@1=5°`, `missed=0.1%`, `bytes=3MB` and the like.
    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let wrong = |why: &str| Error::invalid(format!("`{text}`"), why);
        let (name, most) = text
            .split_once('=')
            .ok_or_else(|| wrong("expected a figure and its limit, such as mean-angle=2"))?;
        let (name, level) = match name.split_once('@') {
            Some((name, level)) => (name.trim(), Some(level.trim())),
            None => (name.trim(), None),
        };
        let (figure, within) = match within::read(name).transpose().map_err(|why| wrong(&why))? {
            Some((figure, limit)) => (figure, Some(limit)),
            None => (Figure::from_name(name)?, None),
        };
        let level = level.map(|level| level_of(figure, level)).transpose().map_err(|why| wrong(&why))?;
        let (most, is_length) = most_of(figure, most.trim()).map_err(|why| wrong(&why))?;
        Ok(Self { level, is_length, within, ..Self::of(figure, most) })
    }
}

fn level_of(figure: Figure, level: &str) -> std::result::Result<usize, String> {
    if !figure.is_of_level() {
        return Err(format!("{} applies to the whole asset; omit @{level}", figure.name()));
    }
    let why = |_| format!("invalid level of detail `{level}`: 0 is the finest");
    level.parse().map_err(why)
}

/// Parses a number and its unit. Returns it in the unit of the figure itself, or in metres, and whether it is a
/// length.
fn most_of(figure: Figure, text: &str) -> std::result::Result<(f64, bool), String> {
    let (number, unit) = split(text);
    let number: f64 = number.parse().map_err(|_| format!("`{text}` is not a number"))?;
    let (size, is_length) = match unit {
        "" if figure == Figure::Texel => {
            return Err(format!("{text} has no unit; use a length such as 50um"));
        }
        "" => (figure.unit().size, false),
        unit => unit_size(figure, unit)?,
    };
    match number * size {
        most if most < 0.0 => Err(format!("{text} is below 0")),
        most if most.is_finite() => Ok((most, is_length)),
        _ => Err(format!("`{text}` is too large")),
    }
}

/// Returns the size of a unit, and whether it is one of length.
fn unit_size(figure: Figure, name: &str) -> std::result::Result<(f64, bool), String> {
    let known = || figure.units().map(|unit| unit.name).collect::<Vec<_>>().join(", ");
    let unit = figure.units().find(|unit| unit.name == name);
    let why =
        || format!("{} is not measured in {name}; use a bare number, or one in {}", figure.name(), known());
    let is_own = figure.own_units().iter().any(|unit| unit.name == name) && figure != Figure::Texel;
    unit.map(|unit| (unit.size, !is_own)).ok_or_else(why)
}

impl Figures {
    /// Compares each requirement with the measurements: a figure of levels of detail at every level, unless one is
    /// named. A figure that could not be measured, or a level that does not exist, is not met.
    pub fn require(&self, requirements: &[Requirement]) -> Vec<RequirementOutcome> {
        requirements.iter().flat_map(|requirement| requirement.against(self, requirements)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::level_figures::Resolution;
    use super::*;
    use crate::proof::DistanceBounds;

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
        figures.require(&[read(text).unwrap()]).iter().map(|met| met.met).collect()
    }

    #[test]
    fn requirements_are_read_with_their_units() {
        assert_eq!(read(" mean-angle = 2 ° ").unwrap(), Requirement::mean_angle_deg(2.0));
        assert_eq!(read("max-angle@2=20deg").unwrap(), Requirement::of(Figure::MaxAngle, 20.0).at_level(2));
        assert_eq!(read("missed=0.5").unwrap(), Requirement::missed(0.005), "per cent, as in the help");
        assert_eq!(read("missed=0.5%").unwrap(), read("missed=0.5").unwrap());
        assert_eq!(read("bytes=1e3").unwrap(), Requirement::bytes(1000));
    }

    #[test]
    fn wrong_requirements_name_what_would_be_right() {
        let cases = [
            ("mean-angle", "expected a figure and its limit"),
            ("mean-angle=2%", "mean-angle is not measured in %; use a bare number, or one in °, deg"),
            ("bytes=1%", "bytes is not measured in %; use a bare number, or one in B, kB, MB"),
            ("missed=3°", "missed is not measured in °"),
            ("beauty=3", "expected one of: mean-angle"),
            ("missed=-1", "-1 is below 0"),
            ("missed=x", "`x` is not a number"),
            ("missed=inf", "`inf` is not a number"),
            ("bytes=1e999", "too large"),
            ("texel=50", "50 has no unit; use a length such as 50um"),
            ("texel=1%", "texel is not measured in %; use a bare number, or one in m, um"),
            ("hausdorff=1km", "hausdorff is not measured in km; use a bare number, or one in %, um"),
            ("missed=1mm", "missed is not measured in mm"),
            ("mean-angle@x=1", "invalid level of detail `x`"),
            ("mean-angle@-1=1", "invalid level of detail `-1`"),
            ("within-angle=99%", "expected a limit in deg, dE or % of the diagonal"),
            ("within-5=99%", "expected a limit in deg, dE or % of the diagonal"),
            ("within--5deg=99%", "expected a limit in deg, dE or % of the diagonal"),
            ("within-0.2mm=99%", "expected a limit in deg, dE or % of the diagonal"),
            ("within-5deg=3°", "within-angle is not measured in °"),
            ("bytes@1=1", "bytes applies to the whole asset; omit @1"),
        ];
        for (text, why) in cases {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(why), "{text}: {error}");
        }
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
        let text = |text: &str| figures.require(&[read(text).unwrap()])[0].text();
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
        let met = figures.require(&[read("mean-angle=1").unwrap()]);
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
        let met: Vec<_> = figures.require(&all).iter().map(|met| (met.level, met.met)).collect();
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
        let met = |text: &str| figures.require(&[read(text).unwrap()])[0];
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
        let of = |text: &str| figures.require(&[read(text).unwrap()])[0];
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
        plain.patches.angle = Some(patch(3.0));
        let colored = plain.clone();
        plain.overview.color = None;
        let standard = Requirement::read("standard").unwrap();
        let count = |level: LevelFigures| figures(vec![level]).require(&standard).len();
        assert_eq!((count(plain.clone()), count(colored.clone())), (5, 7));
        assert!(figures(vec![plain]).require(&standard).iter().all(|met| met.met));
        let met = figures(vec![colored]).require(&standard);
        assert!(!met[6].met && met[6].value.is_none(), "no patch of colours was measured: {met:?}");
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
        let met = figures(vec![nowhere]).require(&[read("max-angle=180").unwrap()]);
        assert_eq!((met[0].met, met[0].text().as_str()), (false, "could not be measured, at most 180°"));
    }
}
