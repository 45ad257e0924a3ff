//! The figures that limits can be set for: their names, units and titles, and how each compares scan and asset.

use std::borrow::Cow;
use taotie_engine::error::{Error, Result};
use taotie_engine::length;
use taotie_engine::names::Named;

/// A figure of a proof that a limit can be set for.
///
/// ```
/// use taotie::asset::{Figure, Requirement};
/// use taotie_engine::names::Named;
///
/// let figure = Figure::from_name("p95-angle")?;
/// assert_eq!("p95-angle=3".parse::<Requirement>()?, Requirement::of(figure, 3.0));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Figure {
    /// As seen: the mean angle between normals at the same pixel of the overview, degrees; of each level of detail.
    MeanAngle,
    /// As seen: the angle that 95 % of the pixels stay below, degrees; of each level.
    P95Angle,
    /// As seen: the largest angle of the pixels that were compared, degrees; of each level.
    MaxAngle,
    /// As seen close up: the mean angle in the worst window of 1 % of the surface, degrees; of each level.
    PatchAngle,
    /// As seen close up: the differences of normals, or of base colours, relative to their variation on the scan, in the worst
    /// window of 1 % of the surface: 0 if all detail is there, about 1 if none is; of each level.
    PatchDetail,
    /// As seen: the mean colour difference at the same pixel, CIEDE2000; of each level.
    MeanColor,
    /// As seen: the colour difference that 95 % of the pixels stay below, CIEDE2000; of each level.
    P95Color,
    /// As seen close up: the mean colour difference in the worst window of 1 % of the surface, CIEDE2000; of
    /// each level.
    PatchColor,
    /// As seen: the mean difference of metallic, roughness or occlusion at the same pixel, whichever is largest, as a
    /// fraction of the largest number; of each level. Occlusion counts if the scan has a texture of it.
    MeanMaterial,
    /// As seen close up: the same in the worst window of 1 % of the surface; of each level.
    PatchMaterial,
    /// On the surface: the mean angle between normals, degrees; of each level.
    SurfaceMeanAngle,
    /// On the surface: the angle that 95 % of the points stay below, degrees; of each level.
    SurfaceP95Angle,
    /// On the surface: the largest angle of the points that were compared, degrees; of each level.
    SurfaceMaxAngle,
    /// The share of the visible surface where the other surface shows nothing, the worse of scan and asset; of each
    /// level.
    Missed,
    /// The smallest share of the scan's visible area within half a per cent of the diagonal of the asset; of each
    /// level.
    Completeness,
    /// As seen close up: the smallest share of the visible surface whose angle between normals is at most
    /// [`Requirement::within`](super::Requirement::within), the worse of scan and asset; of each level.
    WithinAngle,
    /// The same for the colour difference; of each level.
    WithinColor,
    /// The same for the distance to the other surface, as a fraction of the diagonal; of each level.
    WithinDistance,
    /// The largest distance between the visible surfaces, as a fraction of the diagonal, its upper bound; of each
    /// level.
    Hausdorff,
    /// The largest deviation of outlines, in pixels, with 512 across the object; of each level.
    Silhouette,
    /// The median width of the asset's finest texels on the surface, metres; of each level.
    Texel,
    /// The mean FLIP over the images from all sides; of each level.
    Flip,
    /// The largest mean FLIP among these images; of each level.
    WorstView,
    /// The lowest structural similarity (SSIM) among these images; of each level.
    Ssim,
    /// Triangles; of each level of detail.
    Triangles,
    /// Bytes that the asset's vertices and textures take on a graphics card, with mip levels: four per texel, one for
    /// KTX2.
    GpuMemory,
    /// Bytes of the asset, including the files that it references.
    Bytes,
}

impl Named for Figure {
    const WHAT: &'static str = "figure";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("mean-angle", Self::MeanAngle),
        ("p95-angle", Self::P95Angle),
        ("max-angle", Self::MaxAngle),
        ("patch-angle", Self::PatchAngle),
        ("patch-detail", Self::PatchDetail),
        ("mean-color", Self::MeanColor),
        ("p95-color", Self::P95Color),
        ("patch-color", Self::PatchColor),
        ("mean-material", Self::MeanMaterial),
        ("patch-material", Self::PatchMaterial),
        ("surface-mean-angle", Self::SurfaceMeanAngle),
        ("surface-p95-angle", Self::SurfaceP95Angle),
        ("surface-max-angle", Self::SurfaceMaxAngle),
        ("missed", Self::Missed),
        ("completeness", Self::Completeness),
        ("within-angle", Self::WithinAngle),
        ("within-color", Self::WithinColor),
        ("within-distance", Self::WithinDistance),
        ("hausdorff", Self::Hausdorff),
        ("silhouette", Self::Silhouette),
        ("texel", Self::Texel),
        ("flip", Self::Flip),
        ("worst-view", Self::WorstView),
        ("ssim", Self::Ssim),
        ("triangles", Self::Triangles),
        ("gpu-memory", Self::GpuMemory),
        ("bytes", Self::Bytes),
    ];
}

/// The samples from which a figure is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::asset) enum Sampling {
    /// Pixels of the overview.
    Overview,
    /// Points of both surfaces, seen close up.
    CloseUp,
    /// Pieces of triangles whose distances bound the largest one.
    Distance,
}

/// The way in which a figure compares scan and asset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Looking {
    /// As seen, at the same pixel of both, with the whole object in view.
    Overview,
    /// As seen close up, at the resolution of the scan's detail.
    CloseUp,
    /// Point by point along the projection rays of a bake.
    OnTheSurface,
    /// The shapes themselves.
    Shape,
    /// Images from all sides in one grey material.
    Images,
    /// The files.
    Files,
}

impl Looking {
    /// Returns the way of comparing in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Overview => "overview",
            Self::CloseUp => "close-up",
            Self::OnTheSurface => "on the surface",
            Self::Shape => "shape",
            Self::Images => "images",
            Self::Files => "files",
        }
    }
}

impl Figure {
    /// Returns the way in which the figure compares scan and asset.
    pub fn looking(self) -> Looking {
        self.described().0
    }

    /// Returns the figure's title, such as `normal error, mean`.
    pub fn title(self) -> &'static str {
        self.described().1
    }

    fn described(self) -> (Looking, &'static str) {
        match self {
            Self::MeanAngle => (Looking::Overview, "normal error, mean"),
            Self::P95Angle => (Looking::Overview, "normal error, 95 %"),
            Self::MaxAngle => (Looking::Overview, "normal error, largest sampled"),
            Self::PatchAngle => (Looking::CloseUp, "normal error, mean in the worst 1 % of the surface"),
            Self::PatchDetail => (Looking::CloseUp, "detail lost in the worst 1 % of the surface"),
            Self::MeanColor => (Looking::Overview, "colour error, mean"),
            Self::P95Color => (Looking::Overview, "colour error, 95 %"),
            Self::PatchColor => (Looking::CloseUp, "colour error, mean in the worst 1 % of the surface"),
            Self::MeanMaterial => {
                (Looking::Overview, "material error (metallic, roughness, occlusion), mean")
            }
            Self::PatchMaterial => (Looking::CloseUp, "material error, mean in the worst 1 % of the surface"),
            Self::SurfaceMeanAngle => (Looking::OnTheSurface, "normal error, mean"),
            Self::SurfaceP95Angle => (Looking::OnTheSurface, "normal error, 95 %"),
            Self::SurfaceMaxAngle => (Looking::OnTheSurface, "normal error, largest sampled"),
            Self::Missed => (Looking::CloseUp, "visible surface that the other lacks"),
            Self::Completeness => (Looking::Shape, "scan within 0.5 % of the diagonal of the asset"),
            Self::WithinAngle => (Looking::CloseUp, "surface within a normal error"),
            Self::WithinColor => (Looking::CloseUp, "surface within a colour error"),
            Self::WithinDistance => (Looking::Shape, "surface within a distance"),
            Self::Hausdorff => (Looking::Shape, "largest distance (Hausdorff), proven bound"),
            Self::Silhouette => (Looking::Shape, "outline, largest deviation"),
            Self::Texel => (Looking::CloseUp, "texel of the asset, median width"),
            Self::Flip => (Looking::Images, "visual difference in grey (FLIP), mean"),
            Self::WorstView => (Looking::Images, "visual difference in grey (FLIP), worst view"),
            Self::Ssim => (Looking::Images, "structural similarity (SSIM), worst view"),
            Self::Triangles => (Looking::Files, "triangles"),
            Self::GpuMemory => (Looking::Files, "GPU memory"),
            Self::Bytes => (Looking::Files, "size of the asset"),
        }
    }

    /// Returns the samples whose number narrows the figure's interval; `None` for figures without an interval.
    pub(in crate::asset) fn sampling(self) -> Option<Sampling> {
        match self {
            Self::MeanAngle | Self::P95Angle | Self::MeanColor | Self::P95Color | Self::MeanMaterial => {
                Some(Sampling::Overview)
            }
            Self::PatchAngle
            | Self::PatchDetail
            | Self::PatchColor
            | Self::PatchMaterial
            | Self::Missed
            | Self::WithinAngle
            | Self::WithinColor
            | Self::WithinDistance => Some(Sampling::CloseUp),
            Self::Hausdorff => Some(Sampling::Distance),
            _ => None,
        }
    }

    /// Returns all units that its limit may be written in: its own, with the default for bare numbers first, and
    /// those of length.
    pub(in crate::asset) fn units(self) -> impl Iterator<Item = FigureUnit> {
        let lengths = length::OF_LIMITS.iter().map(|(name, metres)| unit(name, *metres));
        self.own_units().iter().copied().chain(lengths.filter(move |_| self.has_length()))
    }

    /// Returns the figure's own units.
    pub(super) fn own_units(self) -> &'static [FigureUnit] {
        match self {
            Self::MeanAngle | Self::P95Angle | Self::MaxAngle | Self::PatchAngle => DEGREES,
            Self::SurfaceMeanAngle | Self::SurfaceP95Angle | Self::SurfaceMaxAngle => DEGREES,
            Self::MeanColor | Self::P95Color | Self::PatchColor => COLOR,
            Self::PatchDetail | Self::MeanMaterial | Self::PatchMaterial => PER_CENT,
            Self::Missed | Self::Completeness | Self::Hausdorff => PER_CENT,
            Self::WithinAngle | Self::WithinColor | Self::WithinDistance => PER_CENT,
            Self::Silhouette => PIXELS,
            Self::Texel => METRES,
            Self::Flip | Self::WorstView | Self::Ssim | Self::Triangles => NUMBER,
            Self::Bytes | Self::GpuMemory => BYTES,
        }
    }

    /// Returns the unit it is reported in, also the default for bare numbers: degrees, ΔE, per cent, pixels, metres
    /// or bytes.
    pub fn unit(self) -> FigureUnit {
        self.own_units()[0]
    }

    /// Returns `true` if its limit may be a length, which needs a scan with a known unit.
    pub fn has_length(self) -> bool {
        matches!(self, Self::Hausdorff | Self::Silhouette | Self::Texel)
    }

    /// Returns `true` if each level of detail has its own value, `false` if there is one for the whole asset.
    pub fn is_of_level(self) -> bool {
        !matches!(self, Self::Bytes | Self::GpuMemory)
    }

    /// Returns `true` if more is better, so that a limit is a minimum.
    pub fn is_at_least(self) -> bool {
        matches!(self, Self::Completeness | Self::Ssim) || self.units_within().is_some()
    }

    /// Returns the units of the limit that most of the surface must stay within; `None` for other figures.
    fn units_within(self) -> Option<&'static [FigureUnit]> {
        match self {
            Self::WithinAngle => Some(WITHIN_ANGLE),
            Self::WithinColor => Some(WITHIN_COLOR),
            Self::WithinDistance => Some(PER_CENT),
            _ => None,
        }
    }
}

/// A unit that a limit may be written in.
///
/// ```
/// use taotie::asset::{Figure, FigureUnit};
///
/// let FigureUnit { name, size } = Figure::Missed.unit();
/// assert_eq!((name, 0.5 * size), ("%", 0.005));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureUnit {
    /// Its symbol.
    pub name: &'static str,
    /// Its size in the unit of the figure itself: 1 for degrees and bytes, 0.01 for per cent.
    pub size: f64,
}

const fn unit(name: &'static str, size: f64) -> FigureUnit {
    FigureUnit { name, size }
}

const DEGREES: &[FigureUnit] = &[unit("°", 1.0), unit("deg", 1.0)];
/// The same, with the unit that is easiest to type first, as used in the names of figures.
const WITHIN_ANGLE: &[FigureUnit] = &[unit("deg", 1.0), unit("°", 1.0)];
const WITHIN_COLOR: &[FigureUnit] = &[unit("dE", 1.0), unit("ΔE", 1.0), unit("ΔE00", 1.0)];
const PER_CENT: &[FigureUnit] = &[unit("%", 0.01)];
const COLOR: &[FigureUnit] = &[unit("ΔE", 1.0), unit("ΔE00", 1.0)];
const METRES: &[FigureUnit] = &[unit("m", 1.0)];
const PIXELS: &[FigureUnit] = &[unit("px", 1.0)];
const NUMBER: &[FigureUnit] = &[unit("", 1.0)];
const BYTES: &[FigureUnit] = &[
    unit("B", 1.0),
    unit("kB", 1e3),
    unit("MB", 1e6),
    unit("GB", 1e9),
    unit("KiB", 1024.0),
    unit("MiB", 1_048_576.0),
    unit("GiB", 1_073_741_824.0),
];

impl FigureUnit {
    /// Returns a value in this unit as text, with five digits; whole numbers with all of theirs.
    ///
    /// ```
    /// use taotie::asset::Figure;
    ///
    /// assert_eq!(Figure::MeanAngle.unit().text(1.234567), "1.2346°");
    /// assert_eq!(Figure::Missed.unit().text(0.001), "0.1 %");
    /// assert_eq!(Figure::Bytes.unit().text(3_000_000.0), "3000000 B");
    /// ```
    pub fn text(&self, value: f64) -> String {
        let value = value / self.size;
        self.after(&if self.name == "B" { format!("{value:.0}") } else { five_digits(value) })
    }

    /// Returns a value in this unit as text, with all its digits.
    pub(in crate::asset) fn exact_text(&self, value: f64) -> String {
        self.after(&(value / self.size).to_string())
    }

    /// Returns the shortest decimal in this unit that gives exactly the value when multiplied by the unit's size.
    pub(super) fn shortest(&self, value: f64) -> String {
        let quotient = value / self.size;
        let number = |digits: usize| format!("{quotient:.digits$e}").parse::<f64>().unwrap_or(quotient);
        let found = (0..17).map(number).find(|number| number * self.size == value);
        found.unwrap_or(quotient).to_string()
    }

    fn after(&self, number: &str) -> String {
        match self.name {
            "" => number.to_owned(),
            "°" => format!("{number}°"),
            name => format!("{number} {name}"),
        }
    }
}

/// Returns a number with five significant digits, more for whole numbers, and no trailing zeros.
fn five_digits(value: f64) -> String {
    if value.abs() >= 1e4 {
        return format!("{value:.0}");
    }
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    rounded.to_string()
}

/// Splits a number from its unit.
pub(super) fn split(text: &str) -> (&str, &str) {
    let is_of_number = |c: char| c.is_ascii_digit() || ".+-eE".contains(c);
    let (number, unit) = text.split_at(text.find(|c: char| !is_of_number(c)).unwrap_or(text.len()));
    (number, unit.trim())
}

/// The prefix of the names of figures that are the share of the surface within a limit: they include the limit, as in
/// `within-5deg`.
const WITHIN: &str = "within-";

/// Returns the figure with this name.
///
/// # Errors
/// [`Error::Invalid`] listing the names that a requirement may have: those of shares with an example of their limit.
pub(super) fn read_plain(name: &str) -> Result<Figure> {
    let example = |figure: Figure| match figure {
        Figure::WithinAngle => "within-5deg",
        Figure::WithinColor => "within-3dE",
        Figure::WithinDistance => "within-0.5%",
        _ => figure.name(),
    };
    Figure::from_name(name).map_err(|_| {
        let known: Vec<&str> = Figure::NAMES.iter().map(|(_, figure)| example(*figure)).collect();
        let why = format!("expected one of: {}", known.join(", "));
        Error::invalid(format!("unknown {} `{name}`", Figure::WHAT), why)
    })
}

/// Returns the name of a figure, including the limit if it is a share within one.
pub(in crate::asset) fn name_within(figure: Figure, limit: Option<f64>) -> Cow<'static, str> {
    match (figure.units_within(), limit) {
        (Some(units), Some(limit)) => format!("{WITHIN}{}{}", units[0].shortest(limit), units[0].name).into(),
        _ => figure.name().into(),
    }
}

/// Returns the title of a figure, including the limit if it is a share within one.
pub(in crate::asset) fn title_within(figure: Figure, limit: Option<f64>) -> Cow<'static, str> {
    match (figure.units_within(), limit) {
        (Some(units), Some(limit)) => {
            // The printed symbol, rather than the typed one.
            let unit = units.iter().find(|unit| !unit.name.is_ascii()).unwrap_or(&units[0]);
            let of = if unit.name == "%" { " of the diagonal" } else { "" };
            format!("{} of {}{of}", figure.title(), unit.text(limit)).into()
        }
        _ => figure.title().into(),
    }
}

/// Parses a name with a limit, such as `within-5deg`, `within-3dE` or `within-0.5%`; `None` for names of other
/// figures.
pub(super) fn read_within(name: &str) -> Option<std::result::Result<(Figure, f64), String>> {
    Some(limit_of_name(name.strip_prefix(WITHIN)?.trim()))
}

fn limit_of_name(text: &str) -> std::result::Result<(Figure, f64), String> {
    let (number, unit) = split(text);
    let of = |figure: Figure| Some((figure, figure.units_within()?.iter().find(|u| u.name == unit)?.size));
    let found = [Figure::WithinAngle, Figure::WithinColor, Figure::WithinDistance].into_iter().find_map(of);
    let limit: Option<f64> = number.parse().ok().filter(|limit: &f64| limit.is_finite() && *limit >= 0.0);
    let why = || "expected a limit in deg, dE or % of the diagonal, e.g. within-5deg=99%".to_owned();
    let (figure, size) = found.ok_or_else(why)?;
    Ok((figure, limit.ok_or_else(why)? * size))
}

/// Returns the display unit of a length in metres.
pub(super) fn length_unit(metres: f64) -> FigureUnit {
    let (name, size) = length::shown_unit(metres);
    FigureUnit { name, size }
}

/// Returns the display unit of a figure and its limit: the figure's own, or a unit of length by the limit's size.
pub(in crate::asset) fn shown_unit(figure: Figure, limit: f64, is_length: bool) -> FigureUnit {
    if is_length { length_unit(limit) } else { figure.unit() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_told_in_their_unit() {
        let text = |figure: Figure, value| figure.unit().text(value);
        assert_eq!(text(Figure::Hausdorff, 0.000_012_345_6), "0.0012346 %");
        assert_eq!(text(Figure::Missed, 0.0), "0 %");
        assert_eq!(text(Figure::MaxAngle, 180.0), "180°");
        assert_eq!(text(Figure::MeanColor, 1.25), "1.25 ΔE");
        assert_eq!(text(Figure::Bytes, 1_234_567.0), "1234567 B");
        assert_eq!(Figure::MaxAngle.unit().exact_text(1.234_567_8), "1.2345678°");
    }
}
