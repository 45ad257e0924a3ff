//! How far each photograph is shifted from the others, because the camera or the object moved.
//!
//! The gradient of the predicted brightness turns a residual into a shift (Lucas and Kanade 1981), of all photographs
//! by themselves.

use crate::residuals::{Residuals, Shift};
use taotie_engine::parallel;

/// Blocks of pixels along the longer side of the picture: their means have less noise than pixels, and change smoothly
/// over shifts of a block.
const ALONG: usize = 256;
/// The smallest side of a block, in pixels.
const LEAST_SIDE: usize = 4;
/// Blocks are this many times as large, and at most this many are compared: larger ones show larger shifts.
const SCALES: [(usize, usize); 2] = [(1, 2_000), (4, 250)];
/// The measured brightness of a block relative to its prediction, outside which it is in shadow or shows a highlight.
const EXPLAINED: [f64; 2] = [0.5, 1.5];
/// The predicted brightness, relative to the albedo, below which light grazes the surface.
const GRAZING: f64 = 0.2;
/// The fewest such blocks that show a shift.
const FEWEST: f64 = 50.0;
/// The standard deviation of a shift, in blocks, above which the surface is too uniform to show it.
const UNCERTAIN: f64 = 0.025;

/// The pixels of a block, and of those on its right, on its left, below and above.
type Cross = [Vec<usize>; 5];

/// Sums of an estimate of one shift.
#[derive(Default)]
struct Sums {
    matrix: [f64; 3],
    pull: [f64; 2],
    square: f64,
    count: f64,
}

impl Residuals<'_> {
    /// Returns for each photograph how far it is shifted from the prediction of all; `None` if the surface is too
    /// uniform to show it.
    pub fn shifts(&self) -> Vec<Option<Shift>> {
        let least = (self.grid.width.max(self.grid.height) / ALONG).max(LEAST_SIDE);
        let scales = SCALES.map(|(times, most)| (least * times, self.crosses(least * times, most)));
        parallel::tasks(self.samples.lights.len(), &|k| {
            let [fine, coarse] = [0, 1].map(|i| self.shift(k, &scales[i]));
            // A shift of several blocks leaves no trace in small ones.
            coarse.filter(|coarse| coarse.is_moved() && fine.is_none_or(|fine| !fine.is_moved())).or(fine)
        })
    }

    fn shift(&self, k: usize, (side, crosses): &(usize, Vec<Cross>)) -> Option<Shift> {
        let mut sums = Sums::default();
        crosses.iter().for_each(|cross| self.compare_blocks(k, cross, &mut sums));
        let shift = sums.shift()?;
        let blocks = (shift[0] * shift[0] + shift[1] * shift[1]).sqrt();
        Some(Shift { pixels: shift.map(|v| v * *side as f64), blocks })
    }

    /// Returns at most `most` evenly spread blocks whose neighbours are all within the mask.
    fn crosses(&self, side: usize, most: usize) -> Vec<Cross> {
        let [columns, rows] = [self.grid.width, self.grid.height].map(|v| v / side);
        let block = |x: i64, y: i64| -> Option<Vec<usize>> {
            let side = side as i64;
            let places = (0..side * side).map(|i| (x * side + i % side, y * side + i / side));
            places.map(|(x, y)| self.grid.at(x, y)).collect()
        };
        let cross = |i: usize| -> Option<Cross> {
            let [x, y] = [i % columns, i / columns].map(|v| v as i64);
            Some([block(x, y)?, block(x + 1, y)?, block(x - 1, y)?, block(x, y + 1)?, block(x, y - 1)?])
        };
        let all: Vec<Cross> = parallel::collect(columns * rows, cross).into_iter().flatten().collect();
        let step = all.len().div_ceil(most).max(1);
        all.into_iter().step_by(step).collect()
    }

    fn compare_blocks(&self, k: usize, cross: &Cross, sums: &mut Sums) {
        let measured = |pixel: &usize| f64::from(self.samples.images[k][*pixel].grey());
        let predicted =
            |pixel: &usize| self.fits[*pixel].robust.dot(self.samples.direction(k, *pixel)).max(0.0);
        let mean = |block: &Vec<usize>, of: &dyn Fn(&usize) -> f64| {
            block.iter().map(of).sum::<f64>() / block.len() as f64
        };
        let [center, right, left, below, above] = cross;
        if center.iter().any(|pixel| !self.samples.images[k][*pixel].is_usable()) {
            return;
        }
        let (seen, expected) = (mean(center, &measured), mean(center, &predicted));
        let albedo = mean(center, &|pixel: &usize| self.fits[*pixel].robust.length());
        if expected <= GRAZING * albedo || !(EXPLAINED[0]..EXPLAINED[1]).contains(&(seen / expected)) {
            return;
        }
        let slope = |a, b| 0.5 * (mean(a, &predicted) - mean(b, &predicted)) / expected;
        sums.add([slope(right, left), slope(below, above)], seen / expected - 1.0);
    }
}

impl Sums {
    /// Adds a residual and the slope of the prediction, both relative to it, in blocks.
    fn add(&mut self, [x, y]: [f64; 2], residual: f64) {
        let matrix = [x * x, x * y, y * y];
        self.matrix.iter_mut().zip(matrix).for_each(|(sum, v)| *sum += v);
        self.pull.iter_mut().zip([x, y]).for_each(|(sum, v)| *sum -= v * residual);
        self.square += residual * residual;
        self.count += 1.0;
    }

    /// Returns the shift in blocks; `None` if it is uncertain.
    fn shift(&self) -> Option<[f64; 2]> {
        let ([xx, xy, yy], [x, y]) = (self.matrix, self.pull);
        let determinant = xx * yy - xy * xy;
        if determinant <= 0.0 || self.count < FEWEST {
            return None;
        }
        let shift = [(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant];
        let explained = shift[0] * x + shift[1] * y;
        let variance = (self.square - explained).max(0.0) / (self.count - 2.0) * (xx + yy) / determinant;
        (variance < UNCERTAIN * UNCERTAIN).then_some(shift)
    }
}
