//! Lights that are points or directions.

use crate::math::Vec3;

/// A light in world space.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Its name; may be empty.
    pub name: String,
    /// Its form.
    pub kind: LightKind,
    /// Linear RGB strength: intensity in W/sr (candela) for points and spots, irradiance (lux) for directions.
    pub color: Vec3,
    /// How the strength of points and spots falls with distance.
    pub falloff: Falloff,
}

/// The form of a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Shines from a position in all directions.
    Point {
        /// World space.
        position: Vec3,
    },
    /// Shines from infinitely far.
    Directional {
        /// Unit direction in which the light travels, world space.
        direction: Vec3,
    },
    /// Shines from a position within a cone.
    Spot {
        /// World space.
        position: Vec3,
        /// Unit direction of the cone's axis, world space.
        direction: Vec3,
        /// Angle from the axis up to which the light is full, radians, in [0, `outer`).
        inner: f32,
        /// Angle from the axis from which there is no light, radians, at most π/2.
        outer: f32,
    },
}

/// How the irradiance of a point or spot light falls with the distance d.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Falloff {
    /// E = I / d².
    #[default]
    InverseSquare,
    /// E = I / d², faded to zero at the range given (KHR_lights_punctual's window), model units.
    Windowed(f32),
    /// E = I at any distance, as in the seed paper.
    None,
}
