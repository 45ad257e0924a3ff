//! The curl of the estimated slopes: that of a surface is 0.
//!
//! Negated y of the lights, as where y points down, only negates y of the normals: the residuals stay the same, but the
//! curl does not. Negated x has the same effect on the curl, and both negated together have none.

use crate::bilateral::slope;
use crate::estimate::{Estimate, PixelEstimate};
use crate::grid::Grid;
use taotie_engine::math::Vec3;

/// The least z of a normal that counts: slopes of steeper ones are uncertain.
const LEAST_Z: f64 = 0.35;
/// The largest curl that counts in full, change of slope per pixel: larger ones are depth edges.
const MOST_CURL: f64 = 0.2;
/// The fewest squares of four pixels that show the curl.
const FEWEST: usize = 64;
/// The fraction of the curl from which negated normals are clearly more integrable.
const CLEARLY: f64 = 0.5;

/// Root mean square curls of the slopes, per pixel; each is bounded, as at depth edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curl {
    /// That of the normals.
    pub estimated: f64,
    /// That of the normals with negated y, or negated x, which is the same.
    pub negated: f64,
}

impl Curl {
    /// Returns true if the normals are those of a surface only with y or x negated.
    pub fn is_negated(&self) -> bool {
        self.negated < CLEARLY * self.estimated
    }
}

impl Estimate {
    /// Returns the curl of the best normals; `None` with too few neighbours.
    pub fn curl(&self) -> Option<Curl> {
        let has = |(pixel, best): (&u32, &Option<PixelEstimate>)| Some((*pixel, best.as_ref()?.normal));
        let (pixels, normals): (Vec<u32>, Vec<Vec3<f64>>) =
            self.pixels.iter().zip(&self.best).filter_map(has).unzip();
        curl(&Grid::new(self.width() as usize, self.height() as usize, pixels), &normals)
    }
}

/// Returns the curl around all squares of four pixels.
fn curl(grid: &Grid, normals: &[Vec3<f64>]) -> Option<Curl> {
    let (mut sums, mut count) = ([0.0; 2], 0);
    for a in 0..normals.len() {
        let [x, y] = grid.position(a).map(|v| v as i64);
        let around = [(0, 0), (1, 0), (0, -1), (1, -1)].map(|(dx, dy)| grid.at(x + dx, y + dy));
        let [Some(a), Some(right), Some(above), Some(across)] = around else { continue };
        let [a, right, above, across] = [a, right, above, across].map(|i| normals[i]);
        if [a, right, above, across].iter().any(|n| n.z < LEAST_Z) {
            continue;
        }
        let rise = |from: Vec3<f64>, to: Vec3<f64>, axis: usize| 0.5 * (slope(from, axis) + slope(to, axis));
        // Up by the slope to the right, and to the right by the slope upwards.
        let of_x = rise(above, across, 0) - rise(a, right, 0);
        let of_y = rise(right, across, 1) - rise(a, above, 1);
        for (sum, curl) in sums.iter_mut().zip([of_x - of_y, of_x + of_y]) {
            *sum += (curl * curl).min(MOST_CURL * MOST_CURL);
        }
        count += 1;
    }
    let [estimated, negated] = sums.map(|sum| (sum / f64::from(count)).sqrt());
    (count as usize >= FEWEST).then_some(Curl { estimated, negated })
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::scalar;

    /// Returns the curl of waves with a step of depth, in noise; `signs` are those of x and y.
    fn waves(signs: [f64; 2], noise: f64) -> Curl {
        let side = 40;
        let mut state = 3_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let normal = |i: usize| {
            let [x, y] = [i % side, side - 1 - i / side].map(|v| 0.2 * v as f64);
            let phase = if i % side < 20 { 0.0 } else { 2.0 };
            let p = 0.8 * scalar::cos(x + phase) * scalar::cos(y) + noise * random();
            let q = -0.8 * scalar::sin(x + phase) * scalar::sin(y) + noise * random();
            Vec3::new(-p * signs[0], -q * signs[1], 1.0).normalize_or(Vec3::splat(0.0))
        };
        let normals: Vec<Vec3<f64>> = (0..side * side).map(normal).collect();
        curl(&Grid::new(side, side, (0..(side * side) as u32).collect()), &normals).unwrap()
    }

    #[test]
    fn negated_axes_have_a_curl() {
        for noise in [0.0, 0.1] {
            assert!(!waves([1.0, 1.0], noise).is_negated(), "{:?}", waves([1.0, 1.0], noise));
            assert!(waves([1.0, -1.0], noise).is_negated(), "{:?}", waves([1.0, -1.0], noise));
            assert!(waves([-1.0, 1.0], noise).is_negated());
            // The same surface, convex instead of concave.
            assert!(!waves([-1.0, -1.0], noise).is_negated());
        }
        assert!(!waves([1.0, -1.0], 2.0).is_negated(), "noise has a curl with either sign");
    }

    #[test]
    fn few_pixels_say_nothing() {
        let flat = vec![Vec3::new(0.0, 0.0, 1.0); 36];
        assert_eq!(curl(&Grid::new(6, 6, (0..36).collect()), &flat), None);
        let flat = vec![Vec3::new(0.0, 0.0, 1.0); 144];
        let flat = curl(&Grid::new(12, 12, (0..144).collect()), &flat).unwrap();
        assert!(!flat.is_negated(), "{flat:?}");
    }
}
