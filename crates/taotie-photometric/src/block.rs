//! Weighted least squares for a few pixels at a time: the inner loop of all estimators.
//!
//! A pixel's samples are I_k = b · l_k, with b the normal times the albedo (Woodham 1980). The lanes of a block are
//! pixels, so that loops over them become vector instructions; each pixel's sums run in the order of the photographs,
//! whatever the other lanes hold. Iterations are in single precision, as they only find weights; the fits that they
//! lead to are in double precision.

use crate::symmetric::Sym3;
use taotie_engine::math::Vec3;

/// Pixels of a block.
pub const LANES: usize = 8;

/// One number for each pixel of a block.
pub type Pack = [f32; LANES];

/// A light's direction from each pixel of a block, and the products of its components, xx, xy, xz, yy, yz, zz.
#[derive(Debug, Clone, Copy)]
pub struct LightTerms {
    l: [Pack; 3],
    products: [Pack; 6],
}

impl LightTerms {
    /// Computes the products from unit vectors towards the light.
    pub fn new(directions: [Vec3<f64>; LANES]) -> Self {
        let l = packs(directions);
        let product = |a: Pack, b: Pack| std::array::from_fn(|lane| a[lane] * b[lane]);
        let [x, y, z] = l;
        let pairs = [(x, x), (x, y), (x, z), (y, y), (y, z), (z, z)];
        Self { l, products: pairs.map(|(a, b)| product(a, b)) }
    }
}

/// Sums of the normal equations: Σ w l lᵀ and Σ w I l.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sums {
    matrix: [Pack; 6],
    right: [Pack; 3],
}

impl Sums {
    /// Adds one photograph with its weights.
    #[inline(always)]
    pub fn add(&mut self, light: &LightTerms, samples: &Pack, weights: &Pack) {
        for (sum, product) in self.matrix.iter_mut().zip(light.products) {
            for lane in 0..LANES {
                sum[lane] += weights[lane] * product[lane];
            }
        }
        for (sum, l) in self.right.iter_mut().zip(light.l) {
            for lane in 0..LANES {
                sum[lane] += weights[lane] * samples[lane] * l[lane];
            }
        }
    }

    /// Returns Σ w l lᵀ of one pixel.
    fn matrix(&self, lane: usize) -> Sym3 {
        Sym3(self.matrix.map(|sum| f64::from(sum[lane])))
    }

    /// Solves for b; lanes whose weights do not determine it keep `otherwise`.
    pub fn solve(&self, otherwise: &[Pack; 3]) -> [Pack; 3] {
        let mut b = *otherwise;
        for lane in 0..LANES {
            if let Some(inverse) = self.matrix(lane).inverse() {
                let solved = inverse.times(Vec3::from_array(self.right.map(|sum| f64::from(sum[lane]))));
                b.iter_mut().zip(solved.to_f32().to_array()).for_each(|(b, v)| b[lane] = v);
            }
        }
        b
    }
}

/// Returns b · l.
#[inline(always)]
pub fn shaded(b: &[Pack; 3], light: &LightTerms) -> Pack {
    let mut sum = [0.0; LANES];
    for lane in 0..LANES {
        sum[lane] =
            b[0][lane] * light.l[0][lane] + b[1][lane] * light.l[1][lane] + b[2][lane] * light.l[2][lane];
    }
    sum
}

/// Returns the vector of one pixel.
pub fn vector(b: &[Pack; 3], lane: usize) -> Vec3<f64> {
    Vec3::from_array(b.map(|component| f64::from(component[lane])))
}

/// Returns vectors of all pixels as packs.
pub fn packs(vectors: [Vec3<f64>; LANES]) -> [Pack; 3] {
    let arrays = vectors.map(|v| v.to_f32().to_array());
    std::array::from_fn(|c| arrays.map(|v| v[c]))
}

/// Returns Tukey's biweight of a residual, given the inverse of the largest that counts.
#[inline(always)]
pub fn weight(residual: f64, inverse_reach: f64) -> f64 {
    let relative = residual * inverse_reach;
    let inside = 1.0 - relative * relative;
    if inside > 0.0 { inside * inside } else { 0.0 }
}
