//! Sheen, the reflection of fibres perpendicular to a surface, as of velvet.

use crate::math::Lane;
use std::f64::consts::FRAC_1_PI;

/// The minimum roughness of sheen: a sharper one would only be visible edge-on.
const MIN_ROUGHNESS: f64 = 0.07;

/// The "Charlie" distribution of inverted Gaussian-like fibres, D(h), in sr⁻¹.
///
/// D(h) = (2 + 1/α) sin^(1/α) θ_h / (2π), α = roughness²
///
/// `sin2_h` in [0, 1]; `roughness` in [0, 1], taken as at least 0.07.
/// Source: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", eq. 2.
#[inline(always)]
pub fn d_charlie<L: Lane>(sin2_h: L, roughness: L) -> L {
    let one = sin2_h.lit(1.0);
    let kept = roughness.max(one.lit(MIN_ROUGHNESS));
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
