//! From a camera to clip space.

use crate::error::{Error, Result};
use crate::math::{Mat4, Vec3, scalar};
use crate::scene::{Camera, Projection};

/// A camera made ready for one picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Reversed-z clip space: 1 at the near plane, 0 at the far plane or at infinity.
    pub clip_from_world: Mat4,
    pub view_from_world: Mat4,
    pub eye: Eye,
}

/// Where rays of sight come from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Eye {
    /// A point, world space.
    Point(Vec3),
    /// The unit direction to the viewer, world space.
    Direction(Vec3),
}

impl View {
    pub(super) fn new(camera: &Camera, width: u32, height: u32) -> Result<Self> {
        let view_from_world = camera
            .world_from_view
            .inverse_affine()
            .filter(|_| camera.world_from_view.is_finite())
            .ok_or_else(|| {
                Error::invalid("camera", "its transform cannot be inverted; mend the file or use --orbit")
            })?;
        let picture_aspect = f64::from(width) / f64::from(height);
        let clip_from_view = match camera.projection {
            Projection::Perspective { fov_y, aspect, near, far } => {
                perspective(fov_y, aspect, picture_aspect, near, far)?
            }
            Projection::Orthographic { half_width, half_height, near, far } => {
                orthographic([half_width, half_height], picture_aspect, near, far)?
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

    /// The distance of a point along the axis of sight.
    pub(super) fn depth(&self, point: Vec3) -> f32 {
        -self.view_from_world.transform_point(point.to_f64()).z as f32
    }
}

/// A camera narrower or wider than the picture keeps all it sees: the other direction shows more.
fn perspective(fov_y: f64, aspect: Option<f64>, picture: f64, near: f64, far: Option<f64>) -> Result<Mat4> {
    if !(fov_y > 0.0 && fov_y < std::f64::consts::PI) {
        return Err(Error::invalid("camera field of view", "it must lie between 0° and 180°"));
    }
    if !(near > 0.0 && near.is_finite()) || far.is_some_and(|far| far <= near || far.is_nan()) {
        return Err(Error::invalid("camera planes", "near must be above 0 and below far"));
    }
    let tangent = scalar::tan(fov_y / 2.0);
    let half_height = tangent * aspect.map_or(1.0, |a| (a / picture).max(1.0));
    let (z_scale, z_offset) = match far.filter(|far| far.is_finite()) {
        Some(far) => (near / (far - near), near * far / (far - near)),
        None => (0.0, near),
    };
    Ok(Mat4 {
        columns: [
            [1.0 / (half_height * picture), 0.0, 0.0, 0.0],
            [0.0, 1.0 / half_height, 0.0, 0.0],
            [0.0, 0.0, z_scale, -1.0],
            [0.0, 0.0, z_offset, 0.0],
        ],
    })
}

fn orthographic([half_width, half_height]: [f64; 2], picture: f64, near: f64, far: f64) -> Result<Mat4> {
    let (half_width, half_height) = (half_width.abs(), half_height.abs());
    if !(half_width > 0.0 && half_height > 0.0 && half_width.is_finite() && half_height.is_finite()) {
        return Err(Error::invalid("orthographic camera", "its magnifications must not be 0"));
    }
    if !(far > near && far.is_finite()) {
        return Err(Error::invalid("camera planes", "far must be above near"));
    }
    let half_height = half_height.max(half_width / picture);
    let depth = far - near;
    Ok(Mat4 {
        columns: [
            [1.0 / (half_height * picture), 0.0, 0.0, 0.0],
            [0.0, 1.0 / half_height, 0.0, 0.0],
            [0.0, 0.0, 1.0 / depth, 0.0],
            [0.0, 0.0, far / depth, 1.0],
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(m: Mat4, z: f64) -> f64 {
        let [_, _, z, w] = m.transform_homogeneous(Vec3::new(0.0, 0.0, z));
        z / w
    }

    #[test]
    fn depth_is_one_at_near_and_zero_at_far() {
        for m in [
            perspective(1.0, None, 1.0, 0.5, Some(20.0)).unwrap(),
            orthographic([1.0, 1.0], 1.0, 0.5, 20.0).unwrap(),
        ] {
            assert!((depth(m, -0.5) - 1.0).abs() < 1e-12 && depth(m, -20.0).abs() < 1e-12);
        }
        let infinite = perspective(1.0, None, 1.0, 0.5, None).unwrap();
        assert!((depth(infinite, -0.5) - 1.0).abs() < 1e-12 && depth(infinite, -1e9) > 0.0);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(perspective(4.0, None, 1.0, 0.1, None).is_err());
        assert!(perspective(1.0, None, 1.0, 0.0, None).is_err());
        assert!(perspective(1.0, None, 1.0, 1.0, Some(0.5)).is_err());
        assert!(orthographic([0.0, 1.0], 1.0, 0.1, 1.0).is_err());
    }
}
