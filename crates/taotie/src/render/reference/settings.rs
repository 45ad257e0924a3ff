//! Settings of the path tracer: how many paths are followed, and how far.

use crate::error::{Error, Result};
use crate::math::sequence::Sequence;
use crate::names::Named;

/// Settings of the path tracer: how many paths are followed, and how far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct ReferenceSettings {
    /// Paths a pixel, 1 to 65536. Noise falls at least with its square root.
    pub spp: u32,
    /// The most reflections of light after its first, up to 1000; 0 is direct light.
    pub bounces: u32,
    /// The seed of the noise. Another number gives other noise.
    pub seed: u32,
    /// The meaning of a mapped normal.
    pub normal_mapping: NormalMapping,
    /// The method that finds light of the environment. No choice changes what the noise tends to.
    pub environment: EnvironmentSampling,
}

impl Default for ReferenceSettings {
    fn default() -> Self {
        Self {
            spp: 64,
            bounces: 4,
            seed: 0,
            normal_mapping: NormalMapping::Classic,
            environment: EnvironmentSampling::Combined,
        }
    }
}

/// The meaning of a mapped normal to light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum NormalMapping {
    /// The surface reflects as if it lay at a right angle to it, as in the rasteriser.
    #[default]
    Classic,
    /// The surface is grooved: one facet lies so, and an upright mirror makes up for it
    /// ([`Facets`](crate::shade::Facets)). Printed bumps stay classic.
    Microfacet,
}

impl Named for NormalMapping {
    const WHAT: &'static str = "way of normal mapping";
    const NAMES: &'static [(&'static str, Self)] =
        &[("classic", Self::Classic), ("microfacet", Self::Microfacet)];
}

/// The method that finds light of the environment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum EnvironmentSampling {
    /// Both ways are used, each where it is the better one: the least noise.
    #[default]
    Combined,
    /// Directions are chosen towards where the environment is bright.
    ByLight,
    /// Directions are chosen towards where the surface reflects much.
    BySurface,
}

impl ReferenceSettings {
    /// The most bounces.
    pub const MOST_BOUNCES: u32 = 1000;

    pub(super) fn check(&self) -> Result<()> {
        if !(1..=Sequence::MOST).contains(&self.spp) {
            let what = format!("{} paths a pixel", self.spp);
            return Err(Error::invalid(what, format!("choose from 1 to {}", Sequence::MOST)));
        }
        if self.bounces > Self::MOST_BOUNCES {
            let what = format!("{} bounces", self.bounces);
            return Err(Error::invalid(what, format!("choose from 0 to {}", Self::MOST_BOUNCES)));
        }
        Ok(())
    }
}
