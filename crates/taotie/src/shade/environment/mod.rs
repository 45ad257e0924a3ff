//! Light from infinitely far away in all directions: an equirectangular image and the levels filtered from it.
//!
//! Directions are unit, in the environment's local space, with +y up. The image's convention is u = atan2(z, x)/(2π)
//! + 1/2, v = acos(y)/π, both from the top left.

mod bilinear;
mod bytes;
mod distribution;
mod equirect;
mod irradiance;
mod levels;
mod lookup;
mod maps;
mod octahedron;
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

pub use bilinear::{bilinear, linear};
pub use equirect::{PicturePosition, picture_uv};
pub use irradiance::IrradianceHarmonics;
pub use levels::{LevelPosition, share_of_smoothest};
pub use maps::{EnvironmentMaps, HalfPicture};
pub use octahedron::{octahedral_place, octahedral_taps};
pub use studio::{STUDIO_VERSION, studio};

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
