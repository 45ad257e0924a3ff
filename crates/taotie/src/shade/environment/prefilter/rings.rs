//! Pictures of the sphere on rings of latitude, and smooth lookup in them.

use crate::math::scalar;
use crate::parallel;
use std::f64::consts::PI;

/// A pixel: linear RGB, and a fourth number that is carried along for the sake of speed.
pub(super) type Pixel = [f32; 4];

/// An equirectangular image on its way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rings {
    /// Pixels a ring, even.
    pub(super) width: usize,
    /// Rings; that of row y lies at the polar angle (y + ½)π/height.
    pub(super) height: usize,
    /// Row by row from the top.
    pub(super) pixels: Vec<Pixel>,
}

/// The weight of each pixel of a row in an integral over the sphere; the scale does not matter.
pub(super) enum Areas {
    /// Its solid angle: light is even in each texel.
    Solid,
    /// The weight that integrates exactly all that rings of this number can show.
    Smooth,
}

impl Rings {
    /// All black.
    pub(super) fn black(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![[0.0; 4]; width * height] }
    }

    /// The angle between rings.
    pub(super) fn step(&self) -> f64 {
        PI / self.height as f64
    }

    /// The polar angle of a ring.
    pub(super) fn polar(&self, y: usize) -> f64 {
        (y as f64 + 0.5) * self.step()
    }

    pub(super) fn row(&self, y: usize) -> &[Pixel] {
        &self.pixels[y * self.width..][..self.width]
    }

    /// The weight of a pixel in each row. Source of the smooth ones: Fejér's first rule, as in Waldvogel 2006, eq. 2.3.
    pub(super) fn areas(&self, kind: &Areas) -> Vec<f64> {
        let smooth = |polar: f64| {
            let term = |k: usize| scalar::cos(2.0 * k as f64 * polar) / (4 * k * k - 1) as f64;
            1.0 - 2.0 * (1..=self.height / 2).map(term).sum::<f64>()
        };
        let area = |polar| match kind {
            Areas::Solid => scalar::sin(polar),
            Areas::Smooth => smooth(polar),
        };
        (0..self.height).map(|y| area(self.polar(y))).collect()
    }

    /// Adds images of the same size, each times its weight.
    pub(super) fn add(&mut self, others: &[(f32, &Self)]) {
        parallel::pieces(&mut self.pixels, self.width, &|y, row| {
            for (weight, other) in others {
                for (pixel, other) in row.iter_mut().zip(other.row(y)) {
                    accumulate(pixel, *weight, other);
                }
            }
        });
    }

    /// The image on twice as many rings of twice as many pixels, by the same cubic as [`Self::cubic`].
    pub(super) fn doubled(&self) -> Self {
        let mut output = Self::black(self.width * 2, self.height * 2);
        parallel::pieces(&mut output.pixels, self.width * 2, &|y, row| {
            let (first, weights) = halfway(y);
            let mut down = vec![[0.0; 4]; self.width];
            for (k, weight) in weights.into_iter().enumerate() {
                let (from, turn) = self.through_pole(first + k as isize);
                let (early, late) = self.row(from).split_at(turn as usize);
                for (sum, pixel) in down.iter_mut().zip(late.iter().chain(early)) {
                    accumulate(sum, weight, pixel);
                }
            }
            for (x, pixel) in row.iter_mut().enumerate() {
                let (first, weights) = halfway(x);
                *pixel = across(&down, first, weights);
            }
        });
        output
    }

    /// The image at (u, v) in [0, 1]² by Catmull and Rom's cubic, smooth across the seam and through the poles.
    pub(super) fn cubic(&self, [u, v]: [f32; 2]) -> Pixel {
        // One pixel on, so that what is cut off is what lies below.
        let (x, y) = (u * self.width as f32 + 0.5, v * self.height as f32 + 0.5);
        let (left, top) = (x as isize, y as isize);
        let (weights, down) = (catmull_rom(x - left as f32), catmull_rom(y - top as f32));
        let mut sum = [0.0; 4];
        for (k, weight) in down.into_iter().enumerate() {
            let (row, turn) = self.through_pole(top + k as isize - 2);
            accumulate(&mut sum, weight, &across(self.row(row), left - 2 + turn, weights));
        }
        sum
    }

    /// The row that lies `y` rows from the top if one walks on beyond the poles, and how far it is turned.
    fn through_pole(&self, y: isize) -> (usize, isize) {
        let (height, turned) = (self.height as isize, self.width as isize / 2);
        match y {
            y if y < 0 => ((-1 - y) as usize, turned),
            y if y >= height => ((2 * height - 1 - y) as usize, turned),
            y => (y as usize, 0),
        }
    }
}

/// Four neighbours of a row from column `x` on, weighted. The column is at most one row's length outside.
#[inline(always)]
fn across(row: &[Pixel], x: isize, weights: [f32; 4]) -> Pixel {
    let width = row.len() as isize;
    let mut sum = [0.0; 4];
    if x >= 0 && x + 4 <= width {
        for (weight, pixel) in weights.into_iter().zip(&row[x as usize..]) {
            accumulate(&mut sum, weight, pixel);
        }
    } else {
        for (k, weight) in weights.into_iter().enumerate() {
            accumulate(&mut sum, weight, &row[(x + k as isize).rem_euclid(width) as usize]);
        }
    }
    sum
}

/// The neighbours of pixel `x` of twice as many: the first of four among the half, and their weights.
fn halfway(x: usize) -> (isize, [f32; 4]) {
    let (half, odd) = ((x / 2) as isize, x % 2);
    if odd == 1 { (half - 1, catmull_rom(0.25)) } else { (half - 2, catmull_rom(0.75)) }
}

/// sum += weight · pixel
#[inline(always)]
pub(super) fn accumulate(sum: &mut Pixel, weight: f32, pixel: &Pixel) {
    let ([a, b, c, d], [r, g, b2, e]) = (*sum, *pixel);
    *sum = [a + weight * r, b + weight * g, c + weight * b2, d + weight * e];
}

/// Weights of four neighbours for a place `t` in [0, 1] between the middle two.
///
/// Source: Catmull and Rom 1974; Keys 1981, eq. 15 with a = −½.
#[inline(always)]
pub(super) fn catmull_rom(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [-0.5 * t3 + t2 - 0.5 * t, 1.5 * t3 - 2.5 * t2 + 1.0, -1.5 * t3 + 2.0 * t2 + 0.5 * t, 0.5 * t3 - 0.5 * t2]
}
