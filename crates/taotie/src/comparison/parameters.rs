//! Everything that the images of a comparison depend on, as data.

use super::options::ComparisonOptions;
use crate::compare::PIXELS_PER_DEGREE;
use crate::math::Vec3;
use crate::names::Named;
use crate::render::Lighting;
use crate::scene::Camera;
use crate::studio::{CameraParameters, LightParameters};

/// Camera, light, film and whatever else the images of a comparison depend on, as plain data. Choices are named as on
/// the command line.
///
/// ```
/// use taotie::comparison::Parameters;
///
/// /// Returns a line for below an image.
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
    /// Samples a pixel.
    pub samples: u32,
    /// `true` where lights cast shadows.
    pub shadows: bool,
    /// The reflectance models.
    pub shadings: Vec<String>,
    /// The one that the others are measured against on the same surface, where that was asked for.
    pub baseline: Option<String>,
    /// The way in which corresponding points were found.
    pub matching: String,
    /// The sample points asked for.
    pub points: String,
    /// The method of making tangents, where something was asked for.
    pub tangents: Option<String>,
    /// Height of white for `bump`, model units, where something was asked for.
    pub bump_scale: Option<f32>,
    /// The way in which reflectance models keep their energy.
    pub energy: String,
    /// `true` where relief too fine for the pixel widens highlights.
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
    /// Pixels per degree of the field of view of the viewer that FLIP assumes.
    pub pixels_per_degree: f32,
}

impl Parameters {
    /// Gathers the parameters of a comparison with the camera and the light that it uses.
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
