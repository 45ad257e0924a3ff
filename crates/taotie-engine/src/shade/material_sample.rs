//! The material sample, the parameters of a surface at a point, and the energy compensation in it: the light that a
//! lobe loses by single scattering.

use super::dfg::Dfg;
use crate::math::{Lane, Vec3};
use crate::names::Named;

/// A material sample: the parameters of a surface at a point. Each model reads the fields it knows and ignores the
/// rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialSample<L> {
    /// ρ, linear RGB in [0, 1]; diffuse colour of `lambert`, `ggx` and `ggx-printed`.
    pub base_color: Vec3<L>,
    /// [0, 1]; 1 has no diffuse part in `ggx`.
    pub metallic: L,
    /// Perceptual roughness, [0, 1]; α is its square (in `ggx-printed`, α is the roughness itself).
    pub roughness: L,
    /// Reflectance at normal incidence, linear RGB in [0, 1], already mixed by `metallic`.
    pub f0: Vec3<L>,
    /// Reflectance at grazing incidence, [0, 1]; 1 except for weakened dielectrics.
    pub f90: L,
    /// Lazányi coefficient of the reflectance at 82°, see [`super::fresnel::f82_drop`]; 0 means Schlick.
    pub f82_drop: Vec3<L>,
    /// k_d or C_diff of the classic models and of Cook-Torrance, linear RGB in [0, 1].
    pub diffuse: Vec3<L>,
    /// k_s or C_spec of the classic models and of Cook-Torrance, linear RGB in [0, 1].
    pub specular: Vec3<L>,
    /// Exponent of Phong and Blinn-Phong, at least 0.
    pub shininess: L,
    /// Beckmann's rms slope m of Cook-Torrance, above 0.
    pub slope: L,
    /// Light scattered by several facets, for `ggx` and `cook-torrance`; `None` follows light only to its first
    /// facet.
    pub compensation: Option<Compensation<L>>,
}

/// How microfacet models treat energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Energy {
    /// Light scattered several times is added: a white surface reflects all light at any roughness.
    #[default]
    Compensated,
    /// Light is followed only to its first facet, as in glTF's formulas; rough metals darken.
    Single,
}

impl Named for Energy {
    const WHAT: &'static str = "energy mode";
    const NAMES: &'static [(&'static str, Self)] =
        &[("compensated", Self::Compensated), ("single", Self::Single)];
}

/// The compensation that makes a microfacet model conserve energy, at one n·v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<L> {
    /// Multiplies the highlight, linear RGB, at least 1.
    pub gain: Vec3<L>,
    /// The fraction of light that the highlight leaves for the diffuse reflection below, [0, 1].
    pub transmitted: L,
}

/// The compensation of a lobe whose directional albedos are `dfg`, for Schlick's Fresnel factor between `f0` and `f90`
/// with Lazányi's `drop`.
///
/// gain = 1 + F0 (1 − E)/E with E = scale + bias: light that is not reflected at the first facet meets another and is
/// coloured again, so that a white metal reflects all of it. transmitted = 1 − max(gain · albedo), over the channels,
/// so that a white dielectric reflects all of it too, and no colour more than it receives.
///
/// Law: a white furnace returns 1 within 1 % at roughness 0.1 to 1 (`laws::energy`).
/// Source: Turquin 2019, "Practical multiple scattering compensation for microfacet models", eq. 16; the diffuse
/// fraction as in Jakob et al. 2014 and glTF viewers.
#[inline(always)]
pub fn compensation<L: Lane>(dfg: &Dfg<L>, f0: Vec3<L>, f90: L, drop: Vec3<L>) -> Compensation<L> {
    let one = f90.lit(1.0);
    let total = dfg.total().max(one.lit(1e-3));
    let gain = Vec3::splat(one) + f0 * ((one - total) / total).max(one.lit(0.0));
    let albedo = dfg.albedo(f0, f90, drop).mul_elements(gain);
    let most = albedo.x.max(albedo.y).max(albedo.z);
    Compensation { gain, transmitted: (one - most).clamp(0.0, 1.0) }
}
