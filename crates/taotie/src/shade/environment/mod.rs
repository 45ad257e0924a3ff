//! Light from infinitely far all around: an equirectangular image and what is made of it once.
//!
//! Directions are unit, in the environment's own space, with +y up. The image's convention is u = atan2(z, x)/(2π) +
//! 1/2, v = acos(y)/π, both from the top left.

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
pub use octahedron::{place_of as octahedral_place, taps as octahedral_taps};
pub use studio::{STUDIO_VERSION, studio};

/// Version of what [`Environment::new`] makes and of the bytes that it is kept in: the same image gives the same bits
/// as long as it stays.
pub const ENVIRONMENT_VERSION: u32 = 3;

/// Light from infinitely far all around.
#[derive(Debug, Clone)]
pub struct Environment {
    picture: Equirect,
    levels: Levels,
    /// Made when it is first asked for: only who chooses directions at random needs it.
    distribution: OnceLock<Distribution>,
    mended: usize,
}

/// A direction chosen at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentSample {
    /// Unit, to the light.
    pub direction: Vec3,
    /// The radiance from there, linear RGB.
    pub radiance: Vec3,
    /// Density of the choice, sr⁻¹, above 0.
    pub pdf: f32,
}

impl Environment {
    /// Makes an environment from an equirectangular image, linear RGB. Texels that no light can have are corrected and
    /// counted: what is negative or not a number becomes 0, what is infinite 65504 or the largest number of the image.
    ///
    /// # Errors
    /// None yet.
    pub fn new(mut image: Image) -> Result<Self> {
        let mended = equirect::mended(&mut image);
        let picture = Equirect::new(&image);
        drop(image);
        let levels = prefilter::levels(&picture);
        Ok(Self { levels, picture, distribution: OnceLock::new(), mended })
    }

    /// The number of texels of the image that were corrected.
    pub fn mended_texels(&self) -> usize {
        self.mended
    }

    /// Returns the bytes that it takes, and choosing directions at random by it.
    #[doc(hidden)]
    pub fn bytes(&self) -> u64 {
        const TEXEL: u64 = 6;
        /// Its levels, and the likelihood of each direction, whose sizes are bounded.
        const DERIVED: u64 = 32 << 20;
        (self.picture.width() * self.picture.height()) as u64 * TEXEL + DERIVED
    }

    /// The radiance from a direction, linear RGB.
    pub fn radiance<L: Number>(&self, direction: Vec3<L>) -> Vec3<L> {
        self.picture.radiance_at(uv_of(direction))
    }

    /// The radiance that a rough mirror at `direction` gathers, linear RGB: the mean over the GGX lobe of this
    /// `roughness`, [0, 1], that is seen from straight above, weighted by n·l. At roughness 0 it is
    /// [`Self::radiance`].
    ///
    /// Law: within 1 % of the integral over all texels from roughness 0.2 on
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

    /// The place of a direction of any length in the filtered maps.
    #[inline(always)]
    pub(crate) fn place_of<L: Lane>(direction: Vec3<L>) -> [L; 2] {
        octahedron::place_of(direction)
    }

    /// The irradiance up to the second degree of spherical harmonics, for engines that take light so. On the dark side
    /// of a room with few lamps it is off by a quarter, where [`Self::irradiance`] is exact.
    pub fn irradiance_harmonics(&self) -> IrradianceHarmonics {
        IrradianceHarmonics::new(&self.picture)
    }

    /// Chooses a direction, with more likelihood where more light comes from. `u` in [0, 1)².
    pub fn sample(&self, u: [f32; 2]) -> EnvironmentSample {
        let (direction, pdf) = self.distribution().sample(u);
        EnvironmentSample { direction, radiance: self.radiance(direction), pdf }
    }

    /// The density with which [`Self::sample`] chooses a direction, sr⁻¹, above 0.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.distribution().pdf(direction)
    }

    fn distribution(&self) -> &Distribution {
        self.distribution.get_or_init(|| Distribution::new(&self.picture))
    }
}
