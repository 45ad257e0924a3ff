//! Normal distributions: which share of a rough surface's facets face a direction.
//!
//! All are normalised so that their projection on the surface has area one, ∫ D(h) (n·h) dh = 1 over the hemisphere.
//! `n_dot_h` and `sin2_h` = 1 − (n·h)² are passed apart, since near the highlight the first determines the second
//! badly; [`super::Angles`] has both.

use crate::math::{Lane, poly};
use std::f64::consts::{FRAC_1_PI, PI};

/// The smallest α: a roughness of 0 would be a mirror, whose highlight of a point light has no finite radiance.
pub const MIN_ALPHA: f64 = 1e-3;

/// The smallest (n·h)² that [`d_beckmann`] divides by; the exponential there is zero long before.
const MIN_COS2: f64 = 1e-6;

/// α = roughness², at least [`MIN_ALPHA`].
///
/// `roughness` in [0, 1].
/// Source: Burley 2012, §5.4, as in glTF 2.0, appendix B.
#[inline(always)]
pub fn alpha_from_roughness<L: Lane>(roughness: L) -> L {
    (roughness * roughness).max(roughness.lit(MIN_ALPHA))
}

/// The α whose GGX and Beckmann lobes are about as wide as Blinn's of exponent `shininess`.
///
/// α² = 2/(s + 2)
///
/// `shininess` at least 0; α in (0, 1].
/// Law: inverse of [`shininess_from_alpha`] (`laws_shade::shininess_and_alpha_are_inverse`).
/// Source: Walter et al. 2007, §5.2.
#[inline(always)]
pub fn alpha_from_shininess<L: Lane>(shininess: L) -> L {
    (shininess.lit(2.0) / (shininess + shininess.lit(2.0))).sqrt()
}

/// The Blinn exponent that goes with `alpha`.
///
/// s = 2/α² − 2
///
/// `alpha` in (0, 1]; s at least 0.
/// Law: inverse of [`alpha_from_shininess`] (`laws_shade::shininess_and_alpha_are_inverse`).
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
/// Law: ∫ D(h) (n·h) dh = 1 over the hemisphere (`laws_shade::ndf_is_normalised`).
/// Source: Cook and Torrance 1982, eq. 5 with today's 1/π; Walter et al. 2007, eq. 25. The seed paper's eq. 7 has no 1/π.
#[inline(always)]
pub fn d_beckmann<L: Lane>(n_dot_h: L, sin2_h: L, slope: L) -> L {
    let cos2 = (n_dot_h * n_dot_h).max(slope.lit(MIN_COS2));
    let m = slope.max(slope.lit(MIN_ALPHA));
    let m2 = m * m;
    poly::exp(-(sin2_h / (m2 * cos2))) / (m2 * cos2 * cos2 * m.lit(PI))
}

/// Trowbridge–Reitz (GGX) normal distribution, D(h), in sr⁻¹.
///
/// D(h) = α² / (π ((n·h)² (α² − 1) + 1)²), computed as α² / (π ((n·h)² α² + sin²θ_h)²)
///
/// `n_dot_h` and `sin2_h` in [0, 1]; `alpha` in [[`MIN_ALPHA`], 1].
/// Law: ∫ D(h) (n·h) dh = 1 over the hemisphere (`laws_shade::ndf_is_normalised`).
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
/// Law: ∫ D(h) (n·h) dh = 1 over the hemisphere (`laws_shade::ndf_is_normalised`).
/// Source: Blinn 1977; Walter et al. 2007, eq. 30.
#[inline(always)]
pub fn d_blinn<L: Lane>(n_dot_h: L, shininess: L) -> L {
    let scale = (shininess + shininess.lit(2.0)) * shininess.lit(0.5 * FRAC_1_PI);
    scale * poly::pow(n_dot_h, shininess)
}

/// How far the facets of a GGX surface diverge: 1 − ∫ D(m) (n·m)² dm, one less the length of their mean normal.
///
/// α²/k (artanh(√k)/√k − 1) with k = 1 − α²: 0 at α = 0, 1/3 at α = 1, rising.
///
/// `alpha` in [[`MIN_ALPHA`], 1].
/// Law: the integral (`oracle_light::divergence_of_ggx`).
#[inline(always)]
pub fn divergence_ggx<L: Lane>(alpha: L) -> L {
    let a2 = alpha * alpha;
    let k = alpha.lit(1.0) - a2;
    let near = k.lt(k.lit(NEAR));
    let Far { k: far, sine, log } = Far::new(near, k, a2);
    a2 * L::select(near, series(k), (log - sine) / (sine * far))
}

/// The α² of the GGX surface whose facets diverge this much; 1 for 1/3 and beyond.
///
/// `divergence` at least that of [`MIN_ALPHA`]. A polynomial in its root is within 2.3 % of α; one of Newton's steps does
/// the rest.
/// Law: its root undoes [`divergence_ggx`] within 4e-4 (`oracle_light::divergence_of_ggx`).
#[inline(always)]
pub fn alpha_squared_from_divergence_ggx<L: Lane>(divergence: L) -> L {
    let wanted = divergence.clamp(0.0, 1.0 / 3.0);
    let root = (wanted * wanted.lit(3.0)).sqrt();
    let guess = root * root.lit(8.846_5) - root.lit(21.916);
    let guess = guess * root + root.lit(19.835);
    let guess = guess * root - root.lit(7.670_4);
    let guess = guess * root + root.lit(1.705_1);
    let guess = (guess * root + root.lit(0.222_34)) * root;
    let a2 = (guess * guess).clamp(MIN_ALPHA * MIN_ALPHA, 1.0);
    let k = a2.lit(1.0) - a2;
    let near = k.lt(k.lit(NEAR));
    let Far { k: far, sine, log } = Far::new(near, k, a2);
    // Divergence and its derivative by α² have the same denominator, √k k².
    let above = (log - sine) * far * a2 - wanted * sine * far * far;
    let slope = log * (far.lit(1.5) - far * far.lit(0.5)) - sine * far.lit(1.5);
    let slope_near = k.lit(2.0 / 15.0) + k * (k.lit(4.0 / 35.0) + k * k.lit(2.0 / 21.0));
    let above = L::select(near, a2 * series(k) - wanted, above);
    let step = above / L::select(near, slope_near, slope);
    (a2 - step).clamp(MIN_ALPHA * MIN_ALPHA, 1.0)
}

/// Below this 1 − α² differences of equals lose their digits: there are series.
const NEAR: f64 = 0.05;

/// What the divergence is made of where `near` does not hold, and something harmless where it does.
struct Far<L> {
    k: L,
    /// √k.
    sine: L,
    /// artanh √k.
    log: L,
}

impl<L: Lane> Far<L> {
    #[inline(always)]
    fn new(near: L::Mask, k: L, a2: L) -> Self {
        let half = k.lit(0.5);
        let (k, a2) = (L::select(near, half, k), L::select(near, half, a2));
        let sine = k.sqrt();
        let sum = k.lit(1.0) + sine;
        Self { k, sine, log: poly::ln(sum * sum / a2) * half }
    }
}

/// The divergence over α² as a series in k = 1 − α².
#[inline(always)]
fn series<L: Lane>(k: L) -> L {
    k.lit(1.0 / 3.0) + k * (k.lit(0.2) + k * k.lit(1.0 / 7.0))
}
