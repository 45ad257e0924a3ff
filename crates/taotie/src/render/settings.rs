//! What a picture is asked to be.

use crate::math::{SimdLevel, Vec3};
use crate::scene::Light;
use crate::shade::Shading;
use crate::shade::environment::Environment;
use crate::surface::{SurfaceMethod, TangentMethod};
use std::sync::Arc;

/// Where shading normals come from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SurfaceSettings {
    /// The method, or `None` for the best that each material provides: its normal map, else its height map, else
    /// smooth normals.
    pub method: Option<SurfaceMethod>,
    /// How tangents are made, or `None` for the mesh's own, else MikkTSpace.
    pub tangents: Option<TangentMethod>,
    /// For `bump` the height of 1 in model units, `None` for the material's; for `bump-printed` the paper's factor,
    /// `None` for 5.
    pub bump_scale: Option<f32>,
}

/// How a picture is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderSettings {
    /// Pixels across, 1 to 16384.
    pub width: u32,
    /// Pixels down, 1 to 16384.
    pub height: u32,
    /// Samples a pixel: 1, 4 or 16; each is shaded.
    pub samples: u32,
    /// The reflectance model.
    pub shading: Shading,
    /// Where shading normals come from.
    pub surface: SurfaceSettings,
    /// Whether lights cast shadows.
    pub shadows: bool,
    /// Whether [`super::Frame::aovs`] is filled.
    pub aovs: bool,
    /// A choice of speed, never of pixels.
    pub simd: SimdLevel,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 1024,
            samples: 4,
            shading: Shading::Ggx,
            surface: SurfaceSettings::default(),
            shadows: false,
            aovs: false,
            simd: SimdLevel::Auto,
        }
    }
}

/// Light from all around as it falls on a scene.
#[derive(Debug, Clone)]
pub struct EnvironmentLight {
    /// Where it comes from.
    pub environment: Arc<Environment>,
    /// Radians by which it is turned about +y, counter-clockwise as seen from above.
    pub rotation: f64,
    /// Multiplies its radiance, at least 0.
    pub intensity: f32,
    /// Whether it is seen where nothing stands before it.
    pub visible: bool,
}

/// The light on a scene.
#[derive(Debug, Clone, Default)]
pub struct Lighting {
    /// Any number of lights.
    pub lights: Vec<Light>,
    /// Radiance I_a from all around, linear RGB; reflected by k_a and darkened by occlusion maps.
    pub ambient: Vec3,
    /// Light from infinitely far all around.
    pub environment: Option<EnvironmentLight>,
}
