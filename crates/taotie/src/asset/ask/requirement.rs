//! Requirements: limits of figures that a proof must meet; as text for `--require`, and as lists with names.

use super::figure::{
    Figure, FigureUnit, length_unit, name_within, read_plain, read_within, shown_unit, split,
};
use super::lod::Lod;
use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;
use taotie_engine::error::{Error, Result};
use taotie_engine::length::Unit;
use taotie_engine::names::Named;
use taotie_io::CodecKind;

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
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Requirement {
    /// The limited figure.
    pub figure: Figure,
    /// The limit: degrees, ΔE, a fraction of 1, pixels, or bytes; metres if `is_length`.
    pub most: f64,
    /// `true` if the limit is a length, in metres.
    #[serde(default)]
    pub is_length: bool,
    /// The level of detail it applies to, 0 the finest; `None` for every level except those named by others for the
    /// same figure: as seen, each at its display size; otherwise, only those displayed close up. Figures of the whole
    /// asset have none.
    #[serde(default)]
    pub level: Option<usize>,
    /// For figures that are the share of the surface within a limit: that limit, in degrees, ΔE, or as a fraction of
    /// the diagonal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// `true` if the requirement is dropped when the scan specifies no colour and no material, so that there is
    /// nothing to compare.
    #[serde(default)]
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

    /// Checks that an asset with this number of levels of detail has those of all requirements.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a requirement of a level that does not exist.
    pub(in crate::asset) fn check_levels(requirements: &[Self], levels: usize) -> Result<()> {
        let number = |required: &Self| required.level.filter(|level| *level >= levels);
        match requirements.iter().find_map(|required| Some((required.name(), number(required)?))) {
            None => Ok(()),
            Some((name, level)) => Err(Error::invalid(
                format!("the requirement {name}@{level}"),
                format!("the coarsest level of detail of the asset is @{}", levels.saturating_sub(1)),
            )),
        }
    }

    /// Returns the display unit of its limit.
    fn unit(&self) -> FigureUnit {
        shown_unit(self.figure, self.most, self.is_length)
    }

    /// Requires a mean angle between normals of at most `most` degrees.
    pub fn mean_angle_deg(most: f64) -> Self {
        Self::of(Figure::MeanAngle, most)
    }

    /// Requires a mean colour difference of at most `most`, CIEDE2000; about 1 is just visible.
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
        name_within(self.figure, self.within)
    }

    /// Returns `true` if it applies to a level of detail, given all requirements: it names that level, or it names
    /// none and no other requirement for the same figure names that coarser level.
    pub(in crate::asset) fn counts_at(&self, level: usize, all: &[Self]) -> bool {
        let same = |other: &Self| (other.figure, other.within) == (self.figure, self.within);
        let is_replaced = || level > 0 && all.iter().any(|other| same(other) && other.level == Some(level));
        self.level == Some(level) || (self.level.is_none() && !is_replaced())
    }
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
        let (figure, within) = match read_within(name).transpose().map_err(|why| wrong(&why))? {
            Some((figure, limit)) => (figure, Some(limit)),
            None => (read_plain(name)?, None),
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

impl fmt::Display for Requirement {
    /// Writes the requirement so that parsing it gives the same one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit();
        let level = self.level.map_or_else(String::new, |level| format!("@{level}"));
        let name = match unit.name {
            "%" => "%",
            // ASCII, for easy typing.
            "µm" => "um",
            length if self.is_length => length,
            _ => "",
        };
        write!(f, "{}{level}={}{name}", self.name(), unit.shortest(self.most))
    }
}

/// Returns requirements as one argument of `--require`, with named sets by their name.
pub(in crate::asset) fn argument(requirements: &[Requirement]) -> String {
    let named = Requirement::named();
    let (mut texts, mut rest) = (Vec::new(), requirements);
    while let [first, others @ ..] = rest {
        (rest, _) = match named.iter().find(|(_, several)| rest.starts_with(several)) {
            Some((name, several)) => (&rest[several.len()..], texts.push((*name).to_owned())),
            None => (others, texts.push(first.to_string())),
        };
    }
    texts.join(",")
}

/// The maximum missed share of the surface in all named sets, [0, 1].
pub(in crate::asset) const MISSED: f64 = 0.001;
/// The maximum mean differences of the worst window in `standard`: degrees, and CIEDE2000.
pub(in crate::asset) const PATCH_DEG: f64 = 10.0;
pub(in crate::asset) const PATCH_COLOR: f64 = 3.0;
/// The maximum loss of detail in any window in all named sets.
pub(in crate::asset) const PATCH_DETAIL: f64 = 0.3;
/// The limit of metallic, roughness and occlusion in all named sets per ΔE of the limit of colours: see
/// docs/decisions/proof.md.
const MATERIAL_OF_COLOR: f64 = 0.04;
pub(in crate::asset) const PATCH_MATERIAL: f64 = PATCH_COLOR * MATERIAL_OF_COLOR;

/// Serde support for optional requirements: one argument of `--require`, or none.
pub(super) mod optional {
    use super::{Requirement, argument};
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<S: Serializer>(goal: &Option<Vec<Requirement>>, to: S) -> Result<S::Ok, S::Error> {
        goal.as_deref().map(argument).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<Requirement>>, D::Error> {
        let text = Option::<String>::deserialize(from)?;
        text.map(|text| Requirement::read(&text).map_err(D::Error::custom)).transpose()
    }
}

impl Requirement {
    /// Returns the requirements of `--require standard`: a mean angle of at most 1° and p95 of 5° as seen, no window
    /// of 1 % of the surface with more than 10° or ΔE 3 on average, at most 0.1 % missed, a Hausdorff distance of at
    /// most 1 % of the diagonal, a mean colour difference of at most ΔE 1, and differences of metallic, roughness and
    /// occlusion of at most 4 % on average and 12 % in any window. Limits of colours and materials hold only if they are
    /// compared.
    pub fn standard() -> Vec<Self> {
        let shape = [
            Self::mean_angle_deg(1.0),
            Self::of(Figure::P95Angle, 5.0),
            Self::of(Figure::PatchAngle, PATCH_DEG),
            Self::of(Figure::PatchDetail, PATCH_DETAIL),
            Self::missed(MISSED),
            Self::hausdorff(0.01),
        ];
        shape
            .into_iter()
            .chain(Self::of_looks(&[(Figure::MeanColor, 1.0), (Figure::PatchColor, PATCH_COLOR)]))
            .collect()
    }

    /// Returns limits of colours, CIEDE2000, and those of materials that belong to them; they hold only if colours are
    /// compared.
    fn of_looks(colors: &[(Figure, f64)]) -> impl Iterator<Item = Self> {
        let material = |(figure, most): &(Figure, f64)| {
            let figure = match figure {
                Figure::MeanColor => Figure::MeanMaterial,
                Figure::PatchColor => Figure::PatchMaterial,
                _ => return None,
            };
            Some((figure, most * MATERIAL_OF_COLOR))
        };
        let all: Vec<(Figure, f64)> =
            colors.iter().copied().chain(colors.iter().filter_map(material)).collect();
        all.into_iter().map(|(figure, most)| Self { if_compared: true, ..Self::of(figure, most) })
    }

    /// Returns the requirements of `--require visually-lossless`, the default goal of a bake: a mean angle of at most
    /// 0.5° and p95 of 2° as seen, at most 0.1 % missed, a Hausdorff distance of at most 1 % of the diagonal, a mean
    /// colour difference of at most ΔE 0.5 and p95 of 1.5, no window of 1 % of the surface with more than ΔE 3 on
    /// average, and differences of metallic, roughness and occlusion of at most 2 % on average and 12 % in any window.
    /// Limits of colours and materials hold only if they are compared.
    pub fn visually_lossless() -> Vec<Self> {
        Self::of_use([0.5, 2.0], 0.01, [0.5, 1.5, PATCH_COLOR])
    }

    /// Returns limits of the mean and p95 of angles, degrees, of missed surface, of the Hausdorff distance as a
    /// fraction of the diagonal, and of the mean, p95 and worst patch of colours, CIEDE2000, with those of materials. Those
    /// of colours and materials hold only if they are compared.
    fn of_use([mean, p95]: [f64; 2], hausdorff: f64, colors: [f64; 3]) -> Vec<Self> {
        let angles = [
            Self::mean_angle_deg(mean),
            Self::of(Figure::P95Angle, p95),
            Self::of(Figure::PatchDetail, PATCH_DETAIL),
        ];
        let shape = [Self::missed(MISSED), Self::hausdorff(hausdorff)];
        let [mean, p95, patch] = colors;
        let colors = [(Figure::MeanColor, mean), (Figure::P95Color, p95), (Figure::PatchColor, patch)];
        angles.into_iter().chain(shape).chain(Self::of_looks(&colors)).collect()
    }

    /// Returns the named sets of requirements; a set that begins with another is listed before it.
    fn named() -> Vec<(&'static str, Vec<Self>)> {
        let presets = Preset::NAMES.iter().map(|(name, preset)| (*name, preset.requirements()));
        let own = [("standard", Self::standard()), ("visually-lossless", Self::visually_lossless())];
        presets.chain(own).collect()
    }

    /// Parses comma-separated requirements, such as `mean-angle=2`, or names of sets: `standard` for
    /// [`Requirement::standard`], `visually-lossless` for [`Requirement::visually_lossless`], or the name of a
    /// [`Preset`], such as `web`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is neither.
    pub fn read(text: &str) -> Result<Vec<Self>> {
        let named = Self::named();
        let one = |text: &str| match named.iter().find(|(name, _)| *name == text.trim()) {
            Some((_, several)) => Ok(several.clone()),
            None => Ok(vec![text.parse()?]),
        };
        Ok(text.split(',').map(one).collect::<Result<Vec<_>>>()?.concat())
    }
}

/// A use of an asset: how close it must be to its scan, and how many device resources it may take.
///
/// ```
/// use taotie::asset::{BakeOptions, Preset};
///
/// let engine = Preset::Engine;
/// let (goal, images, lods) = (Some(engine.requirements()), engine.images(), engine.lods());
/// let options = BakeOptions { goal, images, lods, ..BakeOptions::default() };
/// assert!(options.check().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// Pages that load on a phone: 1° on average, at most 100,000 triangles and 80 MB on the graphics card.
    Web,
    /// Access copies of a collection: 0.1° on average, without ceilings.
    Archive,
    /// Real-time engines: 0.5° on average, at most 50,000 triangles and 32 MB on the graphics card, textures in KTX2,
    /// levels of detail for 256, 128 and 64 pixels across.
    Engine,
}

impl Named for Preset {
    const WHAT: &'static str = "preset";
    const NAMES: &'static [(&'static str, Self)] =
        &[("web", Self::Web), ("archive", Self::Archive), ("engine", Self::Engine)];
}

impl Preset {
    /// Returns the maximum differences and the ceilings.
    pub fn requirements(self) -> Vec<Requirement> {
        let ceilings = |triangles: f64, megabytes: f64| {
            let gpu_memory = Requirement::of(Figure::GpuMemory, megabytes * 1e6);
            vec![Requirement::of(Figure::Triangles, triangles), gpu_memory]
        };
        match self {
            Self::Web => {
                [Requirement::of_use([1.0, 4.0], 0.01, [1.0, 3.0, 6.0]), ceilings(100_000.0, 80.0)].concat()
            }
            Self::Archive => Requirement::of_use([0.1, 0.4], 0.0025, [0.2, 0.5, 1.0]),
            Self::Engine => [Requirement::visually_lossless(), ceilings(50_000.0, 32.0)].concat(),
        }
    }

    /// Returns the coarser levels of detail.
    pub fn lods(self) -> Vec<Lod> {
        match self {
            Self::Web | Self::Archive => Vec::new(),
            Self::Engine => [256, 128, 64].map(Lod::Pixels).to_vec(),
        }
    }

    /// Returns the image formats to choose from; empty for those of the codec set.
    pub fn images(self) -> Vec<CodecKind> {
        match self {
            Self::Web | Self::Archive => Vec::new(),
            Self::Engine => vec![CodecKind::Ktx2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Requirement> {
        text.parse()
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
            ("beauty=3", "completeness, within-5deg, within-3dE, within-0.5%, hausdorff"),
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

    #[test]
    fn every_offered_name_is_accepted() {
        let error = read("beauty=3").unwrap_err().to_string();
        let (_, names) = error.split_once("expected one of: ").unwrap();
        for name in names.split(", ") {
            let limit = if name == "texel" { "50um" } else { "1" };
            assert!(read(&format!("{name}={limit}")).is_ok(), "{name}");
        }
        assert_eq!(names.split(", ").count(), Figure::NAMES.len());
    }

    #[test]
    fn what_is_written_reads_back() {
        let lists = [
            "standard",
            "bytes=3000000,standard,flip=0.02",
            "standard,visually-lossless",
            "web",
            "engine,archive,triangles=10",
            "hausdorff=0.2mm,texel=50um,silhouette=15mm",
            "within-5deg=99%,within-3.1234567dE=99.9%,within-0.3%@1=95%",
            "mean-angle=2,p95-angle@1=5.5,missed=0.1%,completeness=99.95%,hausdorff=0.3%,silhouette=2,ssim=0.97",
        ];
        for list in lists {
            let requirements = Requirement::read(list).unwrap();
            assert_eq!(argument(&requirements), list);
            assert_eq!(Requirement::read(&argument(&requirements)).unwrap(), requirements);
        }
    }
}
