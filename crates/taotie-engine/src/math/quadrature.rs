//! Numerical integration, for set-up and for checking formulas: not used per pixel.

use super::scalar;
use std::f64::consts::PI;

/// Nodes and weights of Gauss-Legendre quadrature with `count` nodes on [−1, 1], by Newton's method on the polynomial.
///
/// Law: exact for polynomials of degree 2 · `count` − 1 (`quadrature::tests`).
/// Source: Press et al. 2007, *Numerical Recipes*, §4.6.1.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|i| {
            let mut x = scalar::cos(PI * (i as f64 + 0.75) / (count as f64 + 0.5));
            let mut slope = 1.0;
            for _ in 0..50 {
                let (p, below) = legendre(count, x);
                slope = count as f64 * (x * p - below) / (x * x - 1.0);
                let before = x;
                x -= p / slope;
                if x == before {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Legendre polynomials of degree `count` and `count` − 1 at x.
fn legendre(count: usize, x: f64) -> (f64, f64) {
    let (mut below, mut p) = (1.0, x);
    for k in 2..=count {
        let k = k as f64;
        (below, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * below) / k);
    }
    (p, below)
}

/// Nodes and weights over all intervals between consecutive `ends`, `points` in each.
pub fn nodes(points: usize, ends: &[f64]) -> Vec<(f64, f64)> {
    nodes_of(&gauss_legendre(points), ends)
}

/// Nodes and weights over all intervals between consecutive `ends`, with a `rule` on [−1, 1] in each.
pub(crate) fn nodes_of(rule: &[(f64, f64)], ends: &[f64]) -> Vec<(f64, f64)> {
    let within = |pair: &[f64]| {
        let (middle, half) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
        rule.iter().map(|(x, w)| (middle + half * x, w * half)).collect::<Vec<_>>()
    };
    ends.windows(2).flat_map(within).collect()
}

/// ∫ f over all intervals between consecutive `ends`, `points` nodes in each.
pub fn integrate(points: usize, ends: &[f64], mut f: impl FnMut(f64) -> f64) -> f64 {
    nodes(points, ends).into_iter().map(|(x, w)| w * f(x)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in 1..=16 {
            for degree in 0..2 * count {
                let found = integrate(count, &[0.0, 0.3, 1.0], |x| (0..degree).map(|_| x).product());
                let exact = 1.0 / (degree as f64 + 1.0);
                assert!((found - exact).abs() < 1e-13, "{count} nodes, degree {degree}: {found}");
            }
            let beyond = 2 * count;
            let inexact = integrate(count, &[-1.0, 1.0], |x| (0..beyond).map(|_| x).product());
            assert!(inexact < 2.0 / (beyond as f64 + 1.0), "{count} nodes, degree {beyond}: {inexact}");
        }
    }
}
