//! Pseudo-random numbers and directions that are the same on every run.

use taotie_engine::math::Vec3;

/// A linear congruential generator; the number is its seed.
pub struct Random(pub u64);

impl Random {
    /// Returns the next number in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a vector with components in [-0.5, 0.5).
    pub fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5)
    }

    /// Returns a unit vector.
    #[allow(dead_code, reason = "not every test target needs directions")]
    pub fn unit(&mut self) -> Vec3<f64> {
        self.vector().normalize()
    }
}
