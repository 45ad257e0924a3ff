//! The initial camera as an orbit around a point.

use serde::Serialize;
use taotie_engine::Warnings;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::scene::{Bounds, Camera, Projection};

/// A position on a sphere around a target, and the field of view from there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Orbit {
    /// Degrees to the right of the front, which is +z.
    pub azimuth: f64,
    /// Degrees above the horizon.
    pub elevation: f64,
    /// Model units.
    pub distance: f64,
    /// World space.
    pub target: [f64; 3],
    /// The vertical field of view in degrees, for pictures of this aspect ratio or wider.
    pub fov_y: f64,
    pub aspect: f64,
    /// The centre and radius of a sphere around the model.
    pub center: [f64; 3],
    pub radius: f64,
}

/// The vertical field of view for cameras without one, degrees.
const FOV_Y: f64 = 30.0;

impl Orbit {
    /// Returns the orbit of a camera looking at the model, around the point of its axis nearest the model's centre.
    pub fn new(camera: &Camera, bounds: &Bounds, warnings: &mut Warnings) -> Self {
        let [right, back, eye] = [0, 2, 3].map(|axis| camera.world_from_view.axis(axis));
        let (center, radius) = (bounds.center(), bounds.diagonal() / 2.0);
        let lens = Lens::new(&camera.projection, warnings);
        warnings.note("a tilted camera is shown upright", usize::from(right.y.abs() > 1e-6));
        let seen = (eye - center).dot(back);
        let distance = match lens.half_height {
            Some(half) => half / scalar::tan(FOV_Y.to_radians() / 2.0),
            None if seen > 0.0 => seen,
            None => radius,
        };
        let target = eye - back * if lens.half_height.is_some() { seen } else { distance };
        Self {
            azimuth: scalar::atan2(back.x, back.z).to_degrees(),
            elevation: scalar::atan2(back.y, Vec3::new(back.x, 0.0, back.z).length()).to_degrees(),
            distance,
            target: target.to_array(),
            fov_y: lens.fov_y,
            aspect: lens.aspect,
            center: center.to_array(),
            radius,
        }
    }
}

/// The parts of a projection that an orbit keeps.
struct Lens {
    fov_y: f64,
    aspect: f64,
    /// Half the height of an orthographic view.
    half_height: Option<f64>,
}

impl Lens {
    fn new(projection: &Projection, warnings: &mut Warnings) -> Self {
        match *projection {
            Projection::Perspective { fov_y, aspect, .. } => {
                Self { fov_y: fov_y.to_degrees(), aspect: aspect.unwrap_or(1.0), half_height: None }
            }
            Projection::Orthographic { half_width, half_height, .. } => {
                warnings.note("an orthographic camera is shown in perspective", 1);
                let half_height = half_height.abs();
                Self { fov_y: FOV_Y, aspect: half_width.abs() / half_height, half_height: Some(half_height) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::scene;

    #[test]
    fn an_orbit_is_restored() {
        let target = Vec3::new(0.5, 0.25, -0.125);
        let (azimuth, elevation, fov_y) = (0.6, -0.3, 0.5);
        let placed = scene::Orbit { azimuth, elevation, distance: 4.0, target, fov_y };
        let one = Vec3::splat(1.0);
        let bounds = Bounds { min: target - one, max: target + one };
        let mut warnings = Warnings::default();
        let found = Orbit::new(&placed.camera(1.0), &bounds, &mut warnings);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{found:?}");
        close(found.azimuth.to_radians(), azimuth);
        close(found.elevation.to_radians(), elevation);
        close(found.fov_y.to_radians(), fov_y);
        close(found.distance, 4.0);
        found.target.iter().zip(target.to_array()).for_each(|(a, b)| close(*a, b));
        assert!(warnings.is_empty());
    }
}
