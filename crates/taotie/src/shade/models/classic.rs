//! Lambert, Phong and Blinn-Phong. All are called for n·l > 0.

use crate::math::{Lane, Vec3};
use crate::shade::{Angles, MaterialSample};
use std::f64::consts::FRAC_1_PI;

/// Perfectly diffuse reflection.
///
/// f · n·l = ρ/π · n·l
///
/// ρ is the base colour, regardless of `metallic`.
/// Law: reflects exactly ρ of the light (`laws::shade::lambert_reflects_its_colour`).
/// Source: Lambert 1760.
#[inline(always)]
pub(super) fn lambert<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    s.base_color * (a.n_dot_l * a.n_dot_l.lit(FRAC_1_PI))
}

/// Phong's model, neither normalised nor reciprocal.
///
/// L = k_d n·l + k_s ((r·v)⁺)^s
///
/// Ambient light is left to the caller.
/// Law: none of the physical ones (`laws::shade::unphysical_models_earn_their_names`).
/// Source: Phong 1975; Guo and Wang 2025, eq. 1, 3 and §1.2.
#[inline(always)]
pub(super) fn phong<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    s.diffuse * a.n_dot_l + s.specular * a.r_dot_v.pow(s.shininess)
}

/// Blinn-Phong with energy normalisation.
///
/// f · n·l = (C_diff/π + (s + 8)/(8π) C_spec (n·h)^s) n·l
///
/// The factor is an approximation: if C_diff + C_spec = 1, up to 7.5 % more light is reflected than arrives (s = 9,
/// seen along the normal).
/// Law: reciprocity; energy ≤ 1.0755 (`laws::shade::physical_models_stay_within_energy`).
/// Source: Blinn 1977; normalisation of Akenine-Möller, Haines and Hoffman, Real-Time Rendering, 3rd ed., eq. 7.49.
#[inline(always)]
pub(super) fn blinn_phong<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let scale = normalisation(s.shininess);
    let lobe = a.n_dot_h.pow(s.shininess);
    (s.diffuse * scale.lit(FRAC_1_PI) + s.specular * (scale * lobe)) * a.n_dot_l
}

/// Blinn-Phong without normalisation, as in fixed-function graphics.
///
/// L = C_diff n·l + C_spec (n·h)^s
///
/// Law: none of the physical ones (`laws::shade::unphysical_models_earn_their_names`).
/// Source: Blinn 1977; the article's first formula.
#[inline(always)]
pub(super) fn blinn_phong_classic<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    s.diffuse * a.n_dot_l + s.specular * a.n_dot_h.pow(s.shininess)
}

/// (s + 8)/(8π).
#[inline(always)]
pub(super) fn normalisation<L: Lane>(shininess: L) -> L {
    (shininess + shininess.lit(8.0)) * shininess.lit(0.125 * FRAC_1_PI)
}
