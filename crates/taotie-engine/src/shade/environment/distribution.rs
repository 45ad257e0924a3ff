//! Samples directions proportionally to radiance.

use super::equirect::{Equirect, direction_at, uv_of};
use crate::math::{Vec3, scalar};
use std::f64::consts::{PI, TAU};

/// The maximum number of columns and rows of cells.
const MOST: [usize; 2] = [1024, 512];

/// The weight of a cell without light, relative to the mean: no direction is excluded.
const FLOOR: f64 = 0.02;

/// A density over the sphere that is constant in each cell of an equirectangular grid and proportional to the maximum
/// of filtered lookup within the cell.
///
/// Law: samples follow the density, which integrates to 1; radiance / density is bounded (`laws::environment`).
/// Source: Pharr, Jakob and Humphreys 2023, §12.5.2; constant in solid angle instead of in uv.
#[derive(Debug, Clone)]
pub(super) struct Distribution {
    columns: usize,
    rows: usize,
    /// The probability of everything above each row, and finally 1.
    above: Rising,
    /// The probability, within each row, of everything to the left of each column, and finally 1.
    left: Vec<Rising>,
    /// The density in each cell, sr⁻¹.
    density: Vec<f32>,
}

impl Distribution {
    /// Creates the distribution for the light of an image.
    pub(super) fn new(picture: &Equirect) -> Self {
        let columns = picture.width().min(MOST[0]);
        let rows = picture.height().min(MOST[1]);
        let mut weights = brightest(picture, columns, rows);
        let areas: Vec<f64> =
            (0..rows).map(|row| (edge(row, rows) - edge(row + 1, rows)) * TAU / columns as f64).collect();
        let total = |weights: &[f64]| -> f64 {
            let row_sums = weights.chunks_exact(columns).map(|row| row.iter().sum::<f64>());
            row_sums.zip(&areas).map(|(sum, area)| sum * area).sum()
        };
        let mean = total(&weights) / (4.0 * PI);
        let floor = if mean > 0.0 { mean * FLOOR } else { 1.0 };
        weights.iter_mut().for_each(|weight| *weight += floor);
        let total = total(&weights);
        let (mut above, mut all) = (vec![0.0], 0.0);
        let (mut left, mut density) = (Vec::with_capacity(rows), Vec::with_capacity(weights.len()));
        for (row, area) in weights.chunks_exact(columns).zip(&areas) {
            let sum: f64 = row.iter().sum();
            all += sum * area / total;
            above.push(all);
            left.push(Rising::new(shares_to_the_left(row, sum)));
            density.extend(row.iter().map(|weight| (weight / total) as f32));
        }
        above[rows] = 1.0;
        Self { columns, rows, above: Rising::new(above), left, density }
    }

    /// A direction and its density; `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        let (row, t) = self.above.find(f64::from(u[0]));
        let (column, s) = self.left[row].find(f64::from(u[1]));
        let (top, bottom) = (edge(row, self.rows), edge(row + 1, self.rows));
        let direction = direction_at((column as f64 + s) / self.columns as f64, top + (bottom - top) * t);
        (direction, self.density[row * self.columns + column])
    }

    /// The density of a direction, sr⁻¹.
    pub(super) fn pdf(&self, direction: Vec3) -> f32 {
        let [u, v] = uv_of(direction);
        let cell = |at: f32, count: usize| ((at * count as f32) as usize).min(count - 1);
        self.density[cell(v, self.rows) * self.columns + cell(u, self.columns)]
    }
}

/// The height y at the start of a row.
fn edge(row: usize, rows: usize) -> f64 {
    scalar::cos(PI * row as f64 / rows as f64)
}

/// The fraction of a row's sum to the left of each of its cells, and finally 1.
fn shares_to_the_left(row: &[f64], sum: f64) -> Vec<f64> {
    let (mut shares, mut all) = (vec![0.0], 0.0);
    for weight in &row[..row.len() - 1] {
        all += weight;
        shares.push(all / sum);
    }
    shares.push(1.0);
    shares
}

/// An increasing sequence from 0 to 1, with an index for finding its steps quickly.
#[derive(Debug, Clone)]
struct Rising {
    values: Vec<f64>,
    /// For each of N equal parts of [0, 1], the step in which it begins; N is a power of two, so that the part of a
    /// number is exact.
    marks: Vec<u16>,
}

impl Rising {
    /// Accepts at most 2^16 values.
    fn new(values: Vec<f64>) -> Self {
        let parts = (values.len() - 1).next_power_of_two();
        let step = |part: usize| {
            let from = part as f64 / parts as f64;
            values.partition_point(|value| *value <= from).clamp(1, values.len() - 1) as u16 - 1
        };
        let marks = (0..parts).map(step).collect();
        Self { values, marks }
    }

    /// The step that contains `u` in [0, 1), and the fraction within it.
    fn find(&self, u: f64) -> (usize, f64) {
        let part = (u * self.marks.len() as f64) as usize;
        let mut step = usize::from(self.marks[part.min(self.marks.len() - 1)]);
        let passed = |step: usize| self.values[step + 1] <= u && step + 2 < self.values.len();
        // Most steps are one of the first three. Counting needs no branch whose outcome waits for memory.
        for _ in 0..2 {
            step += usize::from(passed(step));
        }
        while passed(step) {
            step += 1;
        }
        let (from, to) = (self.values[step], self.values[step + 1]);
        (step, ((u - from) / (to - from)).clamp(0.0, 1.0))
    }
}

/// The mean of the channels at the maximum of filtered lookup, for each cell, row by row.
fn brightest(picture: &Equirect, columns: usize, rows: usize) -> Vec<f64> {
    let (width, height) = (picture.width(), picture.height());
    let mut across = Vec::with_capacity(height * columns);
    for y in 0..height {
        let means: Vec<f64> = (0..width).map(|x| mean(picture.texel(x, y))).collect();
        let texel = |x: isize| means[x.rem_euclid(width as isize) as usize];
        across.extend((0..columns).map(|column| most(column, columns, width, texel)));
    }
    let inside = |y: isize| y.clamp(0, height as isize - 1) as usize * columns;
    let cell = |row, column| most(row, rows, height, |y| across[inside(y) + column]);
    (0..rows * columns).map(|i| cell(i / columns, i % columns)).collect()
}

/// The maximum of interpolation between texels in the cell `index` of `count` over `size` texels: at a texel, or at
/// the cell's edges.
fn most(index: usize, count: usize, size: usize, texel: impl Fn(isize) -> f64) -> f64 {
    let [first, end] = [(index * size / count) as isize, ((index + 1) * size).div_ceil(count) as isize];
    let edge = |x: isize| (texel(x - 1) + texel(x)) / 2.0;
    (first..end).map(&texel).fold(edge(first).max(edge(end)), f64::max)
}

fn mean(color: Vec3) -> f64 {
    (f64::from(color.x) + f64::from(color.y) + f64::from(color.z)) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_lead_to_the_steps_that_searching_finds() {
        for count in [1usize, 2, 5, 64, 1000] {
            // Steps of very different heights, some of them zero.
            let weights: Vec<f64> = (0..count).map(|i| [0.0, 1e-9, 1.0, 300.0][i * 7 % 4] + 1e-12).collect();
            let values = shares_to_the_left(&weights, weights.iter().sum());
            let rising = Rising::new(values.clone());
            let near = values.iter().flat_map(|value| [value - 1e-12, *value, value + 1e-12]);
            for u in (0..999).map(|i| f64::from(i) / 999.0).chain(near).filter(|u| (0.0..1.0).contains(u)) {
                let expected = values.partition_point(|value| *value <= u).clamp(1, count) - 1;
                assert_eq!(rising.find(u).0, expected, "{u} of {count}");
            }
        }
    }
}
