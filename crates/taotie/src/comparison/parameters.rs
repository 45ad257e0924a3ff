//! All parameters of the images of a comparison, as data.

use super::options::ComparisonOptions;
use crate::compare::PIXELS_PER_DEGREE;
use crate::math::Vec3;
use crate::names::Named;
use crate::render::Lighting;
use crate::scene::Camera;
use crate::studio::{CameraParameters, LightParameters};

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
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
