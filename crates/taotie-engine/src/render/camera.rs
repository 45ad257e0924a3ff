//! A camera prepared for one image: the transform to clip space, and rays.

use crate::error::{Error, Result};
use crate::math::{Mat4, Vec3};
use crate::scene::{Camera, Projection};

/// A camera prepared for one image.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// The transform to reversed-z clip space: 1 at the near plane, 0 at the far plane or at infinity.
    pub clip_from_world: Mat4,
    pub view_from_world: Mat4,
    pub eye: Eye,
}

/// The origin of camera rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Eye {
    /// A point, in world space.
    Point(Vec3),
    /// The unit direction to the viewer, in world space.
    Direction(Vec3),
}

impl View {
    pub(super) fn new(camera: &Camera, width: u32, height: u32) -> Result<Self> {
        let view_from_world = camera
            .world_from_view
            .inverse_affine()
            .filter(|_| camera.world_from_view.is_finite())
            .ok_or_else(|| {
                Error::invalid("camera", "its transform cannot be inverted; fix the file or use --orbit")
            })?;
        let picture_aspect = f64::from(width) / f64::from(height);
        let half_height = camera.projection.half_height(picture_aspect);
        let clip_from_view = match camera.projection {
            Projection::Perspective { fov_y, near, far, .. } => {
                check_perspective(fov_y, near, far)?;
                perspective(half_height, picture_aspect, near, far)
            }
            Projection::Orthographic { half_width, half_height: given, near, far } => {
                check_orthographic([half_width, given], near, far)?;
                orthographic(half_height, picture_aspect, near, far)
            }
        };
        let eye = match camera.projection {
            Projection::Perspective { .. } => Eye::Point(camera.world_from_view.axis(3).to_f32()),
            Projection::Orthographic { .. } => {
                Eye::Direction(camera.world_from_view.axis(2).normalize().to_f32())
            }
        };
        Ok(Self { clip_from_world: clip_from_view * view_from_world, view_from_world, eye })
    }

    /// The distance of a point along the viewing axis.
    pub(super) fn depth(&self, point: Vec3) -> f32 {
        -self.view_from_world.transform_point(point.to_f64()).z as f32
    }
}

fn check_perspective(fov_y: f64, near: f64, far: Option<f64>) -> Result<()> {
    if !(fov_y > 0.0 && fov_y < std::f64::consts::PI) {
        return Err(Error::invalid("camera field of view", "it must be between 0° and 180°"));
    }
    if !(near > 0.0 && near.is_finite()) || far.is_some_and(|far| far <= near || far.is_nan()) {
        return Err(Error::invalid("camera planes", "near must be above 0 and below far"));
    }
    Ok(())
}

fn check_orthographic(half_sizes: [f64; 2], near: f64, far: f64) -> Result<()> {
    if half_sizes.iter().any(|half| !(half.abs() > 0.0 && half.is_finite())) {
        return Err(Error::invalid("orthographic camera", "its magnifications must not be 0"));
    }
    if !(far > near && far.is_finite()) {
        return Err(Error::invalid("camera planes", "far must be above near"));
    }
    Ok(())
}

fn perspective(half_height: f64, aspect: f64, near: f64, far: Option<f64>) -> Mat4 {
    let (z_scale, z_offset) = match far.filter(|far| far.is_finite()) {
        Some(far) => (near / (far - near), near * far / (far - near)),
        None => (0.0, near),
    };
    Mat4 {
        columns: [
            [1.0 / (half_height * aspect), 0.0, 0.0, 0.0],
            [0.0, 1.0 / half_height, 0.0, 0.0],
            [0.0, 0.0, z_scale, -1.0],
            [0.0, 0.0, z_offset, 0.0],
        ],
    }
}

fn orthographic(half_height: f64, aspect: f64, near: f64, far: f64) -> Mat4 {
    let depth = far - near;
    Mat4 {
        columns: [
            [1.0 / (half_height * aspect), 0.0, 0.0, 0.0],
            [0.0, 1.0 / half_height, 0.0, 0.0],
            [0.0, 0.0, 1.0 / depth, 0.0],
            [0.0, 0.0, far / depth, 1.0],
        ],
    }
}

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
    use super::*;
    use crate::scene::Orbit;

    fn depth(m: Mat4, z: f64) -> f64 {
        let [_, _, z, w] = m.transform_homogeneous(Vec3::new(0.0, 0.0, z));
        z / w
    }

    #[test]
    fn depth_is_one_at_near_and_zero_at_far() {
        for m in [perspective(1.0, 1.0, 0.5, Some(20.0)), orthographic(1.0, 1.0, 0.5, 20.0)] {
            assert!((depth(m, -0.5) - 1.0).abs() < 1e-12 && depth(m, -20.0).abs() < 1e-12);
        }
        let infinite = perspective(1.0, 1.0, 0.5, None);
        assert!((depth(infinite, -0.5) - 1.0).abs() < 1e-12 && depth(infinite, -1e9) > 0.0);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(check_perspective(4.0, 0.1, None).is_err());
        assert!(check_perspective(1.0, 0.0, None).is_err());
        assert!(check_perspective(1.0, 1.0, Some(0.5)).is_err());
        assert!(check_orthographic([0.0, 1.0], 0.1, 1.0).is_err());
    }

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
