//! The lobe by which a level of roughness is filtered, and its decomposition into simpler lobes.
//!
//! Lobes are functions of q = 1 − cos γ, γ being the angle from the centre, so that dq is solid angle divided by 2π.

use crate::math::{integration, scalar};
use std::f64::consts::LN_2;

/// Legendre coefficients of a lobe, from degree 0: its factors of the harmonics of an image.
pub(super) type Coefficients = Vec<f64>;

/// The lobe of GGX for a surface seen along its normal, times n·l, as the split sum requires: K(q) = (1 − q) (1 + b
/// q)⁻² up to q = 1, with b = (1 − α²)/(2α²).
///
/// With n = v = r the half vector is at γ/2, so D(h) is (α² + q (1 − α²)/2)⁻² up to a factor, the Jacobian 1/(4 v·h)
/// leaves n·h of the density, and n·l = 1 − q.
/// Source: Walter et al. 2007, eq. 33 and 38; Karis 2013, "Pre-Filtered Environment Map".
#[derive(Debug, Clone, Copy)]
pub(super) struct Ggx {
    alpha: f64,
    b: f64,
}

impl Ggx {
    /// `alpha` in (0, 1].
    pub(super) fn new(alpha: f64) -> Self {
        Self { alpha, b: (1.0 - alpha * alpha) / (2.0 * alpha * alpha) }
    }

    pub(super) fn alpha(self) -> f64 {
        self.alpha
    }

    /// K(q), 1 at the centre.
    fn value(self, q: f64) -> f64 {
        let t = 1.0 + self.b * q;
        (1.0 - q) / (t * t)
    }

    /// ∫ K P_l dq / ∫ K dq for each degree up to `degree`, by a quadrature `rule` of 64 nodes.
    pub(super) fn coefficients(self, degree: usize, rule: &[(f64, f64)]) -> Coefficients {
        let mut ends = vec![0.0];
        let mut end = self.alpha * self.alpha;
        while end < 0.5 {
            ends.push(end);
            end *= 4.0;
        }
        ends.push(1.0);
        let mut sums = vec![0.0; degree + 1];
        for (q, weight) in integration::nodes_of(rule, &ends) {
            let weight = weight * self.value(q);
            legendre(1.0 - q, &mut sums, |sum, p| *sum += weight * p);
        }
        sums.iter().map(|sum| sum / sums[0]).collect()
    }

    /// The weight in the lobe of a [`Fisher`] lobe with the concentration `kappa`, for concentrations a factor of two
    /// apart: the sum over all of them is K / ∫ K within 1e-4, except behind the surface.
    ///
    /// (1 + bq)⁻² is ∫ κ/b² exp(−κ/b) exp(−κq) dκ, a mixture with Gamma's density; the factor 1 − q turns the density
    /// into (κ − 1 + κ/b) exp(−κ/b)/b² by integration by parts. The trapezoidal rule over ln κ is exact to
    /// |Γ(2 + 2πi/ln 2)|. ∫ K dq = (b − ln(1 + b))/b².
    pub(super) fn share(self, kappa: f64) -> f64 {
        let t = kappa / self.b;
        // Beyond, exp(−t) is 0; and if b is 0, t is infinite.
        if t > 40.0 {
            return 0.0;
        }
        LN_2 * (kappa + t - 1.0) * scalar::exp(-t) / (self.b - scalar::ln(1.0 + self.b))
    }
}

/// The lobe exp(−κq): the Gaussian of the sphere, with variance 1/κ along each axis if it is narrow.
///
/// Source: Fisher 1953, eq. 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fisher {
    /// The concentration, at least 10.
    pub(super) kappa: f64,
}

impl Fisher {
    /// Creates a lobe of about this standard deviation, in radians.
    pub(super) fn of_width(sigma: f64) -> Self {
        Self { kappa: 1.0 / (sigma * sigma) }
    }

    /// Its standard deviation, in radians.
    pub(super) fn width(self) -> f64 {
        1.0 / self.kappa.sqrt()
    }

    /// The lobe that turns `narrower` into `self`, very nearly: their mean cosines 1 − 1/κ multiply.
    pub(super) fn after(self, narrower: Self) -> Self {
        let mean = |lobe: Self| 1.0 - 1.0 / lobe.kappa;
        Self { kappa: 1.0 / (1.0 - mean(self) / mean(narrower)) }
    }

    /// The ratio of modified spherical Bessel functions i_l(κ)/i₀(κ), by their continued fraction from above.
    pub(super) fn coefficients(self, degree: usize) -> Coefficients {
        let far = degree + (8.0 * self.kappa.sqrt()) as usize;
        let mut ratio = 0.0;
        let mut ratios = vec![1.0; degree + 1];
        for l in (1..=far).rev() {
            ratio = 1.0 / ((2 * l + 1) as f64 / self.kappa + ratio);
            if l <= degree {
                ratios[l] = ratio;
            }
        }
        ratios.iter().scan(1.0, |product, ratio| Some(*product * ratio).inspect(|p| *product = *p)).collect()
    }
}

/// Passes each of `values` with the Legendre polynomial of its degree at x.
fn legendre(x: f64, values: &mut [f64], mut give: impl FnMut(&mut f64, f64)) {
    let (mut below, mut p) = (0.0, 1.0);
    for (l, value) in values.iter_mut().enumerate() {
        give(value, p);
        let l = l as f64;
        (below, p) = (p, ((2.0 * l + 1.0) * x * p - l * below) / (l + 1.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ f over q, with dense nodes for narrow lobes.
    fn integral(f: impl FnMut(f64) -> f64) -> f64 {
        let mut ends = vec![0.0];
        ends.extend((0..28).map(|k| 2.0 / f64::from(1u32 << (27 - k))));
        integration::integrate(40, &ends, f)
    }

    #[test]
    fn the_lobe_is_that_of_ggx() {
        use crate::shade::microfacets::d_ggx;
        for (alpha, q) in [(0.04, 0.001), (0.04, 0.3), (0.5, 0.7), (1.0, 0.2)] {
            let half = |q: f64| (1.0 - q / 2.0).sqrt();
            let by_definition = |q: f64| d_ggx(half(q), q / 2.0, alpha) / 4.0 * (1.0 - q);
            let ratio = Ggx::new(alpha).value(q) * by_definition(0.0) / by_definition(q);
            assert!((ratio - 1.0).abs() < 1e-12, "{alpha} {q}: {ratio}");
        }
    }

    #[test]
    fn coefficients_are_integrals_of_legendre_polynomials() {
        for kappa in [20.0, 300.0, 5e4] {
            let found = Fisher { kappa }.coefficients(64);
            let total = integral(|q| scalar::exp(-kappa * q));
            for l in [0, 1, 2, 10, 64] {
                let truth = integral(|q| {
                    let mut p = vec![0.0; l + 1];
                    legendre(1.0 - q, &mut p, |p, value| *p = value);
                    p[l] * scalar::exp(-kappa * q)
                });
                assert!((found[l] - truth / total).abs() < 1e-9, "{kappa} {l}: {}", found[l]);
            }
        }
        // The clamped cosine: Ramamoorthi and Hanrahan 2001, eq. 8, over π.
        let cosine = Ggx::new(1.0).coefficients(4, &integration::gauss_legendre(64));
        for (found, truth) in cosine.iter().zip([1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0]) {
            assert!((found - truth).abs() < 1e-12, "{found} {truth}");
        }
    }

    #[test]
    fn the_lobe_is_a_sum_of_simpler_ones() {
        for alpha in [0.004, 0.04, 0.1] {
            let lobe = Ggx::new(alpha);
            let total = integral(|q| lobe.value(q).max(0.0));
            for q in [0.0, 0.3, 1.0, 4.0, 40.0].map(|x| x * alpha * alpha) {
                let part = |k: i32| {
                    let kappa = 17.0 * scalar::exp2(f64::from(k));
                    lobe.share(kappa) * kappa * scalar::exp(-kappa * q)
                };
                let sum: f64 = (-20..30).map(part).sum();
                let truth = lobe.value(q) / total;
                assert!((sum / truth - 1.0).abs() < 2e-4, "{alpha} {q}: {sum} {truth}");
            }
        }
    }

    #[test]
    fn widening_twice_is_widening_once() {
        let (narrow, wide) = (Fisher::of_width(0.03), Fisher::of_width(0.07));
        let step = wide.after(narrow).coefficients(64);
        let both = narrow.coefficients(64).into_iter().zip(step).map(|(a, b)| a * b);
        for (both, wide) in both.zip(wide.coefficients(64)) {
            assert!((both - wide).abs() < 2e-4, "{both} {wide}");
        }
    }
}
