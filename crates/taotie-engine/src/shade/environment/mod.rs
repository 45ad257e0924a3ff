//! Light from infinitely far away in all directions: an equirectangular image and the levels filtered from it.
//!
//! Directions are unit, in the environment's local space, with +y up. The image's convention is u = atan2(z, x)/(2π)
//! + 1/2, v = acos(y)/π, both from the top left.

mod bytes;
mod distribution;
mod equirect;
mod irradiance;
mod levels;
mod lookup;
mod prefilter;
mod studio;
mod texels;

use crate::error::Result;
use crate::image::Image;
use crate::math::{Lane, Number, Vec3};
use distribution::Distribution;
use equirect::{Equirect, uv_of};
use levels::Levels;
pub(crate) use lookup::{EnvironmentLookup, LookupDirections, LookupRequest};
use std::sync::OnceLock;
use texels::HalfTexels;

pub use equirect::{PicturePosition, picture_uv};
pub use irradiance::IrradianceHarmonics;
pub use levels::{LevelPosition, octahedral_place, octahedral_taps, share_of_smoothest};
pub use studio::{STUDIO_VERSION, studio};
pub use texels::{bilinear, linear};

/// The version of the results of [`Environment::new`] and of their serialised form: as long as it is unchanged, the
/// same image gives the same bits.
pub const ENVIRONMENT_VERSION: u32 = 3;

/// Light from infinitely far away in all directions.
#[derive(Debug, Clone)]
pub struct Environment {
    picture: Equirect,
    levels: Levels,
    /// Computed on first use: only needed for sampling directions.
    distribution: OnceLock<Distribution>,
    repaired: usize,
}

/// A sampled direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentSample {
    /// Unit, to the light.
    pub direction: Vec3,
    /// The radiance from there, linear RGB.
    pub radiance: Vec3,
    /// The density of the sample, sr⁻¹, above 0.
    pub pdf: f32,
}

/// The images in which an environment is looked up, for GPUs that do so themselves.
#[derive(Debug, Clone)]
pub struct EnvironmentMaps<'e> {
    /// Its light filtered for rough mirrors, from the smoothest to the roughest: unfolded octahedra with a border of
    /// one texel on each side.
    pub levels: Vec<HalfPicture<'e>>,
    /// Roughness² of the smoothest level, (0, 1].
    pub smoothest_alpha: f32,
    /// The equirectangular image itself.
    pub picture: HalfPicture<'e>,
}

/// An image of linear RGB in half floats, row by row from the top.
#[derive(Debug, Clone, Copy)]
pub struct HalfPicture<'e> {
    /// Width in texels, with the border.
    pub width: usize,
    /// Height in texels, with the border.
    pub height: usize,
    /// The half floats of each texel.
    pub texels: &'e [[u16; 3]],
    /// The factor of the half floats: a power of two.
    pub factor: f32,
}

impl Environment {
    /// Creates an environment from an equirectangular image, linear RGB. Texels that light cannot have are corrected
    /// and counted: negative numbers and NaN become 0, infinite ones 65504 or the largest number of the image.
    ///
    /// # Errors
    /// None yet.
    pub fn new(mut image: Image) -> Result<Self> {
        let repaired = equirect::repaired(&mut image);
        let picture = Equirect::new(&image);
        drop(image);
        let levels = prefilter::levels(&picture);
        Ok(Self { levels, picture, distribution: OnceLock::new(), repaired })
    }

    /// The number of texels of the image that were corrected.
    pub fn repaired_texels(&self) -> usize {
        self.repaired
    }

    /// Returns the memory that it occupies in bytes, including the distribution for sampling directions.
    #[doc(hidden)]
    pub fn bytes(&self) -> u64 {
        const TEXEL: u64 = 6;
        /// Its levels, and the density of each direction, whose sizes are bounded.
        const DERIVED: u64 = 32 << 20;
        (self.picture.width() * self.picture.height()) as u64 * TEXEL + DERIVED
    }

    /// The radiance from a direction, linear RGB.
    pub fn radiance<L: Number>(&self, direction: Vec3<L>) -> Vec3<L> {
        self.picture.radiance_at(uv_of(direction))
    }

    /// The radiance that a rough mirror at `direction` gathers, linear RGB: the mean over the GGX lobe of this
    /// `roughness`, [0, 1], as seen along the normal, weighted by n·l. At roughness 0 it is [`Self::radiance`].
    ///
    /// Law: within 1 % of the integral over all texels from roughness 0.2 upwards
    /// (`environments::levels_are_integrals_over_all_texels`).
    /// Source: Karis 2013, "Pre-Filtered Environment Map".
    pub fn specular<L: Number>(&self, direction: Vec3<L>, roughness: L) -> Vec3<L> {
        self.levels.at(direction, roughness, || self.radiance(direction))
    }

    /// The irradiance on a plane with the unit normal `n`, linear RGB: π times the level of roughness 1, whose lobe is
    /// the cosine.
    ///
    /// Law: within 2 % of the integral over all texels (`laws::environment::irradiance_is_the_integral_over_all_texels`).
    pub fn irradiance<L: Number>(&self, n: Vec3<L>) -> Vec3<L> {
        let one = n.x.lit(1.0);
        self.levels.at(n, one, || self.radiance(n)) * one.lit(std::f64::consts::PI)
    }

    /// The position of a direction of any length in the filtered maps.
    #[inline(always)]
    pub(crate) fn place_of<L: Lane>(direction: Vec3<L>) -> [L; 2] {
        octahedral_place(direction)
    }

    /// The irradiance up to the second degree of spherical harmonics, for engines that expect this form. On the dark
    /// side of a room with few lamps, its error is a quarter, while [`Self::irradiance`] is accurate.
    pub fn irradiance_harmonics(&self) -> IrradianceHarmonics {
        IrradianceHarmonics::new(&self.picture)
    }

    /// Returns the images in which this environment is looked up.
    pub fn maps(&self) -> EnvironmentMaps<'_> {
        let levels = self.levels.0.iter().map(|level| {
            let map = &level.map;
            HalfPicture::new([map.side() + 2; 2], map.texels())
        });
        EnvironmentMaps {
            levels: levels.collect(),
            smoothest_alpha: self.levels.0[0].alpha,
            picture: HalfPicture::new([self.picture.width(), self.picture.height()], self.picture.texels()),
        }
    }

    /// Samples a direction proportionally to radiance. `u` in [0, 1)².
    pub fn sample(&self, u: [f32; 2]) -> EnvironmentSample {
        let (direction, pdf) = self.distribution().sample(u);
        EnvironmentSample { direction, radiance: self.radiance(direction), pdf }
    }

    /// The density of [`Self::sample`] in a direction, sr⁻¹, above 0.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.distribution().pdf(direction)
    }

    fn distribution(&self) -> &Distribution {
        self.distribution.get_or_init(|| Distribution::new(&self.picture))
    }
}

impl<'e> HalfPicture<'e> {
    fn new([width, height]: [usize; 2], texels: &'e HalfTexels) -> Self {
        Self { width, height, texels: texels.texels(), factor: texels.half_factor() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;

    #[test]
    fn pictures_hold_the_light_that_is_looked_up() {
        let light = [0.25, 0.5, 2.0];
        let image = Image::new(32, 16, [light[0], light[1], light[2], 1.0]).unwrap();
        let environment = Environment::new(image).unwrap();
        let maps = environment.maps();
        let texel = |picture: &HalfPicture<'_>, i: usize| {
            picture.texels[i].map(|bits| f16::from_bits(bits).to_f32() * picture.factor)
        };
        assert_eq!([maps.picture.width, maps.picture.height], [32, 16]);
        assert_eq!(texel(&maps.picture, 100), light);
        assert!((2..32).contains(&maps.levels.len()) && maps.smoothest_alpha < 0.01);
        for level in &maps.levels {
            assert_eq!(level.texels.len(), level.width * level.height);
            // The border's corner, and the middle.
            for i in [0, level.texels.len() / 2] {
                let found = texel(level, i);
                let near = found.iter().zip(light).all(|(a, b)| (a / b - 1.0).abs() < 0.01);
                assert!(near, "{found:?} for {light:?}");
            }
        }
    }
}
