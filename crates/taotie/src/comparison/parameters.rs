//! Everything that the images of a comparison depend on, as data.

use super::options::ComparisonOptions;
use crate::compare::PIXELS_PER_DEGREE;
use crate::math::Vec3;
use crate::names::Named;
use crate::render::Lighting;
use crate::scene::{Camera, Falloff, Light, LightKind, Projection};

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

/// A camera as data.
///
/// ```
/// use taotie::comparison::CameraParameters;
///
/// /// Returns the place of the camera, world space.
/// fn place(camera: &CameraParameters) -> [f64; 3] {
///     let [.., [x, y, z, _]] = camera.world_from_view_columns;
///     [x, y, z]
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CameraParameters {
    /// The columns of the matrix that takes view space to world space.
    pub world_from_view_columns: [[f64; 4]; 4],
    /// The projection of view space.
    pub projection: ProjectionParameters,
}

/// A projection as data, lengths in model units.
///
/// ```
/// use taotie::comparison::ProjectionParameters;
///
/// /// Returns the full vertical angle of view, degrees; `None` in parallel projection.
/// fn angle_of_view(projection: &ProjectionParameters) -> Option<f64> {
///     match projection {
///         ProjectionParameters::Perspective { fov_y_deg, .. } => Some(*fov_y_deg),
///         _ => None,
///     }
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "lowercase"))]
#[non_exhaustive]
pub enum ProjectionParameters {
    /// Central projection.
    Perspective {
        /// Full vertical angle, degrees.
        fov_y_deg: f64,
        /// Width over height as authored; `None` is the image's.
        aspect: Option<f64>,
        /// Distance of the near plane.
        near: f64,
        /// Distance of the far plane; `None` is infinity.
        far: Option<f64>,
    },
    /// Parallel projection.
    Orthographic {
        /// Half the width seen.
        half_width: f64,
        /// Half the height seen.
        half_height: f64,
        /// Distance of the near plane.
        near: f64,
        /// Distance of the far plane.
        far: f64,
    },
}

/// A light as data.
///
/// ```
/// use taotie::comparison::LightParameters;
///
/// /// Returns the brightest channel of a light.
/// fn strength(light: &LightParameters) -> f32 {
///     light.color.into_iter().fold(0.0, f32::max)
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LightParameters {
    /// Kind, place and direction.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub kind: LightKindParameters,
    /// Its strength, linear RGB.
    pub color: [f32; 3],
    /// The falloff with distance.
    pub falloff: FalloffParameters,
}

/// The kind of a light as data, world space.
///
/// ```
/// use taotie::comparison::LightKindParameters;
///
/// /// Returns the place of a light; `None` where it is infinitely far.
/// fn place(light: &LightKindParameters) -> Option<[f32; 3]> {
///     match light {
///         LightKindParameters::Point { position } | LightKindParameters::Spot { position, .. } => {
///             Some(*position)
///         }
///         _ => None,
///     }
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "lowercase"))]
#[non_exhaustive]
pub enum LightKindParameters {
    /// Shines all around.
    Point {
        /// Its place.
        position: [f32; 3],
    },
    /// Comes from infinitely far.
    Directional {
        /// The direction that the light travels in, unit.
        direction: [f32; 3],
    },
    /// Shines into a cone.
    Spot {
        /// Its place.
        position: [f32; 3],
        /// The axis of the cone, unit.
        direction: [f32; 3],
        /// Half the angle of the cone in which it is full, degrees.
        inner_deg: f32,
        /// Half the angle of the cone beyond which it is dark, degrees.
        outer_deg: f32,
    },
}

/// The falloff of a light with distance, as data.
///
/// ```
/// use taotie::comparison::FalloffParameters;
///
/// /// Returns the distance beyond which a light is dark, model units; `None` where there is none.
/// fn range(falloff: &FalloffParameters) -> Option<f32> {
///     match falloff {
///         FalloffParameters::Windowed(range) => Some(*range),
///         _ => None,
///     }
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum FalloffParameters {
    /// Not at all.
    #[cfg_attr(feature = "serde", serde(rename = "none"))]
    None,
    /// With the square of the distance.
    #[cfg_attr(feature = "serde", serde(rename = "inverse-square"))]
    InverseSquare,
    /// With the square of the distance, and to nothing at this distance, model units.
    #[cfg_attr(feature = "serde", serde(rename = "inverse-square within"))]
    Windowed(f32),
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
            matching: options.matching.name().into(),
            points: options.points.to_string(),
            tangents: settings.surface.tangents.map(|tangents| tangents.name().into()),
            bump_scale: settings.surface.bump_scale,
            energy: settings.energy.name().into(),
            specular_aa: settings.specular_aa,
            grazing_normals: settings.grazing_normals.name().into(),
            camera: CameraParameters {
                world_from_view_columns: camera.world_from_view.columns,
                projection: projection(camera.projection),
            },
            lights: lighting.lights.iter().map(light).collect(),
            ambient: lighting.ambient.to_array(),
            exposure_stops: development.exposure_stops,
            tone: development.tone.name().into(),
            background: development.background.map(Vec3::to_array),
            pixels_per_degree: PIXELS_PER_DEGREE,
        }
    }
}

fn projection(projection: Projection) -> ProjectionParameters {
    match projection {
        Projection::Perspective { fov_y, aspect, near, far } => {
            ProjectionParameters::Perspective { fov_y_deg: fov_y.to_degrees(), aspect, near, far }
        }
        Projection::Orthographic { half_width, half_height, near, far } => {
            ProjectionParameters::Orthographic { half_width, half_height, near, far }
        }
    }
}

fn light(light: &Light) -> LightParameters {
    let kind = match light.kind {
        LightKind::Point { position } => LightKindParameters::Point { position: position.to_array() },
        LightKind::Directional { direction } => {
            LightKindParameters::Directional { direction: direction.to_array() }
        }
        LightKind::Spot { position, direction, inner, outer } => LightKindParameters::Spot {
            position: position.to_array(),
            direction: direction.to_array(),
            inner_deg: inner.to_degrees() as f32,
            outer_deg: outer.to_degrees() as f32,
        },
    };
    let falloff = match light.falloff {
        Falloff::None => FalloffParameters::None,
        Falloff::InverseSquare => FalloffParameters::InverseSquare,
        Falloff::Windowed(range) => FalloffParameters::Windowed(range),
    };
    LightParameters { kind, color: light.color.to_array(), falloff }
}
