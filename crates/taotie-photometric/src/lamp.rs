//! The place of a lamp from the highlights on several balls.
//!
//! From each ball a ray leads to the lamp; the lamp is at the point closest to all rays. Balls rest on the plane of the
//! object, z = 0. The unit is a pixel: directions and fall-off need no scale.

use crate::circle::Circle;
use crate::highlight::Highlight;
use crate::symmetric::Sym3;
use taotie_engine::math::Vec3;

/// A ray from a ball to a lamp.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// The point of the highlight, pixels from the picture's centre: x to the right, y up, z above the object's plane.
    pub from: Vec3<f64>,
    /// Unit vector towards the lamp.
    pub direction: Vec3<f64>,
}

impl Ray {
    /// Returns the ray of a highlight on a ball in a picture of some size.
    pub fn new(highlight: &Highlight, ball: &Circle, [width, height]: [usize; 2]) -> Self {
        let [x, y] = ball.center;
        let center = Vec3::new(x - 0.5 * width as f64, 0.5 * height as f64 - y, ball.radius);
        Self { from: center + highlight.normal * ball.radius, direction: highlight.direction }
    }
}

/// Returns the direction that is closest to those of all rays.
pub fn mean_direction(rays: &[Ray]) -> Vec3<f64> {
    let sum = rays.iter().fold(Vec3::splat(0.0), |sum, ray| sum + ray.direction);
    sum.normalize_or(Vec3::new(0.0, 0.0, 1.0))
}

/// Returns the point closest to all rays; `None` if they are parallel or it is behind one of them.
pub fn intersection(rays: &[Ray]) -> Option<Vec3<f64>> {
    let (mut matrix, mut right) = (Sym3::default(), Vec3::splat(0.0));
    for ray in rays {
        // The projection perpendicular to the ray.
        for axis in ray_axes(ray.direction) {
            matrix.add(axis, 1.0);
            right += axis * axis.dot(ray.from);
        }
    }
    let point = matrix.inverse()?.times(right);
    let ahead = |ray: &Ray| (point - ray.from).dot(ray.direction) > 0.0;
    (point.z > 0.0 && rays.iter().all(ahead)).then_some(point)
}

fn ray_axes(direction: Vec3<f64>) -> [Vec3<f64>; 2] {
    let t = direction.any_perpendicular();
    [t, direction.cross(t)]
}

/// Returns the squared angles between rays and the directions in which a lamp should be seen, summed.
pub fn squared_angles(rays: &[Ray], expected: impl Fn(&Ray) -> Vec3<f64>) -> f64 {
    let square = |ray: &Ray| {
        let angle = taotie_engine::compare::angle_deg(ray.direction, expected(ray)).to_radians();
        angle * angle
    };
    rays.iter().map(square).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_from_three_balls_meet_at_the_lamp() {
        let lamp = Vec3::new(400.0, -250.0, 700.0);
        let ray = |x: f64, y: f64| {
            let from = Vec3::new(x, y, 60.0);
            Ray { from, direction: (lamp - from).normalize_or(Vec3::splat(0.0)) }
        };
        let rays = [ray(-300.0, 200.0), ray(300.0, 200.0), ray(0.0, -240.0)];
        let found = intersection(&rays).unwrap();
        assert!((found - lamp).length() < 1e-6, "{found:?}");
        let toward = |ray: &Ray| (found - ray.from).normalize_or(Vec3::splat(0.0));
        assert!(squared_angles(&rays, toward) < 1e-10);
        assert!(squared_angles(&rays, |_| mean_direction(&rays)) > 0.1);
        let parallel = [-100.0, 100.0].map(|x| Ray { from: Vec3::new(x, 0.0, 0.0), ..rays[0] });
        assert_eq!(intersection(&parallel), None);
    }
}
