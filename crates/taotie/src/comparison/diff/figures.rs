//! The metrics of two images.

use super::options::{DiffOptions, Metric};
use super::pair::{ImageContent, ImagePair};
use crate::compare::{self, DisplayImage, Field, SSIM_WINDOW, Summary};
use crate::error::{Error, Result};
use crate::progress::Progress;

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
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
            ImageContent::Pictures([a, b]) => of_pictures([a, b], options, progress.stage("diff")),
        }
    }
}

fn of_pictures(
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
