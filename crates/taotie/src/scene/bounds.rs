//! Boxes around things.

use crate::math::Vec3;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner of least coordinates.
    pub min: Vec3<f64>,
    /// The corner of greatest coordinates.
    pub max: Vec3<f64>,
}

impl Bounds {
    /// The middle.
    pub fn center(&self) -> Vec3<f64> {
        (self.min + self.max) * 0.5
    }

    /// The least box around both.
    pub fn united(&self, other: &Self) -> Self {
        let pick = |a: Vec3<f64>, b: Vec3<f64>, of: fn(f64, f64) -> f64| {
            Vec3::new(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z))
        };
        Self { min: pick(self.min, other.min, f64::min), max: pick(self.max, other.max, f64::max) }
    }

    /// The length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }
}
