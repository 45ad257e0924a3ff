//! Masking and shadowing: the fraction of facets visible to the viewer and reached by the light.
//!
//! G is that fraction; V = G / (4 n·l n·v) is the factor next to D and F in a microfacet model.

use crate::math::Lane;

/// Masking of V-shaped grooves.
///
/// G = min(1, 2 n·h n·v / v·h, 2 n·h n·l / v·h)
///
/// `n_dot_l`, `n_dot_v`, `n_dot_h` in [0, 1]; `v_dot_h` in (0, 1].
/// Law: G ≤ 1, symmetric in n·l and n·v (`laws::shade::masking_is_a_share`).
/// Source: Cook and Torrance 1982, §4, after Torrance and Sparrow 1967; Guo and Wang 2025, eq. 8.
#[inline(always)]
pub fn g_v_cavity<L: Lane>(n_dot_l: L, n_dot_v: L, n_dot_h: L, v_dot_h: L) -> L {
    let slope = n_dot_h * n_dot_h.lit(2.0) / v_dot_h;
    (slope * n_dot_l.min(n_dot_v)).min(slope.lit(1.0))
}

/// Height-correlated Smith masking of GGX, as V = G / (4 n·l n·v).
///
/// V = 0.5 / (n·l √((n·v)²(1 − α²) + α²) + n·v √((n·l)²(1 − α²) + α²))
///
/// `n_dot_l` in [0, 1], `n_dot_v` in (0, 1]; `alpha` in [1e-3, 1].
/// Law: with [`super::ndf::d_ggx`] and F = 1 the reflected energy is at most 1 and tends to 1 with α → 0
/// (`laws::shade::white_furnace_of_ggx`).
/// Source: Heitz 2014, eq. 99; the form of Lagarde and de Rousiers 2014, listing 2.
#[inline(always)]
pub fn v_smith_ggx<L: Lane>(n_dot_l: L, n_dot_v: L, alpha: L) -> L {
    let a2 = alpha * alpha;
    let rest = alpha.lit(1.0) - a2;
    let to_view = (n_dot_v * n_dot_v * rest + a2).sqrt();
    let to_light = (n_dot_l * n_dot_l * rest + a2).sqrt();
    alpha.lit(0.5) / (n_dot_l * to_view + n_dot_v * to_light)
}

/// Schlick's rational approximation of Smith's masking for one direction.
///
/// g(x) = x / (k + (1 − k) x)
///
/// `cosine` x in [0, 1]; `k` in (0, 1].
/// Law: 0 at 0, 1 at 1 (`laws::shade::masking_is_a_share`).
/// Source: Schlick 1994, eq. 19, with the k of Karis 2013.
#[inline(always)]
pub fn g1_schlick_ggx<L: Lane>(cosine: L, k: L) -> L {
    cosine / (k + (k.lit(1.0) - k) * cosine)
}

/// Uncorrelated Schlick masking of GGX, as V = G / (4 n·l n·v).
///
/// V = g(n·l) g(n·v) / (4 n·l n·v) with g of [`g1_schlick_ggx`], the cosines cancelled
///
/// `n_dot_l`, `n_dot_v` in [0, 1]; `k` in (0, 1], from [`k_for_lights`] or [`k_for_environment`].
/// Law: 4 n·l n·v V ≤ 1 (`laws::shade::masking_is_a_share`).
/// Source: Karis 2013, "Specular G".
#[inline(always)]
pub fn v_schlick_ggx<L: Lane>(n_dot_l: L, n_dot_v: L, k: L) -> L {
    let rest = k.lit(1.0) - k;
    k.lit(0.25) / ((k + rest * n_dot_l) * (k + rest * n_dot_v))
}

/// k of [`g1_schlick_ggx`] under point and directional lights.
///
/// k = (roughness + 1)²/8
///
/// `roughness` in [0, 1]; k in [1/8, 1/2].
/// Source: Karis 2013, eq. 4.
#[inline(always)]
pub fn k_for_lights<L: Lane>(roughness: L) -> L {
    (roughness + roughness.lit(1.0)).squared() * roughness.lit(0.125)
}

/// k of [`g1_schlick_ggx`] under an environment.
///
/// k = roughness²/2
///
/// `roughness` in [0, 1]; k in [0, 1/2].
/// Source: Karis 2013, "Specular G": α/2 with α = roughness².
#[inline(always)]
pub fn k_for_environment<L: Lane>(roughness: L) -> L {
    roughness.squared() * roughness.lit(0.5)
}
