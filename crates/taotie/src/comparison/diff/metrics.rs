//! The metrics of two images, and a map of the places where the images differ.

use super::pair::{ImageContent, ImagePair};
use super::{DiffOptions, Metric};
pub use taotie_engine::compare::{self, ColorMap, DisplayImage, Field, SSIM_WINDOW, Summary};
use taotie_engine::error::{Error, Result};
use taotie_engine::progress::Progress;

/// The metrics of two images; `None` if one does not apply or was not requested.
///
/// ```
/// use taotie::comparison::diff::{DiffFigures, Metric};
///
/// let mut figures = DiffFigures::default();
/// figures.rmse = Some(0.25);
/// assert_eq!(figures.value(Metric::Rmse), Some(0.25));
/// assert_eq!(figures.value(Metric::Angle), None);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct DiffFigures {
    /// Degrees.
    pub angle: Option<Summary>,
    /// [0, 1].
    pub flip: Option<Summary>,
    /// 1 if equal.
    pub ssim: Option<f64>,
    /// Decibels; infinite if the images are equal, which JSON writes as `null`.
    pub psnr: Option<f64>,
    /// [0, 1].
    pub rmse: Option<f64>,
}

impl DiffFigures {
    /// Returns the single value of a metric to compare with a threshold.
    pub fn value(&self, metric: Metric) -> Option<f64> {
        match metric {
            Metric::Angle => self.angle.map(|angle| angle.mean),
            Metric::Flip => self.flip.map(|flip| flip.mean),
            Metric::Ssim => self.ssim,
            Metric::Psnr => self.psnr,
            Metric::Rmse => self.rmse,
        }
    }
}

impl ImagePair {
    /// Measures every requested metric that applies. `progress` has one stage, `diff`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if no texel holds a normal in both images, and if only SSIM is requested and the images are
    /// smaller than its window; [`Error::Cancelled`].
    pub fn figures(&self, options: &DiffOptions, progress: Progress<'_>) -> Result<DiffFigures> {
        match &self.content {
            ImageContent::Normals([(a, _), (b, _)]) => {
                let angle = Some(summary(&compare::angular_error(&a.normals, &b.normals)?)?);
                Ok(DiffFigures { angle, ..DiffFigures::default() })
            }
            ImageContent::Pictures([a, b]) => picture_figures([a, b], options, progress.stage("diff")),
        }
    }
}

fn picture_figures(
    [a, b]: [&DisplayImage; 2],
    options: &DiffOptions,
    progress: Progress<'_>,
) -> Result<DiffFigures> {
    let mut figures = DiffFigures::default();
    let asked = |metric| options.metric.is_none_or(|asked| asked == metric);
    if asked(Metric::Rmse) {
        figures.rmse = Some(compare::rmse(a, b)?);
    }
    if asked(Metric::Psnr) {
        figures.psnr = Some(compare::psnr(a, b)?);
    }
    progress.at(0.1)?;
    let large_enough = a.width().min(a.height()) >= SSIM_WINDOW;
    if asked(Metric::Ssim) && (large_enough || options.metric.is_some()) {
        figures.ssim = Some(compare::ssim(a, b)?);
    }
    progress.at(0.4)?;
    if asked(Metric::Flip) {
        figures.flip = Some(summary(&compare::flip(a, b, options.pixels_per_degree as f32)?)?);
    }
    Ok(figures)
}

fn summary(field: &Field) -> Result<Summary> {
    let why = "there is nothing to compare";
    field.summary().ok_or_else(|| Error::invalid("no texel holds a normal in both images", why))
}

/// The difference at each pixel, and how to show it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DifferenceMap {
    /// The numbers.
    pub field: Field,
    /// The quantity.
    pub title: &'static str,
    /// Its unit; may be empty.
    pub unit: &'static str,
    /// The colours.
    pub map: ColorMap,
    /// The number that maps to the last colour; the first is 0.
    pub top: f32,
}

impl ImagePair {
    /// Returns the difference at each pixel by the requested metric, else by FLIP or by the angle.
    ///
    /// # Errors
    /// As [`ImagePair::figures`].
    pub fn difference_map(&self, options: &DiffOptions) -> Result<DifferenceMap> {
        match &self.content {
            ImageContent::Normals([(a, _), (b, _)]) => {
                Ok(angle_map(compare::angular_error(&a.normals, &b.normals)?))
            }
            ImageContent::Pictures([a, b]) => picture_map([a, b], options),
        }
    }
}

fn angle_map(field: Field) -> DifferenceMap {
    let top = scale(&field);
    DifferenceMap { field, title: "angle between normals", unit: "°", map: ColorMap::Viridis, top }
}

fn picture_map([a, b]: [&DisplayImage; 2], options: &DiffOptions) -> Result<DifferenceMap> {
    let shown = |field, title, map, top| DifferenceMap { field, title, unit: "", map, top };
    Ok(match options.metric.unwrap_or(Metric::Flip) {
        Metric::Ssim => {
            let map = compare::ssim_map(a, b)?;
            let unlike = map.values().iter().map(|v| 1.0 - v).collect();
            shown(Field::new(map.width(), map.height(), unlike)?, "1 - SSIM", ColorMap::Viridis, 1.0)
        }
        Metric::Psnr | Metric::Rmse => {
            let field = compare::difference(a, b)?;
            let top = scale(&field);
            shown(field, "mean absolute difference", ColorMap::Viridis, top)
        }
        Metric::Flip | Metric::Angle => {
            let field = compare::flip(a, b, options.pixels_per_degree as f32)?;
            shown(field, "FLIP", ColorMap::Magma, 1.0)
        }
    })
}

/// Returns a scale robust against a few outliers: the 95 % quantile, else the largest number, else 1.
fn scale(field: &Field) -> f32 {
    let summary = field.summary();
    let tops = summary.map_or([0.0; 2], |summary| [summary.p95, summary.max]);
    tops.into_iter().map(|top| top as f32).find(|top| *top > 0.0).unwrap_or(1.0)
}
