//! Where a picture is taken from.

use crate::math::Mat4;

/// A camera in the world. It looks along its −z axis with +y up.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Its name in the file; may be empty.
    pub name: String,
    /// A rigid transform from view space to world space.
    pub world_from_view: Mat4,
    /// How view space is projected.
    pub projection: Projection,
}

/// How view space is projected to the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Central projection.
    Perspective {
        /// Full vertical angle in radians, in (0, π).
        fov_y: f64,
        /// Width over height as authored; `None` takes the picture's.
        aspect: Option<f64>,
        /// Distance of the near plane, above 0, model units.
        near: f64,
        /// Distance of the far plane, or `None` for infinity.
        far: Option<f64>,
    },
    /// Parallel projection.
    Orthographic {
        /// Half the width seen, model units.
        half_width: f64,
        /// Half the height seen, model units.
        half_height: f64,
        /// Distance of the near plane, model units.
        near: f64,
        /// Distance of the far plane, above `near`.
        far: f64,
    },
}
