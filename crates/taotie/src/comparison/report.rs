//! The figures of a comparison as plain data.

use super::Comparison;
use super::parameters::{Parameters, Rules};
use super::subject::SubjectReport;
use super::surfaces::{Difference, ModelDifference, PictureDifference, RenderedSurface, SkippedMethod};
use taotie_engine::Warning;
use taotie_engine::compare::{self, Summary};
use taotie_engine::image::Image;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::shade::Shading;

/// Number of bins of the angular error histogram, one per degree; the last one is open.
const HISTOGRAM_BINS: usize = 60;

/// Every parameter and every figure of a comparison.
///
/// ```
/// use taotie::comparison::{MethodReport, Report};
///
/// /// Returns the method whose normals are nearest to the true ones.
/// fn best(report: &Report) -> Option<&MethodReport> {
///     let measured = report.methods.iter().filter_map(|method| Some((method, method.inner_mean()?)));
///     measured.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(method, _)| method)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Report {
    /// Names and sizes of model and reference.
    pub subject: SubjectReport,
    /// The surface with which errors are measured: `reference`, or the first method.
    pub against: String,
    /// Camera, light, film and all other parameters of the images.
    pub parameters: Parameters,
    /// The fraction of covered samples without a corresponding point on the reference, [0, 1].
    pub unmatched: f64,
    /// How pixels and points are chosen, and the meaning of the figures.
    pub rules: Rules,
    /// The methods in their order, then the reference.
    pub methods: Vec<MethodReport>,
    /// Methods that could not be rendered.
    pub skipped: Vec<SkippedMethod>,
    /// Normals at sample points.
    pub points: Vec<PointReport>,
    /// Notes on maps that were derived from others.
    pub notes: Vec<String>,
    /// The duration of each of `methods`: all that differs from run to run.
    pub times: Vec<MethodTime>,
    /// Counts of what could not be rendered as requested.
    pub warnings: Vec<Warning>,
}

/// A completed method, and how long its images took.
///
/// ```
/// use taotie::comparison::{MethodTime, Report};
///
/// /// Returns the name of the slowest method.
/// fn slowest(report: &Report) -> Option<&str> {
///     let slowest = report.times.iter().max_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
///     slowest.map(|time: &MethodTime| time.method.as_str())
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MethodTime {
    /// Its name with the factor, or `reference`.
    pub method: String,
    /// The time from scene to all its images.
    pub milliseconds: f64,
}

/// One method's figures.
///
/// ```
/// use taotie::comparison::MethodReport;
///
/// /// Returns a row of a table: the method and its mean error in degrees.
/// fn row(method: &MethodReport) -> String {
///     let mean = method.inner_mean().map_or("-".into(), |mean| format!("{mean:.2}"));
///     format!("{} {mean}", method.method)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MethodReport {
    /// Its name with the factor, or `reference`.
    pub method: String,
    /// A short description.
    pub what: String,
    /// The name of the file for its normals as an image.
    pub normals: String,
    /// Angular error; absent for the surface with which the others are compared.
    pub error: Option<ErrorReport>,
    /// The shaded images.
    pub pictures: Vec<PictureReport>,
    /// The differences of its images from its own under the baseline, for each other reflectance model; empty without
    /// a baseline.
    #[serde(default)]
    pub models: Vec<ModelReport>,
}

/// The difference that a reflectance model makes to a surface's image.
///
/// ```
/// use taotie::comparison::{ModelReport, Report};
///
/// /// Returns the SSIM of each image with its own surface's under the baseline.
/// fn likeness(report: &Report) -> Vec<(&str, f64)> {
///     let models = report.methods.iter().flat_map(|method| &method.models);
///     models.map(|model: &ModelReport| (model.shading.as_str(), model.difference.ssim)).collect()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct ModelReport {
    /// The reflectance model.
    pub shading: String,
    /// The one with which it is compared.
    pub baseline: String,
    /// The difference of their images.
    pub difference: PictureFigures,
}

/// Angular error, degrees.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct ErrorReport {
    /// The name of the file for its heat map.
    pub heat: String,
    /// Over all matched pixels.
    pub all: Option<Summary>,
    /// Over those away from silhouettes.
    pub inner: Option<Summary>,
    /// The number of matched pixels in each of 60 bins of a degree; the last is open.
    pub histogram: Vec<u64>,
}

/// A shaded image, and its difference if there is one.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PictureReport {
    /// The reflectance model.
    pub shading: String,
    /// The name of its file.
    pub file: String,
    /// Absent for the surface with which the others are compared.
    pub difference: Option<PictureFigures>,
}

/// The figures of the difference of two developed images, over the pixels that show either surface.
///
/// ```
/// use taotie::comparison::PictureFigures;
///
/// /// Returns `true` if an image equals the expected one to the last code.
/// fn is_equal(difference: &PictureFigures) -> bool {
///     difference.psnr.is_none()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PictureFigures {
    /// In [0, 1] of encoded values.
    pub rmse: f64,
    /// Decibels; absent for equal images, for which it is infinite.
    pub psnr: Option<f64>,
    /// At most 1.
    pub ssim: f64,
    /// In [0, 1]; absent if no pixel shows either surface.
    pub flip: Option<Summary>,
    /// The number of pixels compared.
    pub pixels: usize,
    /// The name of the file for its map.
    pub flip_map: String,
}

/// The normals at a sample point.
///
/// ```
/// use taotie::comparison::{PointNormal, PointReport};
///
/// /// Returns the normal that a method shows at a sample point.
/// fn normal_of<'a>(point: &'a PointReport, method: &str) -> Option<&'a PointNormal> {
///     point.normals.iter().find(|normal| normal.method == method)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PointReport {
    /// From the top left.
    pub pixel: [u32; 2],
    /// For each of the methods in their order.
    pub normals: Vec<PointNormal>,
}

/// A method's normal at a sample point.
///
/// ```
/// use taotie::comparison::PointNormal;
///
/// /// Returns `true` if the normal is within a degree of the true one.
/// fn is_near(normal: &PointNormal) -> bool {
///     normal.error.is_some_and(|degrees| degrees < 1.0)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PointNormal {
    /// Its name with the factor, or `reference`.
    pub method: String,
    /// Unit, world space; absent if the method does not cover this pixel.
    pub normal: Option<[f32; 3]>,
    /// To the first method's, degrees.
    pub angle_to_first: Option<f64>,
    /// To the normal of the surface with which the others are compared, degrees.
    pub error: Option<f64>,
}

impl Comparison {
    /// Returns the figures as plain data.
    pub fn report(&self) -> Report {
        Report {
            subject: self.subject.clone(),
            against: self.against(),
            parameters: self.parameters.clone(),
            unmatched: self.unmatched,
            rules: self.rules.clone(),
            methods: self.surfaces.iter().map(method_report).collect(),
            skipped: self.skipped.clone(),
            points: self.points.iter().map(|pixel| point_report(*pixel, self)).collect(),
            notes: self.notes.clone(),
            times: self.surfaces.iter().map(method_time).collect(),
            warnings: self.warnings.list(),
        }
    }
}

impl Report {
    /// Returns the figures of a method by its name.
    pub fn method(&self, name: &str) -> Option<&MethodReport> {
        self.methods.iter().find(|method| method.method == name)
    }
}

impl MethodReport {
    /// Returns the mean angular error away from silhouettes, degrees.
    pub fn inner_mean(&self) -> Option<f64> {
        Some(self.error.as_ref()?.inner.as_ref()?.mean)
    }
}

fn method_time(surface: &RenderedSurface) -> MethodTime {
    MethodTime { method: surface.id(), milliseconds: surface.milliseconds }
}

fn method_report(surface: &RenderedSurface) -> MethodReport {
    let differences = surface.difference.iter().flat_map(|difference| &difference.pictures);
    let differences = differences.map(Some).chain(std::iter::repeat(None));
    let pictures = surface.pictures.iter().zip(differences);
    MethodReport {
        method: surface.id(),
        what: surface.describe(),
        normals: surface.file_name("normals"),
        error: surface.difference.as_ref().map(|difference| error_report(surface, difference)),
        pictures: pictures.map(|((shading, _), d)| picture_report(surface, *shading, d)).collect(),
        models: surface.model_differences.iter().map(|model| model_report(surface, model)).collect(),
    }
}

fn model_report(surface: &RenderedSurface, model: &ModelDifference) -> ModelReport {
    ModelReport {
        shading: model.shading.name().into(),
        baseline: model.baseline.name().into(),
        difference: figures(&model.picture, surface.model_flip_name(model)),
    }
}

fn error_report(surface: &RenderedSurface, difference: &Difference) -> ErrorReport {
    ErrorReport {
        heat: surface.file_name("error"),
        all: difference.angles.summary(),
        inner: difference.inner_angles.summary(),
        histogram: difference.angles.histogram(HISTOGRAM_BINS, HISTOGRAM_BINS as f32),
    }
}

fn picture_report(
    surface: &RenderedSurface,
    shading: Shading,
    difference: Option<&PictureDifference>,
) -> PictureReport {
    let difference = difference.map(|difference| figures(difference, surface.flip_name(shading)));
    PictureReport { shading: shading.name().into(), file: surface.picture_name(shading), difference }
}

fn figures(difference: &PictureDifference, flip_map: String) -> PictureFigures {
    PictureFigures {
        rmse: difference.rmse,
        psnr: difference.psnr.is_finite().then_some(difference.psnr),
        ssim: difference.ssim,
        flip: difference.flip.summary(),
        pixels: difference.pixels,
        flip_map,
    }
}

fn point_report(pixel: [u32; 2], comparison: &Comparison) -> PointReport {
    let first = normal_at(&comparison.surfaces[0].normals, pixel);
    let truth = normal_at(&comparison.truth, pixel);
    let angle = |a: Option<Vec3>, b: Option<Vec3>| Some(compare::angle_deg(a?.to_f64(), b?.to_f64()));
    let normals = comparison.surfaces.iter().enumerate().map(|(i, surface)| {
        // The reference's is that of the corresponding point, not of the same pixel.
        let seen = if surface.method.is_some() { &surface.normals } else { &comparison.truth };
        let normal = normal_at(seen, pixel);
        PointNormal {
            method: surface.id(),
            normal: normal.map(Vec3::to_array),
            angle_to_first: angle(first, normal).filter(|_| i != 0),
            error: angle(truth, normal).filter(|_| i != comparison.against),
        }
    });
    PointReport { pixel, normals: normals.collect() }
}

fn normal_at(normals: &Image, [x, y]: [u32; 2]) -> Option<Vec3> {
    let [nx, ny, nz, covered] = normals.pixel(x, y);
    (covered == 1.0).then_some(Vec3::new(nx, ny, nz))
}
