//! Cameras and their projections.

use crate::math::{Mat4, Vec3, scalar};

/// A camera in the world. It looks along its −z axis with +y up.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Camera {
    /// Its name in the file; may be empty.
    pub name: String,
    /// A rigid transform from view space to world space.
    pub world_from_view: Mat4,
    /// The projection of view space.
    pub projection: Projection,
}

/// A projection of view space onto the image.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Projection {
    /// Central projection.
    Perspective {
        /// Full vertical angle in radians, in (0, π).
        fov_y: f64,
        /// Width over height as authored; `None` uses the image's.
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

impl Camera {
    /// Returns the size of a pixel at the distance `depth` along the viewing axis, in model units. `width` and
    /// `height` are the image's, in pixels.
    pub fn pixel_size(&self, depth: f64, width: u32, height: u32) -> f64 {
        let half = self.projection.half_height(f64::from(width) / f64::from(height));
        let at_depth = match self.projection {
            Projection::Perspective { .. } => half * depth,
            Projection::Orthographic { .. } => half,
        };
        2.0 * at_depth / f64::from(height)
    }

    /// Returns the point in world space seen at the centre of pixel `(x, y)` at the distance `depth` along the
    /// viewing axis. `width` and `height` are the image's, in pixels.
    pub fn point_at(&self, [x, y]: [u32; 2], depth: f64, [width, height]: [u32; 2]) -> Vec3<f64> {
        let size = self.pixel_size(depth, width, height);
        let from_middle = |i: u32, n: u32| f64::from(i) + 0.5 - f64::from(n) / 2.0;
        let view = Vec3::new(from_middle(x, width) * size, -from_middle(y, height) * size, -depth);
        self.world_from_view.transform_point(view)
    }
}

impl Projection {
    /// Returns half the visible height for an image with this aspect ratio: at distance 1 in perspective, otherwise
    /// anywhere.
    ///
    /// A camera narrower or wider than the image keeps everything it sees: the other direction shows more.
    pub fn half_height(&self, picture_aspect: f64) -> f64 {
        match *self {
            Self::Perspective { fov_y, aspect, .. } => {
                scalar::tan(fov_y / 2.0) * aspect.map_or(1.0, |a| (a / picture_aspect).max(1.0))
            }
            Self::Orthographic { half_width, half_height, .. } => {
                half_height.abs().max(half_width.abs() / picture_aspect)
            }
        }
    }
}

/// A position on a sphere around a target, and the angle of view from there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Radians to the right of the front, which is +z.
    pub azimuth: f64,
    /// Radians above the horizon.
    pub elevation: f64,
    /// The distance from the target, model units.
    pub distance: f64,
    /// The point looked at, world space.
    pub target: Vec3<f64>,
    /// Full vertical angle, radians.
    pub fov_y: f64,
}

impl Orbit {
    /// Returns the camera there. `size` is the radius around the target that the near plane must not cut.
    pub fn camera(&self, size: f64) -> Camera {
        let (sin_a, cos_a) = (scalar::sin(self.azimuth), scalar::cos(self.azimuth));
        let (sin_e, cos_e) = (scalar::sin(self.elevation), scalar::cos(self.elevation));
        let right = Vec3::new(cos_a, 0.0, -sin_a);
        let up = Vec3::new(-sin_e * sin_a, cos_e, -sin_e * cos_a);
        let back = Vec3::new(cos_e * sin_a, sin_e, cos_e * cos_a);
        let eye = self.target + back * self.distance;
        let near = (self.distance - size * 1.01).max(self.distance.max(size) * 1e-3);
        Camera {
            name: String::new(),
            world_from_view: Mat4::from_axes(right, up, back, eye),
            projection: Projection::Perspective { fov_y: self.fov_y, aspect: None, near, far: None },
        }
    }
}

/// Returns a transform without scale, shear and mirroring, as a camera uses of the node to which it is attached. The
/// viewing direction and the up direction are kept.
pub fn rigid(world: &Mat4) -> Mat4 {
    let fallback = Vec3::new(0.0, 0.0, 1.0);
    let z = world.axis(2).normalize_or(fallback);
    let up = world.axis(1);
    let side = up.cross(z);
    let any = if z.x.abs() < 0.9 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let x = side.normalize_or((any - z * z.dot(any)).normalize());
    Mat4::from_axes(x, z.cross(x), z, world.axis(3))
}

/// Returns the minimum distance from `orbit.target` at which all `points` (world space) are within the fraction
/// `fill` of the image's width and height, for the aspect ratio `aspect`. `orbit.distance` is ignored.
pub fn fitting_distance(
    orbit: &Orbit,
    aspect: f64,
    fill: f64,
    points: impl Iterator<Item = Vec3<f64>>,
) -> f64 {
    let frame = Frame::new(orbit, aspect, fill);
    points.fold(f64::MIN_POSITIVE, |distance, point| distance.max(frame.need(point)))
}

/// The part of an image into which points must fit, from a camera that looks at a target.
pub(super) struct Frame {
    target: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    back: Vec3<f64>,
    /// The tangents of half the angle of view across and down.
    tan: [f64; 2],
}

impl Frame {
    /// The fraction `fill` of an image of the aspect ratio `aspect`; `orbit.distance` is ignored.
    pub(super) fn new(orbit: &Orbit, aspect: f64, fill: f64) -> Self {
        let tan_y = scalar::tan(orbit.fov_y / 2.0) * fill;
        let camera = Orbit { distance: 0.0, ..*orbit }.camera(0.0).world_from_view;
        let [right, up, back] = [0, 1, 2].map(|j| camera.axis(j));
        Self { target: orbit.target, right, up, back, tan: [tan_y * aspect, tan_y] }
    }

    /// Returns the minimum distance of the camera from its target at which a point is within it.
    pub(super) fn need(&self, point: Vec3<f64>) -> f64 {
        let p = point - self.target;
        let (near, [tan_x, tan_y]) = (p.dot(self.back), self.tan);
        (near + p.dot(self.right).abs() / tan_x).max(near + p.dot(self.up).abs() / tan_y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fitted_points_touch_the_frame_and_do_not_cross_it() {
        let orbit =
            Orbit { azimuth: 0.4, elevation: 0.3, distance: 0.0, target: Vec3::default(), fov_y: 0.6 };
        let points = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.5), Vec3::new(-0.3, -1.0, 1.0)];
        let distance = fitting_distance(&orbit, 1.5, 0.9, points.into_iter());
        let view = Orbit { distance, ..orbit }.camera(1.0).world_from_view.inverse_affine().unwrap();
        let tangent = scalar::tan(0.3) * 0.9;
        let reach = points.map(|p| {
            let q = view.transform_point(p);
            (q.x.abs() / -q.z / (tangent * 1.5)).max(q.y.abs() / -q.z / tangent)
        });
        let most = reach.into_iter().fold(0.0, f64::max);
        assert!((most - 1.0).abs() < 1e-9, "{most}");
    }

    #[test]
    fn pixels_fill_the_angle_of_view() {
        let orbit =
            Orbit { azimuth: 0.0, elevation: 0.0, distance: 3.0, target: Vec3::default(), fov_y: 1.0 };
        let size = orbit.camera(1.0).pixel_size(3.0, 200, 100);
        assert!((size - 2.0 * 3.0 * scalar::tan(0.5) / 100.0).abs() < 1e-12);
        let projection = Projection::Orthographic { half_width: 4.0, half_height: 1.0, near: 0.0, far: 9.0 };
        let camera = Camera { projection, ..orbit.camera(1.0) };
        assert_eq!([1.0, 7.0].map(|depth| camera.pixel_size(depth, 200, 100)), [0.04; 2]);
    }

    #[test]
    fn orbit_looks_at_its_target_from_everywhere() {
        for (azimuth, elevation) in [(0.0, 0.0), (1.0, 0.5), (-2.0, std::f64::consts::FRAC_PI_2)] {
            let target = Vec3::new(1.0, 2.0, 3.0);
            let orbit = Orbit { azimuth, elevation, distance: 5.0, target, fov_y: 0.7 };
            let view = orbit.camera(1.0).world_from_view.inverse_affine().unwrap();
            assert!((view.transform_point(target) - Vec3::new(0.0, 0.0, -5.0)).length() < 1e-12);
            assert!((view.determinant3() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn camera_transforms_become_rigid() {
        let turned = Mat4::rotation_about(Vec3::new(0.0, 0.6, 0.8), 1.1);
        let world =
            Mat4::translation(Vec3::new(1.0, 2.0, 3.0)) * turned * Mat4::scale(Vec3::new(-2.0, 3.0, 4.0));
        let m = rigid(&world);
        assert!((m.determinant3() - 1.0).abs() < 1e-12);
        assert!((m.axis(2) - turned.axis(2)).length() < 1e-12);
        assert!((m.axis(1) - turned.axis(1)).length() < 1e-12);
        assert!((m.axis(3) - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
        assert!((rigid(&Mat4::scale(Vec3::splat(0.0))).determinant3() - 1.0).abs() < 1e-12);
    }
}
