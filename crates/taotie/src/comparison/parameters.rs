//! The parameters of the images of a comparison, as data, and the rules behind its figures, in words.

use super::look::{self, Matching};
use super::options::{ComparisonOptions, SPREAD_RULE, SamplePoints};
use crate::studio::{CameraParameters, LightParameters};
use taotie_engine::compare::PIXELS_PER_DEGREE;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::render::Lighting;
use taotie_engine::scene::Camera;

/// Camera, light, film and all other parameters of the images of a comparison, as plain data. Choices are named as on
/// the command line.
///
/// ```
/// use taotie::comparison::Parameters;
///
/// /// Returns a caption for an image.
/// fn legend(parameters: &Parameters) -> String {
///     let [width, height] = parameters.size;
///     format!("{width}×{height} pixels, {} samples, {} lights", parameters.samples, parameters.lights.len())
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Parameters {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u32,
    /// `true` if lights cast shadows.
    pub shadows: bool,
    /// The reflectance models.
    pub shadings: Vec<String>,
    /// The one with which the others are compared on the same surface, if requested.
    pub baseline: Option<String>,
    /// How corresponding points were found.
    pub matching: String,
    /// The requested sample points.
    pub points: String,
    /// The method of making tangents, if one was requested.
    pub tangents: Option<String>,
    /// Height of white for `bump`, in model units, if one was requested.
    pub bump_scale: Option<f32>,
    /// How reflectance models conserve energy.
    pub energy: String,
    /// `true` if relief too fine for the pixel widens highlights.
    pub specular_aa: bool,
    /// The method for mapped normals at grazing angles.
    pub grazing_normals: String,
    /// The camera.
    pub camera: CameraParameters,
    /// The lights, world space.
    pub lights: Vec<LightParameters>,
    /// Radiance from all around, linear RGB.
    pub ambient: [f32; 3],
    /// The exposure, stops.
    pub exposure_stops: f32,
    /// The tone curve.
    pub tone: String,
    /// The background, linear RGB.
    pub background: Option<[f32; 3]>,
    /// The resolution that FLIP assumes, in pixels per degree of the viewer's field of view.
    pub pixels_per_degree: f32,
}

impl Parameters {
    /// Collects the parameters of a comparison with its camera and light.
    pub(super) fn new(options: &ComparisonOptions, camera: &Camera, lighting: &Lighting) -> Self {
        let (settings, development) = (&options.settings, &options.development);
        Self {
            size: [settings.width, settings.height],
            samples: settings.samples,
            shadows: settings.shadows,
            shadings: options.shadings.iter().map(|shading| shading.name().into()).collect(),
            baseline: options.baseline.map(|shading| shading.name().into()),
            matching: options.matching.name().into(),
            points: options.points.to_string(),
            tangents: settings.surface.tangents.map(|tangents| tangents.name().into()),
            bump_scale: settings.surface.bump_scale,
            energy: settings.energy.name().into(),
            specular_aa: settings.specular_aa,
            grazing_normals: settings.grazing_normals.name().into(),
            camera: CameraParameters::from(camera),
            lights: lighting.lights.iter().map(LightParameters::from).collect(),
            ambient: lighting.ambient.to_array(),
            exposure_stops: development.exposure_stops,
            tone: development.tone.name().into(),
            background: development.background.map(Vec3::to_array),
            pixels_per_degree: PIXELS_PER_DEGREE,
        }
    }
}

/// The rules behind the figures, in words.
///
/// ```
/// use taotie::comparison::Report;
///
/// /// Returns the rules as a footnote.
/// fn footnote(report: &Report) -> String {
///     report.rules.in_words().join("\n")
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Rules {
    /// The normals between which angles are measured.
    pub angles: String,
    /// The rule by which corresponding points are found.
    pub places: String,
    /// The rule for pixels away from silhouettes.
    pub silhouettes: String,
    /// The rule by which sample points are chosen.
    pub points: String,
    /// The rule by which images are compared.
    pub pictures: String,
}

impl Rules {
    pub(super) fn new(matching: Matching, points: &SamplePoints) -> Self {
        Self {
            angles: "degrees between a method's shading normal and the true one at the corresponding point, each the mean \
                     over the pixel's samples"
                .into(),
            places: matching.rule().into(),
            silhouettes: look::INNER_RULE.into(),
            points: match points {
                SamplePoints::Spread(_) => SPREAD_RULE.into(),
                SamplePoints::Pixels(_) => "the requested pixels, from the top left".into(),
            },
            pictures: format!(
                "developed sRGB pictures of 8 bits, over the pixels that show either surface in any sample, not the \
                 background; SSIM with Gaussian windows of 11×11 pixels around these pixels (Wang et al. 2004), FLIP \
                 at {PIXELS_PER_DEGREE:.0} pixels per degree (Andersson et al. 2020). They are compared pixel by \
                 pixel, so they include the deviation of the low-poly mesh from the high-poly \
                 one as well as errors of its normals"
            ),
        }
    }

    /// Returns the rules, one sentence each.
    pub fn in_words(&self) -> Vec<String> {
        vec![
            format!("Angles: {}.", self.angles),
            format!("Matching: {}.", self.places),
            format!("Silhouettes: {}.", self.silhouettes),
            format!("Sample points: {}.", self.points),
            format!("Pictures: {}.", self.pictures),
        ]
    }
}
