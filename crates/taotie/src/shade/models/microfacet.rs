//! Cook-Torrance and GGX. Both are called for n·l > 0.

use crate::math::{Lane, Vec3};
use crate::shade::fresnel::f_f82;
use crate::shade::masking::{g_v_cavity, v_smith_ggx};
use crate::shade::ndf::{alpha_from_roughness, d_beckmann, d_ggx};
use crate::shade::{Angles, MaterialSample};
use std::f64::consts::FRAC_1_PI;

/// Cook and Torrance's model in today's normalisation.
///
/// f · n·l = k_d/π · n·l + k_s D_beckmann G_v_cavity F / (4 n·v), the n·l of the denominator cancelled
///
/// `diffuse` is k_d times the surface's colour, `specular` is k_s. Ambient light is left to the caller.
/// Law: reciprocity; energy ≤ 1 if k_d + k_s ≤ 1 (`laws::shade`).
/// Source: Cook and Torrance 1982, eq. 1–5, with 4 for their π (Torrance and Sparrow 1967; Walter et al. 2007, eq.
/// 20).
#[inline(always)]
pub(super) fn cook_torrance<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let d = d_beckmann(a.n_dot_h, a.sin2_h, s.slope);
    let g = g_v_cavity(a.n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
    let f = f_f82(s.f0, s.f90, s.f82_drop, a.v_dot_h);
    let f = s.compensation.map_or(f, |c| f.mul_elements(c.gain));
    let lobe = d * g / (a.n_dot_v * a.n_dot_v.lit(4.0));
    s.diffuse * (a.n_dot_l * a.n_dot_l.lit(FRAC_1_PI)) + s.specular.mul_elements(f) * lobe
}

/// Metallic-roughness reflection of glTF 2.0.
///
/// f · n·l = ((1 − F)(1 − metallic) ρ/π + D_ggx V_smith F) n·l
///
/// Without compensation, the diffuse part is weighted by 1 − F(v·h) as in glTF, not by the light that the highlight
/// leaves: a metal never reflects more than arrives, but a white dielectric at a grazing angle does, up to 1.7 times
/// (1.02 over all angles); and a rough metal loses light: 1 − ln 2 of it remain at roughness 1 along the normal. With
/// compensation, F in the highlight is multiplied by its gain and 1 − F is replaced by the transmitted fraction: both
/// white surfaces then reflect exactly what arrives.
/// Law: reciprocity, energy ≤ 1 for metals, white furnace (`laws::shade::white_furnace_of_ggx`, `laws::energy`,
/// `laws::shade::a_white_dielectric_of_ggx_exceeds_its_energy_at_grazing_view_only`).
/// Source: glTF 2.0 specification, appendix B.3; Walter et al. 2007; Heitz 2014; Turquin 2019.
#[inline(always)]
pub(super) fn ggx<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>) -> Vec3<L> {
    let alpha = alpha_from_roughness(s.roughness);
    ggx_with_lobe(s, a, d_ggx(a.n_dot_h, a.sin2_h, alpha) * v_smith_ggx(a.n_dot_l, a.n_dot_v, alpha))
}

/// Like [`ggx`], for another D V.
#[inline(always)]
pub(super) fn ggx_with_lobe<L: Lane>(s: &MaterialSample<L>, a: &Angles<L>, lobe: L) -> Vec3<L> {
    let one = a.n_dot_l.lit(1.0);
    let f = f_f82(s.f0, s.f90, s.f82_drop, a.v_dot_h);
    let (f, kept) = match s.compensation {
        Some(c) => (f.mul_elements(c.gain), Vec3::splat(c.transmitted)),
        None => (f, Vec3::splat(one) - f),
    };
    let diffuse = s.base_color * ((one - s.metallic) * one.lit(FRAC_1_PI));
    (kept.mul_elements(diffuse) + f * lobe) * a.n_dot_l
}
