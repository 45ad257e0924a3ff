//! Bounding boxes.

use crate::math::Vec3;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner of minimum coordinates.
    pub min: Vec3<f64>,
    /// The corner of maximum coordinates.
    pub max: Vec3<f64>,
}

impl Bounds {
    /// Returns the centre.
    pub fn center(&self) -> Vec3<f64> {
        (self.min + self.max) * 0.5
    }

    /// Returns the smallest box around both.
    pub fn united(&self, other: &Self) -> Self {
        let lower =
            Vec3::new(self.min.x.min(other.min.x), self.min.y.min(other.min.y), self.min.z.min(other.min.z));
        let upper =
            Vec3::new(self.max.x.max(other.max.x), self.max.y.max(other.max.y), self.max.z.max(other.max.z));
        Self { min: lower, max: upper }
    }

    /// Returns the smallest box around all points; `None` if there are none.
    pub fn around(points: impl Iterator<Item = Vec3<f64>>) -> Option<Self> {
        points.map(|point| Self { min: point, max: point }).reduce(|all, point| all.united(&point))
    }

    /// Returns the eight corners.
    pub fn corners(&self) -> [Vec3<f64>; 8] {
        let Self { min, max } = *self;
        std::array::from_fn(|i| {
            let pick = |axis: usize, low: f64, high: f64| if i >> axis & 1 == 0 { low } else { high };
            Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        })
    }

    /// Returns the length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }
}
