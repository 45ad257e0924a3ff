//! Table 3: angles between normals with truncated decimals.

use super::printed::{Normal, Printed};
use super::range::Range;
use serde::Serialize;
use taotie_engine::compare::angle_deg;
use taotie_engine::math::Vec3;

/// A printed angle, and the range of angles that the printed normals allow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Angle {
    /// As printed, degrees.
    pub printed: f64,
    /// The range of angles between normals that are printed this way, degrees.
    pub range: [f64; 2],
    /// True if some angle in the range would be printed this way.
    pub agrees: bool,
}

impl Angle {
    /// Creates a printed angle with the range that normals allow.
    pub(super) fn new(printed: f64, range: [f64; 2]) -> Self {
        let [low, high] = range.map(cut);
        Self { printed, range, agrees: (low..=high).contains(&printed) }
    }

    /// Returns the smallest and the largest angle that may be printed.
    pub fn prints(&self) -> [f64; 2] {
        self.range.map(cut)
    }
}

/// Truncates to two decimals, like the paper.
pub fn cut(degrees: f64) -> f64 {
    (degrees * 100.0).floor() / 100.0
}

/// Returns θ1, θ2 and θ3 of a row, from its normals.
pub fn angles(row: &Printed) -> [Angle; 3] {
    let [n1, others @ ..] = row.normals.map(box_of);
    std::array::from_fn(|i| {
        let pairs = corners(n1).flat_map(|a| corners(others[i]).map(move |b| angle_deg(a, b)));
        Angle::new(row.angles[i], extremes(pairs))
    })
}

/// Returns the range of the angle between N1, anywhere in a box, and the same normal raised along x and y by `raise`.
pub fn angle_of_raise(n1: [[f64; 2]; 3], raise: f64) -> [f64; 2] {
    let raised = |n: Vec3<f64>| n + Vec3::new(raise, raise, 0.0);
    extremes(corners(n1).map(|n| angle_deg(n, raised(n))))
}

fn box_of(normal: Normal) -> [[f64; 2]; 3] {
    normal.map(|component| Range::of(component).ends())
}

/// The corners of a box. Angles are almost linear within it, since it is only 0.0001 wide.
fn corners([x, y, z]: [[f64; 2]; 3]) -> impl Iterator<Item = Vec3<f64>> {
    (0..8).map(move |i| Vec3::new(x[i & 1], y[i >> 1 & 1], z[i >> 2]))
}

fn extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

#[cfg(test)]
mod tests {
    use super::super::printed::ROWS;
    use super::*;

    #[test]
    fn an_angle_is_known_to_two_hundredths() {
        for row in &ROWS {
            for angle in angles(row) {
                let width = angle.range[1] - angle.range[0];
                assert!(width > 0.0 && width < 0.02, "{angle:?}");
            }
        }
    }

    #[test]
    fn decimals_are_truncated() {
        assert_eq!([cut(27.989), cut(27.98), cut(0.0)], [27.98, 27.98, 0.0]);
    }

    #[test]
    fn a_raise_of_zero_has_zero_angle() {
        let n = [[0.5, 0.5001], [-0.6, -0.5999], [0.6, 0.6001]];
        assert_eq!(angle_of_raise(n, 0.0), [0.0, 0.0]);
        assert!(angle_of_raise(n, 0.1)[0] > 5.0);
    }
}
