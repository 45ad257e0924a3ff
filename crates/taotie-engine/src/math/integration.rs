//! Points to integrate with: the nodes and weights of quadrature, for set-up and for checking formulas, and quasi-random
//! sequences, which fill space evenly. Both are the same on every machine.

use super::scalar;
use std::f64::consts::PI;

/// Nodes and weights of Gauss-Legendre quadrature with `count` nodes on [−1, 1], by Newton's method on the polynomial.
///
/// Law: exact for polynomials of degree 2 · `count` − 1 (`integration::tests`).
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

/// Points of many dimensions in [0, 1), of which any few consecutive ones cover all of space: Sobol's sequence with
/// Owen's scrambling. Different seeds give independent sequences.
///
/// Law: of the first 4ⁿ points, each of 2ⁿ × 2ⁿ squares contains one
/// (`integration::tests::squares_hold_one_point_each`).
/// Source: Burley 2020, "Practical hash-based Owen scrambling", with its padding (§5); the crate `sobol_burley`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sequence {
    seed: u32,
}

impl Sequence {
    /// The maximum number of points in a sequence.
    pub const MOST: u32 = 1 << 16;

    /// The sequence for a seed.
    pub fn new(seed: u32) -> Self {
        Self { seed }
    }

    /// Four coordinates of point `index`, below [`Sequence::MOST`]. Those of one set cover space evenly together, and
    /// best in pairs; sets are independent of each other.
    ///
    /// Each set is the first four dimensions of a separate sequence: the later ones of Sobol's sequence leave squares
    /// empty that its first points should cover.
    pub fn four(self, index: u32, set: u32) -> [f32; 4] {
        let seed = if set == 0 { self.seed } else { hash(self.seed, set) };
        sobol_burley::sample_4d(index % Self::MOST, 0, seed)
    }
}

/// Mixes `value` into `state`: each bit of the result depends on all bits of both.
///
/// Source: the PCG hash of Jarzynski and Olano 2020, "Hash functions for GPU rendering", §4.
#[inline]
pub fn hash(state: u32, value: u32) -> u32 {
    pcg(pcg(state).wrapping_add(value))
}

#[inline]
fn pcg(v: u32) -> u32 {
    let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// A number in [0, 1) from a hash, a multiple of 2⁻²⁴.
#[inline]
pub fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / (1 << 24) as f32)
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

    #[test]
    fn squares_hold_one_point_each() {
        for (seed, set) in [(0, 0), (1, 0), (0xdead_beef, 1), (7, 64)] {
            for n in [4, 16, 64] {
                let mut held = vec![0; (n * n) as usize];
                for index in 0..n * n {
                    let [x, y, ..] = Sequence::new(seed).four(index, set);
                    let cell = (x * n as f32) as u32 + (y * n as f32) as u32 * n;
                    held[cell as usize] += 1;
                }
                assert!(held.iter().all(|count| *count == 1), "seed {seed}, set {set}, {n} a side");
            }
        }
    }

    #[test]
    fn sets_are_others() {
        let sequence = Sequence::new(3);
        let sets = [0, 1, 63, 64, 65, 128].map(|set| sequence.four(5, set).map(f32::to_bits));
        for (i, a) in sets.iter().enumerate() {
            assert!(sets[i + 1..].iter().all(|b| a != b), "set {i}");
        }
    }

    #[test]
    fn hashes_are_spread_evenly() {
        // χ² of 256 bins with 255 degrees of freedom: mean 255, standard deviation 22.6.
        for (name, of) in [
            ("value", (|i| hash(7, i)) as fn(u32) -> u32),
            ("state", |i| hash(i, 7)),
            ("square", |i| hash(hash(0, i % 512), i / 512)),
        ] {
            let mut bins = [0.0f64; 256];
            let count = 1 << 18;
            for i in 0..count {
                bins[(unit(of(i)) * 256.0) as usize] += 1.0;
            }
            let expected = f64::from(count) / 256.0;
            let chi: f64 = bins.iter().map(|n| (n - expected) * (n - expected) / expected).sum();
            assert!((170.0..340.0).contains(&chi), "{name}: {chi}");
        }
        assert!(unit(u32::MAX) < 1.0);
    }
}
