//! The models as printed by Guo and Wang 2025 and by an article, errors included. Nothing else may use these.

use super::classic::normalisation;
use crate::math::{Lane, Vec3};
use crate::shade::fresnel::pow5;
use crate::shade::masking::{g_v_cavity, g1_schlick_ggx, k_for_lights};
use crate::shade::ndf::{MIN_ALPHA, d_beckmann, d_ggx};
use crate::shade::{Angles, MaterialSample};
use std::f64::consts::{FRAC_1_PI, PI};

/// The smallest n·l by which the printed Cook-Torrance divides. G decreases with n·l, so the quotient stays finite.
const MIN_N_DOT_L: f64 = 1e-6;

/// Cook-Torrance as Guo and Wang 2025 print it; called for n·l > 0.
///
/// I = k_d n·l + k_s · F/π · D/(n·l) · G/(n·v) with F = f0 + (1 − f0)(1 − v·h)² and D = exp(…)/(m² (n·h)⁴)
///
/// Against [`super::microfacet::cook_torrance`]: the Fresnel exponent is 2 instead of 5; the highlight lacks the
/// factor n·l of the irradiance and is four times as strong; the diffuse part lacks 1/π. (D without 1/π and F/π
/// are the right 1/π in another place.) Ambient light is the caller's.
/// Law: neither reciprocal nor within energy (`laws::shade::unphysical_models_earn_their_names`).
/// Source: Guo and Wang 2025, eq. 1–8.
#[inline(always)]
pub(super) fn cook_torrance_printed<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let one = a.n_dot_l.lit(1.0);
    let d = d_beckmann(a.n_dot_h, a.sin2_h, s.slope) * one.lit(PI);
    let g = g_v_cavity(a.n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
    let f = s.f0 + (Vec3::splat(one) - s.f0) * (one - a.v_dot_h).squared();
    let n_dot_l = a.n_dot_l.max(one.lit(MIN_N_DOT_L));
    let lobe = one.lit(FRAC_1_PI) * (d / n_dot_l) * (g / a.n_dot_v);
    s.diffuse * a.n_dot_l + s.specular.mul_elements(f) * lobe
}

/// Blinn-Phong as the article's shader computes it; called for n·l > 0.
///
/// L = (C_diff/π + (m + 8)/(8π) C_spec (n·h)⁵) n·l
///
/// The exponent is 5 regardless of m = `shininess`, so a higher m is brighter instead of sharper.
/// Law: not within energy for large m (`laws::shade::unphysical_models_earn_their_names`).
/// Source: the article's shader `Custom/BlinnPhong`.
#[inline(always)]
pub(super) fn blinn_phong_printed<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let scale = normalisation(s.shininess);
    (s.diffuse * scale.lit(FRAC_1_PI) + s.specular * (scale * pow5(a.n_dot_h))) * a.n_dot_l
}

/// GGX as the article's shader computes it, also for n·l ≤ 0.
///
/// L = k_d ρ/π + k_s V F D with n·l and n·v clamped at 0,
/// D = α²/(π((n·h)²(α² − 1) + 1)²), α = roughness; F = F0 + (1 − F0)(1 − (n·h)⁵);
/// V = g(n·l) g(n·v) / (4 (n·l/2 + 1/2) n·v), g(x) = x/(k + (1 − k)x), k = (roughness + 1)²/8;
/// k_d = F0, k_s = (1 − F0)(1 − metallic)
///
/// It differs from [`super::microfacet::ggx`]: F decreases where it should increase and uses n·h for v·h; k_d and k_s
/// are swapped; the denominator has half-Lambert for n·l; α is not squared; there is no factor n·l, so the side
/// facing away from the light is lit. The shader stores F, k_d and k_s in scalars, which keeps **only the first
/// channel of F0**: so does this, and the highlight is grey. The rounding of its half floats is not imitated. α is at
/// least 1e-3, since the shader's D is 0/0 at roughness 0.
/// Law: neither reciprocal nor dark at n·l = 0 (`laws::shade::unphysical_models_earn_their_names`).
/// Source: the article's shader `Custom/BRDF`.
#[inline(always)]
pub(super) fn ggx_printed<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let one = a.n_dot_l.lit(1.0);
    let half = one.lit(0.5);
    let n_dot_l = a.n_dot_l.max(one.lit(0.0));
    let d = d_ggx(a.n_dot_h, a.sin2_h, s.roughness.max(one.lit(MIN_ALPHA)));
    let f0 = s.f0.x;
    let f = f0 + (one - f0) * (one - pow5(a.n_dot_h));
    let half_lambert = n_dot_l * half + half;
    let k = k_for_lights(s.roughness);
    let g = g1_schlick_ggx(n_dot_l, k) * g1_schlick_ggx(a.n_dot_v, k);
    let v = g / (half_lambert * a.n_dot_v * one.lit(4.0));
    let k_diffuse = f0;
    let k_specular = (one - f0) * (one - s.metallic);
    s.base_color * (k_diffuse * one.lit(FRAC_1_PI)) + Vec3::splat(k_specular * v * f * d)
}
