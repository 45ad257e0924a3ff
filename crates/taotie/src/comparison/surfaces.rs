//! The surfaces of a comparison as seen, and their differences.

use super::method::Method;
use crate::compare::{self, DisplayImage, Field, PIXELS_PER_DEGREE};
use crate::error::Result;
use crate::image::Image;
use crate::names::Named;
use crate::shade::Shading;

/// A surface as seen: the model by one method, or the reference.
///
/// ```
/// use taotie::comparison::Comparison;
///
/// /// Returns the names of the files for the normals of all methods, such as `bump-5.normals.png`.
/// fn files(comparison: &Comparison) -> Vec<String> {
///     comparison.surfaces.iter().map(|surface| surface.file_name("normals")).collect()
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RenderedSurface {
    /// The method, or `None` for the reference.
    pub method: Option<Method>,
    /// The mean normal of each pixel, as [`crate::render::Aovs::normals`].
    pub normals: Image,
    /// The developed image under each shading.
    pub pictures: Vec<(Shading, DisplayImage)>,
    /// The time from scene to all of these.
    pub milliseconds: f64,
    /// The difference from the surface with which it is compared; `None` for that surface itself.
    pub difference: Option<Difference>,
    /// The differences of its images from its own under the baseline, one for each other reflectance model; empty
    /// without a baseline.
    pub model_differences: Vec<ModelDifference>,
}

/// The difference that a reflectance model makes to the image of one surface.
///
/// ```
/// use taotie::comparison::{ModelDifference, RenderedSurface};
/// use taotie::names::Named;
///
/// /// Returns the reflectance model easiest to distinguish from the baseline.
/// fn most_visible(surface: &RenderedSurface) -> Option<&'static str> {
///     let mean = |model: &ModelDifference| model.picture.flip.summary().map_or(0.0, |flip| flip.mean);
///     let models = surface.model_differences.iter();
///     Some(models.max_by(|a, b| mean(a).total_cmp(&mean(b)))?.shading.name())
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ModelDifference {
    /// The reflectance model.
    pub shading: Shading,
    /// The one with which it is compared.
    pub baseline: Shading,
    /// The difference of their images.
    pub picture: PictureDifference,
}

/// The difference of a surface from the one with which it is compared.
///
/// ```
/// use taotie::comparison::Difference;
///
/// /// Returns the largest angle away from silhouettes, degrees.
/// fn most(difference: &Difference) -> Option<f64> {
///     Some(difference.inner_angles.summary()?.max)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Difference {
    /// Degrees, if both are covered.
    pub angles: Field,
    /// The same away from silhouettes.
    pub inner_angles: Field,
    /// The images under each shading, in the same order.
    pub pictures: Vec<PictureDifference>,
}

/// The difference of two developed images.
///
/// ```
/// use taotie::comparison::PictureDifference;
///
/// /// Returns `true` if an observer sees hardly any difference.
/// fn are_alike(difference: &PictureDifference) -> bool {
///     let flip = difference.flip.summary();
///     difference.ssim > 0.99 && flip.is_some_and(|flip| flip.mean < 0.01)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PictureDifference {
    /// Root mean square error, in [0, 1] of encoded values.
    pub rmse: f64,
    /// Decibels; infinite for equal images.
    pub psnr: f64,
    /// Structural similarity, at most 1.
    pub ssim: f64,
    /// FLIP at each pixel, in [0, 1].
    pub flip: Field,
}

/// A method that the model's materials do not support.
///
/// ```
/// use taotie::comparison::Comparison;
///
/// /// Returns the reasons why methods are missing, one per line.
/// fn reasons(comparison: &Comparison) -> Vec<String> {
///     let skipped = comparison.skipped.iter();
///     skipped.map(|skipped| format!("{}: {}", skipped.method, skipped.reason)).collect()
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SkippedMethod {
    /// The method, as [`Method::id`] writes it.
    pub method: String,
    /// The missing map, and what to do.
    pub reason: String,
}

impl RenderedSurface {
    /// Returns the method as [`Method::id`] writes it, or `reference`.
    pub fn id(&self) -> String {
        self.method.map_or_else(|| "reference".into(), Method::id)
    }

    /// Returns a short description of the method.
    pub fn describe(&self) -> String {
        self.method.map_or_else(|| "the geometry itself".into(), Method::describe)
    }

    /// Returns the file name for its image of this kind: `bump-5.normals.png`. Kinds are `normals`, `error`, the name
    /// of a shading, and that with `.flip`.
    pub fn file_name(&self, kind: &str) -> String {
        format!("{}.{kind}.png", self.file_stem())
    }

    /// Returns the file name for the exact values of this kind, `normals` or `error`: `bump-5.normals.exr`.
    pub fn exact_name(&self, kind: &str) -> String {
        format!("{}.{kind}.exr", self.file_stem())
    }

    fn file_stem(&self) -> String {
        self.method.map_or_else(|| "reference".into(), Method::file_stem)
    }

    /// Returns [`RenderedSurface::file_name`] of the image under a shading.
    pub fn picture_name(&self, shading: Shading) -> String {
        self.file_name(shading.name())
    }

    /// Returns [`RenderedSurface::file_name`] of the map of FLIP under a shading.
    pub fn flip_name(&self, shading: Shading) -> String {
        self.file_name(&format!("{}.flip", shading.name()))
    }

    /// Returns [`RenderedSurface::file_name`] of the map of FLIP between the images under two reflectance models:
    /// `smooth.phong-ggx.flip.png`.
    pub fn model_flip_name(&self, model: &ModelDifference) -> String {
        self.file_name(&format!("{}-{}.flip", model.shading.name(), model.baseline.name()))
    }
}

impl PictureDifference {
    /// Measures `picture` against the expected one.
    pub(super) fn of(expected: &DisplayImage, picture: &DisplayImage) -> Result<Self> {
        Ok(Self {
            rmse: compare::rmse(expected, picture)?,
            psnr: compare::psnr(expected, picture)?,
            ssim: compare::ssim(expected, picture)?,
            flip: compare::flip(expected, picture, PIXELS_PER_DEGREE)?,
        })
    }
}
