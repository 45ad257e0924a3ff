//! Random numbers that are the same on every run.

use taotie_engine::math::Vec3;

/// A linear congruential generator.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        random.next();
        random
    }

    /// Returns the next number in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns the next number in [`low`, `high`).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Returns a colour in [0, 1)³.
    pub fn color(&mut self) -> Vec3<f64> {
        Vec3::new(self.next(), self.next(), self.next())
    }

    /// Returns a uniformly distributed unit vector.
    pub fn unit(&mut self) -> Vec3<f64> {
        loop {
            let vector = self.color() * 2.0 - Vec3::splat(1.0);
            if (1e-3..1.0).contains(&vector.dot(vector)) {
                return vector.normalize();
            }
        }
    }
}
