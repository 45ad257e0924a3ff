//! The facets of a rough surface: the fraction of them that faces a direction (normal distributions), and the fraction
//! visible to the viewer and reached by the light (masking and shadowing).
//!
//! All distributions are normalised so that their projection on the surface has area one, ∫ D(h) (n·h) dh = 1 over the
//! hemisphere. `n_dot_h` and `sin2_h` = 1 − (n·h)² are passed separately, since near the highlight the former determines
//! the latter inaccurately; [`super::Angles`] has both.
//!
//! G is the visible fraction; V = G / (4 n·l n·v) is the factor next to D and F in a microfacet model.

use crate::math::Lane;
use crate::math::poly::horner;
use std::f64::consts::{FRAC_1_PI, PI};

/// The smallest α: a roughness of 0 would be a mirror, whose highlight of a point light has no finite radiance.
pub const MIN_ALPHA: f64 = 1e-3;

/// The smallest (n·h)² by which [`d_beckmann`] divides; the exponential there is zero long before.
const MIN_COS2: f64 = 1e-6;

/// α = roughness², at least 1e-3 ([`MIN_ALPHA`]).
///
/// `roughness` in [0, 1].
/// Source: Burley 2012, §5.4, as in glTF 2.0, appendix B.
#[inline(always)]
pub fn alpha_from_roughness<L: Lane>(roughness: L) -> L {
    (roughness * roughness).max(roughness.lit(MIN_ALPHA))
}

/// The α whose GGX and Beckmann lobes are about as wide as Blinn's with exponent `shininess`.
///
/// α² = 2/(s + 2)
///
/// `shininess` at least 0; α in (0, 1].
/// Law: inverse of [`shininess_from_alpha`] (`laws::shade::shininess_and_alpha_are_inverse`).
/// Source: Walter et al. 2007, §5.2.
#[inline(always)]
pub fn alpha_from_shininess<L: Lane>(shininess: L) -> L {
    (shininess.lit(2.0) / (shininess + shininess.lit(2.0))).sqrt()
}

/// The Blinn exponent for `alpha`.
///
/// s = 2/α² − 2
///
/// `alpha` in (0, 1]; s at least 0.
/// Law: inverse of [`alpha_from_shininess`] (`laws::shade::shininess_and_alpha_are_inverse`).
/// Source: Walter et al. 2007, §5.2.
#[inline(always)]
pub fn shininess_from_alpha<L: Lane>(alpha: L) -> L {
    let two = alpha.lit(2.0);
    two / (alpha * alpha) - two
}

/// Beckmann's normal distribution, D(h), in sr⁻¹.
///
/// D(h) = exp(−tan²θ_h / m²) / (π m² cos⁴θ_h), that is exp(((n·h)² − 1)/(m² (n·h)²)) / (π m² (n·h)⁴)
///
/// `n_dot_h` and `sin2_h` in [0, 1]; `slope` m above 0, taken as at least 1e-3.
/// Law: ∫ D(h) (n·h) dh = 1 over the hemisphere (`laws::shade::ndf_is_normalised`).
/// Source: Cook and Torrance 1982, eq. 5 with today's 1/π; Walter et al. 2007, eq. 25. Eq. 7 of Guo and Wang 2025 has
/// no 1/π.
#[inline(always)]
pub fn d_beckmann<L: Lane>(n_dot_h: L, sin2_h: L, slope: L) -> L {
    let cos2 = (n_dot_h * n_dot_h).max(slope.lit(MIN_COS2));
    let m = slope.max(slope.lit(MIN_ALPHA));
    let m2 = m * m;
    (-(sin2_h / (m2 * cos2))).exp() / (m2 * cos2 * cos2 * m.lit(PI))
}

/// Trowbridge–Reitz (GGX) normal distribution, D(h), in sr⁻¹.
///
/// D(h) = α² / (π ((n·h)² (α² − 1) + 1)²), computed as α² / (π ((n·h)² α² + sin²θ_h)²)
///
/// `n_dot_h` and `sin2_h` in [0, 1]; `alpha` in [1e-3, 1].
/// Law: ∫ D(h) (n·h) dh = 1 over the hemisphere (`laws::shade::ndf_is_normalised`).
/// Source: Walter et al. 2007, eq. 33.
#[inline(always)]
pub fn d_ggx<L: Lane>(n_dot_h: L, sin2_h: L, alpha: L) -> L {
    let a2 = alpha * alpha;
    let t = n_dot_h * n_dot_h * a2 + sin2_h;
    a2 / (t * t * alpha.lit(PI))
}

/// Blinn's normal distribution, D(h), in sr⁻¹.
///
/// D(h) = (s + 2)/(2π) (n·h)^s
///
/// `n_dot_h` in [0, 1]; `shininess` s at least 0.
/// Law: ∫ D(h) (n·h) dh = 1 over the hemisphere (`laws::shade::ndf_is_normalised`).
/// Source: Blinn 1977; Walter et al. 2007, eq. 30.
#[inline(always)]
pub fn d_blinn<L: Lane>(n_dot_h: L, shininess: L) -> L {
    let scale = (shininess + shininess.lit(2.0)) * shininess.lit(0.5 * FRAC_1_PI);
    scale * n_dot_h.pow(shininess)
}

/// The divergence of the facets of a GGX surface: 1 − ∫ D(m) (n·m)² dm, one minus the length of their mean normal.
///
/// α²/k (artanh(√k)/√k − 1) with k = 1 − α²: 0 at α = 0, 1/3 at α = 1, increasing. Computed as r²/3 with r/α a ratio
/// of two polynomials, within 1.5e-4 of it.
///
/// `alpha` in [1e-3, 1].
/// Law: the integral (`oracle::light::divergence_of_ggx`).
#[inline(always)]
pub fn divergence_ggx<L: Lane>(alpha: L) -> L {
    const ABOVE: [f64; 6] = [5.073_94, 5_316.18, 465_089.0, 4_210_460.0, 553_456.0, -156_759.0];
    const BELOW: [f64; 5] = [1.0, 1_294.5, 144_015.0, 1_964_230.0, 2_968_400.0];
    let above = horner!(ABOVE, alpha; 5, 4, 3, 2, 1, 0);
    let below = horner!(BELOW, alpha; 4, 3, 2, 1, 0);
    let root = alpha * above / below;
    root * root * root.lit(1.0 / 3.0)
}

/// The α² of the GGX surface whose facets have this divergence; 1 for 1/3 and beyond.
///
/// `divergence` at least that of [`MIN_ALPHA`]. With r² = 3 · divergence, α/r is a ratio of two polynomials, within
/// 6e-5.
/// Law: its root undoes [`divergence_ggx`] within 2e-4 (`oracle::light::divergence_of_ggx`).
#[inline(always)]
pub fn alpha_squared_from_divergence_ggx<L: Lane>(divergence: L) -> L {
    let root = (divergence * divergence.lit(3.0)).clamp(0.0, 1.0).sqrt();
    const ABOVE: [f64; 5] = [0.194_496, 61.889_5, 1_739.43, 5_477.82, 408.993];
    const BELOW: [f64; 5] = [1.0, 255.509, 5_484.32, 8_920.36, -6_972.45];
    let above = horner!(ABOVE, root; 4, 3, 2, 1, 0);
    let below = horner!(BELOW, root; 4, 3, 2, 1, 0);
    let alpha = root * above / below;
    (alpha * alpha).clamp(MIN_ALPHA * MIN_ALPHA, 1.0)
}

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
/// Law: with [`d_ggx`] and F = 1 the reflected energy is at most 1 and tends to 1 with α → 0
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
