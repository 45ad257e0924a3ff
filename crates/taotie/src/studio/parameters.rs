//! Camera and lights as plain data, for reports.

use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Projection};

/// A camera as data.
///
/// ```
/// use taotie::studio::CameraParameters;
///
/// /// Returns the position of the camera, world space.
/// fn place(camera: &CameraParameters) -> [f64; 3] {
///     let [.., [x, y, z, _]] = camera.world_from_view_columns;
///     [x, y, z]
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct CameraParameters {
    /// The columns of the matrix from view space to world space.
    pub world_from_view_columns: [[f64; 4]; 4],
    /// The projection of view space.
    pub projection: ProjectionParameters,
}

/// A projection as data, lengths in model units.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum ProjectionParameters {
    /// Central projection.
    Perspective {
        /// Full vertical angle, degrees.
        fov_y_deg: f64,
        /// Width over height as authored; `None` uses the image's.
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
/// use taotie::studio::LightParameters;
///
/// /// Returns the brightest channel of a light.
/// fn strength(light: &LightParameters) -> f32 {
///     light.color.into_iter().fold(0.0, f32::max)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct LightParameters {
    /// Kind, position and direction.
    #[serde(flatten)]
    pub kind: LightKindParameters,
    /// Its strength, linear RGB.
    pub color: [f32; 3],
    /// The falloff with distance.
    pub falloff: FalloffParameters,
}

/// The kind of a light as data, world space.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum LightKindParameters {
    /// Shines in all directions.
    Point {
        /// Its position.
        position: [f32; 3],
    },
    /// Comes from infinitely far away.
    Directional {
        /// The direction in which the light travels, unit.
        direction: [f32; 3],
    },
    /// Shines into a cone.
    Spot {
        /// Its position.
        position: [f32; 3],
        /// The axis of the cone, unit.
        direction: [f32; 3],
        /// Half the angle of the cone in which it has full strength, degrees.
        inner_deg: f32,
        /// Half the angle of the cone beyond which it is dark, degrees.
        outer_deg: f32,
    },
}

/// The falloff of a light with distance, as data.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum FalloffParameters {
    /// None.
    #[serde(rename = "none")]
    None,
    /// With the square of the distance.
    #[serde(rename = "inverse-square")]
    InverseSquare,
    /// With the square of the distance, fading to zero at this distance, model units.
    #[serde(rename = "inverse-square within")]
    Windowed(f32),
}

impl From<&Camera> for CameraParameters {
    fn from(camera: &Camera) -> Self {
        Self {
            world_from_view_columns: camera.world_from_view.columns,
            projection: projection(camera.projection),
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

impl From<&Light> for LightParameters {
    fn from(light: &Light) -> Self {
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
        Self { kind, color: light.color.to_array(), falloff }
    }
}
