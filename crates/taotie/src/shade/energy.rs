//! The energy of microfacet models, and the reflection of light from all directions.

use super::dfg::Dfg;
use super::{MaterialSample, Shading};
use crate::math::{Lane, Vec3};

/// How microfacet models treat energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Energy {
    /// Light scattered several times is added: a white surface reflects all light at any roughness.
    #[default]
    Compensated,
    /// Light is followed only to its first facet, as in glTF's formulas; rough metals darken.
    Single,
}

impl crate::names::Named for Energy {
    const WHAT: &'static str = "energy mode";
    const NAMES: &'static [(&'static str, Self)] =
        &[("compensated", Self::Compensated), ("single", Self::Single)];
}

/// The reflection of light from all directions, as weights of two radiances, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentWeights<L> {
    /// The weight of the radiance gathered by the highlight.
    pub specular: Vec3<L>,
    /// The weight of the mean radiance over the hemisphere, which is the irradiance divided by π.
    pub diffuse: Vec3<L>,
}

/// The weights for a material sample with the directional albedos `dfg` of its lobe.
///
/// `ggx` and `cook-torrance`: the split sum, the albedo and the remainder for the diffuse part. The other models have
/// no such lobe: `lambert` reflects its colour, the Phong family k_d and k_s, as if each were normalised.
/// Source: Karis 2013; the article's environment term.
#[inline(always)]
pub fn environment_weights<L: Lane>(
    shading: Shading,
    s: &MaterialSample<L>,
    dfg: &Dfg<L>,
) -> EnvironmentWeights<L> {
    let one = s.f90.lit(1.0);
    let zero = Vec3::splat(one.lit(0.0));
    let ones = Vec3::splat(one);
    let gain = s.compensation.map_or(ones, |c| c.gain);
    match shading {
        Shading::Lambert => EnvironmentWeights { specular: zero, diffuse: s.base_color },
        Shading::Ggx | Shading::GgxPrinted => {
            let diffuse = s.base_color * (one - s.metallic);
            let kept = match s.compensation {
                Some(compensation) => Vec3::splat(compensation.transmitted),
                None => ones - s.f0 - (Vec3::splat(s.f90) - s.f0) * dfg.diffuse_edge,
            };
            let specular = dfg.albedo(s.f0, s.f90, s.f82_drop).mul_elements(gain);
            EnvironmentWeights { specular, diffuse: diffuse.mul_elements(kept) }
        }
        Shading::CookTorrance | Shading::CookTorrancePrinted => {
            let specular = dfg.albedo(s.f0, s.f90, s.f82_drop).mul_elements(gain);
            EnvironmentWeights { specular: s.specular.mul_elements(specular), diffuse: s.diffuse }
        }
        Shading::Phong | Shading::BlinnPhong | Shading::BlinnPhongClassic | Shading::BlinnPhongPrinted => {
            EnvironmentWeights { specular: s.specular, diffuse: s.diffuse }
        }
    }
}

/// The visible fraction of a highlight's environment, if `occlusion` is that of the hemisphere.
///
/// Lobes narrower than the hemisphere are occluded less along the normal and more at grazing angles:
/// (n·v + o)^(2^(−16 r − 1)) − 1 + o, clamped to [0, 1]; r the roughness.
///
/// All in [0, 1]. Law: 1 if `occlusion` is 1, 0 if it is 0 and n·v is 0.
/// Source: Lagarde and de Rousiers 2014, "Moving Frostbite to PBR", listing 26, with the roughness in α's place.
#[inline(always)]
pub fn specular_occlusion<L: Lane>(n_dot_v: L, occlusion: L, roughness: L) -> L {
    let one = n_dot_v.lit(1.0);
    let exponent = (-(roughness * one.lit(16.0)) - one).exp2();
    let power = (n_dot_v + occlusion).max(one.lit(1e-6)).pow(exponent);
    (power - one + occlusion).clamp(0.0, 1.0)
}
