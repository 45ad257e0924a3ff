//! The uniform buffer of a frame, its lights, and the levels of its environment.

use crate::interface::{UniformField, Unplaced, ValueKind, buffer_size, laid_out};
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{Cone, Falloff, LightSource, Place, Turn};

/// The maximum number of lights in a GLSL ES shader.
pub const MOST_LIGHTS: usize = 16;

/// The maximum number of environment levels in a shader; no environment has that many.
pub const MOST_LEVELS: usize = 32;

/// The values of a frame's uniform buffer.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFactors {
    /// The columns of the matrix that transforms world space to clip space.
    pub clip_from_world: [[f32; 4]; 4],
    /// The viewer's position and 1, or the unit direction to the viewer and 0, in world space.
    pub eye: [f32; 4],
    /// Ambient radiance from all directions, linear RGB.
    pub ambient: Vec3,
    /// The distance between two samples in pixels: 1 with one sample per pixel, 1/2 with four.
    pub spacing: f32,
    /// The rotation of the environment.
    pub turn: Turn<f32>,
    /// The factor of the environment's radiance, at least 0.
    pub intensity: f32,
    /// The number of environment levels.
    pub levels: usize,
    /// The α of the environment's smoothest level, (0, 1].
    pub smoothest_alpha: f32,
    /// The number of lights.
    pub lights: usize,
}

/// The names, types and meanings of the fields.
const FIELDS: [(&str, ValueKind, &str); 10] = [
    ("clip_from_world", ValueKind::Mat4, "Transforms world space to the host's clip space."),
    (
        "eye",
        ValueKind::Vec4,
        "The viewer's position and 1, or the unit direction to the viewer and 0; world space.",
    ),
    ("ambient", ValueKind::Vec3, "Ambient radiance from all directions, linear RGB."),
    (
        "spacing",
        ValueKind::Number,
        "The distance between two samples in pixels: 1/2 with four samples per pixel.",
    ),
    ("environment_sin", ValueKind::Number, "The sine of the environment's rotation about +y."),
    ("environment_cos", ValueKind::Number, "The cosine of the environment's rotation about +y."),
    ("environment_intensity", ValueKind::Number, "The factor of the environment's radiance, at least 0."),
    ("environment_levels", ValueKind::Number, "The number of environment levels."),
    ("smoothest_alpha", ValueKind::Number, "The α of the environment's smoothest level, (0, 1]."),
    ("light_count", ValueKind::Number, "The number of lights."),
];

/// The fields of a frame's uniform buffer.
pub(crate) fn frame_fields() -> Vec<UniformField> {
    let fields = FIELDS.map(|(name, kind, meaning)| Unplaced { name: name.into(), kind, meaning });
    laid_out(&fields)
}

impl FrameFactors {
    /// Returns the bytes of group 0, binding 0.
    pub fn bytes(&self) -> Vec<u8> {
        let fields = frame_fields();
        let mut bytes = vec![0; buffer_size(&fields)];
        fields.iter().zip(self.values()).for_each(|(field, value)| field.write(&value, &mut bytes));
        bytes
    }

    fn values(&self) -> [Vec<f32>; 10] {
        [
            self.clip_from_world.as_flattened().to_vec(),
            self.eye.to_vec(),
            self.ambient.to_array().to_vec(),
            vec![self.spacing],
            vec![self.turn.sin],
            vec![self.turn.cos],
            vec![self.intensity],
            vec![self.levels as f32],
            vec![self.smoothest_alpha],
            vec![self.lights as f32],
        ]
    }
}

/// The range that means infinite: no window reaches that far, and its square is finite.
const NO_RANGE: f32 = 1e18;

/// Returns a light as shaders read it: 16 numbers, the stride of the lights' buffer in `f32`.
///
/// `place` (the position, or the unit direction to a light infinitely far away), `kind` (0 infinitely far, 1 without
/// falloff, 2 inverse-square falloff), `color`, `range`, `axis`, `cos_inner`, `cos_outer`, and three unused.
pub fn light_numbers(light: &LightSource<f32>) -> [f32; 16] {
    let (place, far) = match light.place {
        Place::At(position) => (position, false),
        Place::Towards(direction) => (direction, true),
    };
    let (falloff, range) = match light.falloff {
        Falloff::None => (1.0, NO_RANGE),
        Falloff::InverseSquare => (2.0, NO_RANGE),
        Falloff::Windowed(range) => (2.0, range),
    };
    // A cone that extends beyond the opposite direction contains every direction.
    let everywhere = Cone { axis: Vec3::new(0.0, 0.0, 1.0), cos_inner: -2.0, cos_outer: -3.0 };
    let Cone { axis, cos_inner, cos_outer } = light.cone.unwrap_or(everywhere);
    let kind = if far { 0.0 } else { falloff };
    let (p, c) = (place, light.color);
    [p.x, p.y, p.z, kind, c.x, c.y, c.z, range, axis.x, axis.y, axis.z, cos_inner, cos_outer, 0.0, 0.0, 0.0]
}
