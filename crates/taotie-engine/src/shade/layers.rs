//! The lobes that extensions of glTF add to a surface: anisotropic highlights as of brushed metal, a clearcoat, and
//! sheen.

use super::Angles;
use super::fresnel::pow5;
use super::microfacets::v_smith_ggx;
use super::microfacets::{alpha_from_roughness, d_ggx};
use crate::math::{Lane, Vec3};
use std::f64::consts::{FRAC_1_PI, PI};

/// A GGX lobe with different widths along a tangent and a bitangent: a highlight that is wider along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropicLobe<L> {
    /// The direction of the anisotropy, unit, perpendicular to the normal.
    pub tangent: Vec3<L>,
    /// Unit, perpendicular to both.
    pub bitangent: Vec3<L>,
    /// α along `tangent`, (0, 1].
    pub along: L,
    /// α along `bitangent`, (0, 1].
    pub across: L,
}

impl<L: Lane> AnisotropicLobe<L> {
    /// The widths of glTF: across remains α = roughness², along goes from α to 1 with the square of `strength`.
    ///
    /// `strength` and `roughness` in [0, 1].
    /// Source: KHR_materials_anisotropy.
    #[inline(always)]
    pub fn new(tangent: Vec3<L>, bitangent: Vec3<L>, roughness: L, strength: L) -> Self {
        let across = alpha_from_roughness(roughness);
        let along = across + (across.lit(1.0) - across) * strength * strength;
        Self { tangent, bitangent, along, across }
    }

    /// D V, sr⁻¹, for unit `v` and `l`.
    ///
    /// D(h) = 1 / (π α_t α_b ((t·h/α_t)² + (b·h/α_b)² + (n·h)²)²),
    /// V = 1/2 / (n·l |(α_t t·v, α_b b·v, n·v)| + n·v |(α_t t·l, α_b b·l, n·l)|)
    ///
    /// Law: the isotropic lobe if both widths are equal; ∫ D n·h dh = 1 (`laws::energy`).
    /// Source: Heitz 2014, eq. 85 and 86, height-correlated by eq. 99.
    #[inline(always)]
    pub fn lobe(&self, a: &Angles<L>, v: Vec3<L>, l: Vec3<L>) -> L {
        let half = (v + l).normalize_or(v);
        let (x, y) = (self.tangent.dot(half) / self.along, self.bitangent.dot(half) / self.across);
        let sum = x * x + y * y + a.n_dot_h * a.n_dot_h;
        let d = sum.lit(1.0) / (self.along * self.across * sum * sum * sum.lit(PI));
        let masked = a.n_dot_l * self.projected(v, a.n_dot_v) + a.n_dot_v * self.projected(l, a.n_dot_l);
        d * sum.lit(0.5) / masked.max(sum.lit(1e-7))
    }

    /// The square root of the projected roughness along `w`.
    #[inline(always)]
    fn projected(&self, w: Vec3<L>, cosine: L) -> L {
        let (x, y) = (self.tangent.dot(w) * self.along, self.bitangent.dot(w) * self.across);
        (x * x + y * y + cosine * cosine).sqrt()
    }
}

/// Reflectance at normal incidence of a clearcoat with index 1.5.
pub const COAT_F0: f64 = 0.04;

/// The reflection of a clearcoat that covers everything: f · n·l, colourless.
///
/// f = D_ggx V_smith F_schlick
///
/// `roughness` in [0, 1]; the angles are those of the clearcoat's normal.
/// Source: KHR_materials_clearcoat.
#[inline(always)]
pub fn coat_lobe<L: Lane>(roughness: L, a: &Angles<L>) -> L {
    let zero = roughness.lit(0.0);
    let alpha = alpha_from_roughness(roughness);
    let lobe = d_ggx(a.n_dot_h, a.sin2_h, alpha) * v_smith_ggx(a.n_dot_l, a.n_dot_v, alpha);
    L::select(zero.lt(a.n_dot_l), lobe * coat_fresnel(a.v_dot_h) * a.n_dot_l, zero)
}

/// Schlick's reflectance of the clearcoat, [0.04, 1].
///
/// `cosine` in [0, 1].
#[inline(always)]
pub fn coat_fresnel<L: Lane>(cosine: L) -> L {
    let f0 = cosine.lit(COAT_F0);
    let one = cosine.lit(1.0);
    f0 + (one - f0) * pow5(one - cosine)
}

/// The minimum roughness of sheen: a sharper one would only be visible edge-on.
const MIN_SHEEN_ROUGHNESS: f64 = 0.07;

/// The "Charlie" distribution of inverted Gaussian-like fibres, D(h), in sr⁻¹.
///
/// D(h) = (2 + 1/α) sin^(1/α) θ_h / (2π), α = roughness²
///
/// `sin2_h` in [0, 1]; `roughness` in [0, 1], taken as at least 0.07.
/// Source: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", eq. 2.
#[inline(always)]
pub fn d_charlie<L: Lane>(sin2_h: L, roughness: L) -> L {
    let one = sin2_h.lit(1.0);
    let kept = roughness.max(one.lit(MIN_SHEEN_ROUGHNESS));
    let inverse = one / (kept * kept);
    let sine = sin2_h.max(one.lit(1e-30)).pow(inverse * one.lit(0.5));
    (inverse + one.lit(2.0)) * sine * one.lit(0.5 * FRAC_1_PI)
}

/// The visibility of sheen, V in sr⁻¹.
///
/// V = 1 / (4 (n·l + n·v − n·l n·v)), at most 1
///
/// Both cosines in (0, 1].
/// Source: Neubelt and Pettineo 2013, "Crafting a Next-Gen Material Pipeline for The Order: 1886", after Ashikhmin.
#[inline(always)]
pub fn v_neubelt<L: Lane>(n_dot_l: L, n_dot_v: L) -> L {
    let one = n_dot_l.lit(1.0);
    (one / ((n_dot_l + n_dot_v - n_dot_l * n_dot_v) * one.lit(4.0))).min(one)
}
