//! A path tracer, the reference for every approximation. It follows paths of light individually, without bias, over
//! the same scene, materials, normals and lights as the rasteriser.
//!
//! A path starts at a uniformly sampled point of a pixel and meets surfaces (see [`tracer`]). At each it gathers
//! direct light: from every point, spot and directional light by a shadow ray, and from the environment by two
//! techniques that are weighted against each other: sampling the environment's brightness, and sampling the surface's
//! reflection ([`bsdf`]). Then it continues in the second direction. Reflection is
//! [`SurfacePoint::reflect`](crate::pixel::SurfacePoint::reflect), so that every named model works, physical or not.
//! Textures are read at their finest level, since a pixel's many paths average them.
//!
//! Interpolation, normals, the origins of shadow rays, and the treatment of light behind the shading normal as
//! shadowed are the same as in the rasteriser, so that direct light is equal. One thing differs: blended surfaces
//! transmit light in proportion to their transparency, while the rasteriser's cast no shadow.

mod bsdf;
mod image;
mod tracer;
mod walk;

pub use image::reference;

use crate::error::{Error, Result};
use crate::math::integration::Sequence;
use crate::names::Named;

/// Settings of the path tracer: the number of paths and their length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct ReferenceSettings {
    /// Paths per pixel, 1 to 65536. Noise decreases at least with its square root.
    pub spp: u32,
    /// The maximum number of reflections of light after the first, up to 1000; 0 means direct light.
    pub bounces: u32,
    /// The seed of the noise. Another seed gives different noise.
    pub seed: u32,
    /// The interpretation of a mapped normal.
    pub normal_mapping: NormalMapping,
    /// The technique for sampling light from the environment. No choice changes the limit of the noise.
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

/// How light interprets a mapped normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NormalMapping {
    /// The surface reflects as if it were perpendicular to the normal, as in the rasteriser.
    #[default]
    Classic,
    /// The surface is grooved: one facet is perpendicular to the normal, and an upright mirror compensates
    /// ([`Facets`](crate::shade::Facets)). Printed bumps stay classic.
    Microfacet,
}

impl Named for NormalMapping {
    const WHAT: &'static str = "normal mapping mode";
    const NAMES: &'static [(&'static str, Self)] =
        &[("classic", Self::Classic), ("microfacet", Self::Microfacet)];
}

/// The technique for sampling light from the environment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EnvironmentSampling {
    /// Both techniques are used, weighted by which is better: the least noise.
    #[default]
    Combined,
    /// Directions are sampled by the brightness of the environment.
    ByLight,
    /// Directions are sampled by the reflection of the surface.
    BySurface,
}

impl ReferenceSettings {
    /// The maximum number of bounces.
    pub const MOST_BOUNCES: u32 = 1000;

    fn check(&self) -> Result<()> {
        if !(1..=Sequence::MOST).contains(&self.spp) {
            let what = format!("{} paths per pixel", self.spp);
            return Err(Error::invalid(what, format!("expected 1 to {}", Sequence::MOST)));
        }
        if self.bounces > Self::MOST_BOUNCES {
            let what = format!("{} bounces", self.bounces);
            return Err(Error::invalid(what, format!("expected 0 to {}", Self::MOST_BOUNCES)));
        }
        Ok(())
    }
}
