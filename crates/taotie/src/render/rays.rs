//! Camera rays.

use crate::math::{Mat4, Vec3};
use crate::scene::{Camera, Projection};

/// Camera rays through points of an image.
#[derive(Debug, Clone, Copy)]
pub(super) struct CameraRays {
    world_from_view: Mat4,
    /// Half the visible extent, across and down: at distance 1 in perspective, at any distance otherwise.
    half: [f64; 2],
    /// The image's size, in pixels.
    size: [f64; 2],
    near: f64,
    far: f64,
    parallel: bool,
}

/// A ray from the near plane to the far plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct SightRay {
    pub origin: Vec3,
    /// The direction, unit.
    pub direction: Vec3,
    /// The limit of the ray, in model units.
    pub limit: f32,
}

impl CameraRays {
    /// Creates the rays; `width` and `height` of the image, in pixels; the camera must have been validated.
    pub(super) fn new(camera: &Camera, [width, height]: [u32; 2]) -> Self {
        let size = [f64::from(width), f64::from(height)];
        let aspect = size[0] / size[1];
        let half_height = camera.projection.half_height(aspect);
        let (near, far, parallel) = match camera.projection {
            Projection::Perspective { near, far, .. } => (near, far.unwrap_or(f64::INFINITY), false),
            Projection::Orthographic { near, far, .. } => (near, far, true),
        };
        let half = [half_height * aspect, half_height];
        Self { world_from_view: camera.world_from_view, half, size, near, far, parallel }
    }

    /// The ray through a point, in pixels from the image's top left corner.
    pub(super) fn through(&self, [x, y]: [f64; 2]) -> SightRay {
        let x = (2.0 * x / self.size[0] - 1.0) * self.half[0];
        let y = (1.0 - 2.0 * y / self.size[1]) * self.half[1];
        let (start, along) = match self.parallel {
            true => (Vec3::new(x, y, -self.near), Vec3::new(0.0, 0.0, -1.0)),
            false => (Vec3::new(x, y, -1.0) * self.near, Vec3::new(x, y, -1.0)),
        };
        let direction = self.world_from_view.transform_vector(along);
        let length = direction.length();
        SightRay {
            origin: self.world_from_view.transform_point(start).to_f32(),
            direction: (direction / length).to_f32(),
            limit: ((self.far - self.near) * length) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::View;
    use super::*;
    use crate::scene::Orbit;

    #[test]
    fn rays_run_from_near_to_far_through_their_pixel() {
        let orbit = Orbit {
            azimuth: 0.7,
            elevation: -0.3,
            distance: 4.0,
            target: Vec3::new(1.0, 2.0, 3.0),
            fov_y: 0.6,
        };
        let perspective = Projection::Perspective { fov_y: 0.6, aspect: None, near: 0.5, far: Some(9.0) };
        let parallel = Projection::Orthographic { half_width: 2.0, half_height: 1.0, near: 0.5, far: 9.0 };
        for projection in [perspective, parallel] {
            let camera = Camera { projection, ..orbit.camera(1.0) };
            let rays = CameraRays::new(&camera, [64, 48]);
            let view = View::new(&camera, 64, 48).unwrap();
            for at in [[0.0, 0.0], [64.0, 48.0], [13.25, 40.5]] {
                let ray = rays.through(at);
                for (distance, depth) in [(0.0, 1.0), (ray.limit, 0.0), (ray.limit * 0.4, f64::NAN)] {
                    let point = ray.origin + ray.direction * distance;
                    let [x, y, z, w] = view.clip_from_world.transform_homogeneous(point.to_f64());
                    let screen = [(x / w + 1.0) * 32.0, (1.0 - y / w) * 24.0];
                    assert!((screen[0] - at[0]).abs() < 1e-3 && (screen[1] - at[1]).abs() < 1e-3);
                    assert!(depth.is_nan() || (z / w - depth).abs() < 1e-5, "{} is not {depth}", z / w);
                }
            }
        }
    }
}
