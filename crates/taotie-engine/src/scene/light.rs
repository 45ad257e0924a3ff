//! Point and directional lights.

use super::Camera;
use crate::math::{Mat4, Vec3, scalar};

/// A light in world space.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Light {
    /// Its name; may be empty.
    pub name: String,
    /// Its form.
    pub kind: LightKind,
    /// Linear RGB strength: intensity in W/sr (candela) for points and spots, irradiance (lux) for directions.
    pub color: Vec3,
    /// The falloff of points and spots with distance.
    pub falloff: Falloff,
}

/// The form of a light.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    /// Shines from a position in all directions.
    Point {
        /// World space.
        position: Vec3,
    },
    /// Shines from infinitely far away.
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
        /// Angle from the axis up to which the light has full strength, radians, in [0, `outer`).
        inner: f64,
        /// Angle from the axis beyond which there is no light, radians, at most π/2.
        outer: f64,
    },
}

/// The falloff of the irradiance of a point or spot light with the distance d.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Falloff {
    /// E = I / d².
    #[default]
    InverseSquare,
    /// E = I / d², faded to zero at the specified range (KHR_lights_punctual's window), model units.
    Windowed(f32),
    /// E = I at any distance, as in Guo and Wang 2025.
    None,
}

impl Light {
    /// The maximum strength or radiance of each channel that can be rendered.
    pub const MOST: f32 = 1e12;

    /// Returns `true` if a colour is valid for a light: each channel from 0 to [`Light::MOST`].
    pub fn is_strength(color: Vec3) -> bool {
        color.to_array().iter().all(|v| (0.0..=Self::MOST).contains(v))
    }

    /// Attaches it to a node: it is at the node's origin and shines along its −z axis, as specified by
    /// KHR_lights_punctual.
    pub fn place(&mut self, world: &Mat4) {
        let to = world.axis(3).to_f32();
        let along = (-world.axis(2)).normalize_or(Vec3::new(0.0, 0.0, -1.0)).to_f32();
        match &mut self.kind {
            LightKind::Point { position } => *position = to,
            LightKind::Directional { direction } => *direction = along,
            LightKind::Spot { position, direction, .. } => (*position, *direction) = (to, along),
        }
    }
}

/// Returns the unit direction, in world space, towards `azimuth` radians to the right of the viewer and `elevation`
/// above, as seen from the object: (0, 0) is behind the camera.
pub fn from_view(camera: &Camera, azimuth: f64, elevation: f64) -> Vec3 {
    let cos_e = scalar::cos(elevation);
    let local = Vec3::new(scalar::sin(azimuth) * cos_e, scalar::sin(elevation), scalar::cos(azimuth) * cos_e);
    camera.world_from_view.transform_vector(local).normalize().to_f32()
}

/// Returns key, fill and rim lights, fixed to the camera: the key rakes from the upper left so that it shades the
/// relief, a weak cool fill opens the shadows, and a rim from behind separates the object from the ground.
pub fn three_point_rig(camera: &Camera) -> Vec<Light> {
    let rig: [(&str, [f64; 2], [f32; 3]); 3] = [
        ("key", [-52.0, 38.0], [3.4, 3.25, 3.0]),
        ("fill", [55.0, 12.0], [0.75, 0.82, 0.95]),
        ("rim", [152.0, 42.0], [2.2, 2.2, 2.2]),
    ];
    rig.map(|(name, [azimuth, elevation], color)| Light {
        name: name.into(),
        kind: LightKind::Directional {
            direction: -from_view(camera, azimuth.to_radians(), elevation.to_radians()),
        },
        color: Vec3::from_array(color),
        falloff: Falloff::None,
    })
    .into()
}
