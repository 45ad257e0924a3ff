//! Directions chosen at random, with more likelihood where more light comes from.

use super::equirect::{Equirect, direction_at, uv_of};
use crate::math::{Vec3, scalar};
use crate::parallel;
use std::f64::consts::{PI, TAU};
use std::hint::select_unpredictable;

/// The most columns and rows of cells.
const MOST: [usize; 2] = [1024, 512];

/// The weight of a cell without light, as part of the mean: no direction is left out.
const FLOOR: f64 = 0.02;

/// A density over the sphere that is constant in each cell of an equirectangular grid, and there as high as the
/// brightest that filtered lookup within the cell finds.
///
/// Law: samples fall as the density says, which integrates to 1; radiance / density is bounded
/// (`laws::environment`).
#[derive(Debug, Clone)]
pub(super) struct Distribution {
    columns: usize,
    /// The height y at which each row begins, and −1.
    heights: Vec<f64>,
    probabilities: Quadrants,
    /// The density in each cell, sr⁻¹.
    density: Vec<f32>,
}

impl Distribution {
    /// Makes the distribution for the light of an image.
    pub(super) fn new(picture: &Equirect) -> Self {
        let columns = picture.width().min(MOST[0]);
        let rows = picture.height().min(MOST[1]);
        let mut weights = brightest(picture, columns, rows);
        let heights: Vec<f64> = (0..=rows).map(|row| scalar::cos(PI * row as f64 / rows as f64)).collect();
        let areas: Vec<f64> = heights.windows(2).map(|y| (y[0] - y[1]) * TAU / columns as f64).collect();
        let total = |weights: &[f64]| -> f64 {
            let row_sums = weights.chunks_exact(columns).map(|row| row.iter().sum::<f64>());
            row_sums.zip(&areas).map(|(sum, area)| sum * area).sum()
        };
        let mean = total(&weights) / (4.0 * PI);
        let floor = if mean > 0.0 { mean * FLOOR } else { 1.0 };
        weights.iter_mut().for_each(|weight| *weight += floor);
        let cells = weights.chunks_exact(columns).zip(&areas);
        let cells = cells.flat_map(|(row, area)| row.iter().map(move |weight| weight * area)).collect();
        let probabilities = Quadrants::new([columns, rows], cells);
        let density = |i: usize| {
            let [column, row] = [i % columns, i / columns];
            (probabilities.probability([column, row]) / areas[row]) as f32
        };
        let density = parallel::collect(columns * rows, density);
        Self { columns, heights, probabilities, density }
    }

    /// A direction and its density; `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        let ([column, row], [s, t]) = self.probabilities.find([u[1], u[0]]);
        let (top, bottom) = (self.heights[row], self.heights[row + 1]);
        let direction = direction_at((column as f64 + s) / self.columns as f64, top + (bottom - top) * t);
        (direction, self.density[row * self.columns + column])
    }

    /// The density of a direction, sr⁻¹.
    pub(super) fn pdf(&self, direction: Vec3) -> f32 {
        let [u, v] = uv_of(direction);
        let cell = |at: f32, count: usize| ((at * count as f32) as usize).min(count - 1);
        self.density[cell(v, self.heights.len() - 1) * self.columns + cell(u, self.columns)]
    }
}

/// Probabilities of the cells of a grid, which is halved again and again: numbers that lie near each other lead to cells
/// near each other, so that what is evenly spread stays so.
///
/// Source: Clarberg, Jarosz, Akenine-Möller and Jensen 2005, "Wavelet importance sampling: efficiently evaluating products
/// of complex functions", §4.
#[derive(Debug, Clone)]
struct Quadrants {
    /// The first divides the whole; each divides the quarters of those of the level before.
    levels: Vec<Level>,
}

/// Parts of a grid of one size.
#[derive(Debug, Clone)]
struct Level {
    across: usize,
    /// Row by row.
    parts: Vec<Part>,
}

/// The probabilities within a part of the grid, in units of 2⁻³².
#[derive(Debug, Clone, Copy)]
struct Part {
    /// That of its lower half.
    lower: u32,
    /// That of the right within the upper half, and within the lower one.
    right: [u32; 2],
}

/// An interval of numbers that lead to the same place, in units of 2⁻⁶³: integers are chosen between without branches,
/// which no processor would foresee.
#[derive(Debug, Clone, Copy)]
struct Interval {
    from: u64,
    length: u64,
}

impl Quadrants {
    fn new(mut size: [usize; 2], cells: Vec<f64>) -> Self {
        let (mut levels, mut sums) = (Vec::new(), cells);
        loop {
            let quarters = quarters(size, &sums);
            size = size.map(|count| count.div_ceil(2));
            levels.push(Level { across: size[0], parts: quarters.iter().map(Part::of).collect() });
            sums = quarters.iter().map(|quarters| quarters.iter().sum()).collect();
            if sums.len() == 1 {
                break;
            }
        }
        levels.reverse();
        Self { levels }
    }

    /// Returns the probability with which a cell is found.
    fn probability(&self, [column, row]: [usize; 2]) -> f64 {
        let [mut across, mut down] = [Interval::ALL; 2];
        for (level, shift) in self.levels.iter().zip((0..self.levels.len()).rev()) {
            let [x, y] = [column, row].map(|at| at >> shift);
            let part = &level.parts[y / 2 * level.across + x / 2];
            down = down.half(part.lower, y % 2 == 1);
            across = across.half(part.right[y % 2], x % 2 == 1);
        }
        across.size() * down.size()
    }

    /// The column and the row of a cell, and the place in it, [0, 1]². `u` across and down, in [0, 1)².
    fn find(&self, u: [f32; 2]) -> ([usize; 2], [f64; 2]) {
        let all = Interval::ALL.length;
        let u = u.map(|u| ((f64::from(u) * all as f64) as u64).min(all - 1));
        let [mut column, mut row] = [0, 0];
        let [mut across, mut down] = [Interval::ALL; 2];
        for level in &self.levels {
            let part = &level.parts[row * level.across + column];
            let lower = u[1] >= down.middle(part.lower);
            down = down.half(part.lower, lower);
            let share = select_unpredictable(lower, part.right[1], part.right[0]);
            let right = u[0] >= across.middle(share);
            across = across.half(share, right);
            (column, row) = (2 * column + usize::from(right), 2 * row + usize::from(lower));
        }
        ([column, row], [across.place(u[0]), down.place(u[1])])
    }
}

/// Returns the cells two by two: upper left, upper right, lower left, lower right; those beyond the grid are 0.
fn quarters([columns, rows]: [usize; 2], cells: &[f64]) -> Vec<[f64; 4]> {
    let inside = |x, y| if x < columns && y < rows { cells[y * columns + x] } else { 0.0 };
    let across = columns.div_ceil(2);
    let of = |i: usize| {
        let (x, y) = (2 * (i % across), 2 * (i / across));
        [inside(x, y), inside(x + 1, y), inside(x, y + 1), inside(x + 1, y + 1)]
    };
    (0..across * rows.div_ceil(2)).map(of).collect()
}

impl Part {
    fn of([a, b, c, d]: &[f64; 4]) -> Self {
        let share = |first: f64, second: f64| match second > 0.0 {
            true => ((second / (first + second) * 2f64.powi(32)) as u32).max(1),
            false => 0,
        };
        Self { lower: share(a + b, c + d), right: [share(*a, *b), share(*c, *d)] }
    }
}

impl Interval {
    const ALL: Self = Self { from: 0, length: 1 << 63 };

    /// The number at which the second part begins, which has so much of the whole.
    fn middle(self, share: u32) -> u64 {
        self.from + self.half(share, false).length
    }

    fn half(self, share: u32, is_second: bool) -> Self {
        let second = (u128::from(self.length) * u128::from(share) >> 32) as u64;
        let first = self.length - second;
        Self {
            from: self.from + select_unpredictable(is_second, first, 0),
            length: select_unpredictable(is_second, second, first),
        }
    }

    /// Its length in units of 1.
    fn size(self) -> f64 {
        self.length as f64 / Self::ALL.length as f64
    }

    fn place(self, u: u64) -> f64 {
        ((u - self.from) as f64 / self.length as f64).clamp(0.0, 1.0)
    }
}

/// The mean of the channels where filtered lookup finds most, for each cell, row by row.
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

/// The most that interpolating between texels finds in the cell `index` of `count` over `size` texels: at a texel, or
/// at the cell's edges.
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

    /// Each cell takes the part of [0, 1)² that its probability is, and numbers spread over it are spread over the cell.
    #[test]
    fn cells_are_found_as_often_as_they_are_likely() {
        for size in [[1, 1], [1, 3], [2, 2], [5, 3], [8, 4]] {
            let [columns, rows] = size;
            let weights: Vec<f64> =
                (0..columns * rows).map(|i| [1.0, 0.0, 3.0, 0.5][(i * 7 + 2) % 4]).collect();
            let total: f64 = weights.iter().sum();
            let quadrants = Quadrants::new(size, weights.clone());
            const FINE: usize = 600;
            let mut found = vec![(0usize, [0.0; 2]); weights.len()];
            for i in 0..FINE * FINE {
                let u = [i % FINE, i / FINE].map(|v| (v as f32 + 0.5) / FINE as f32);
                let ([column, row], within) = quadrants.find(u);
                let (count, sums) = &mut found[row * columns + column];
                *count += 1;
                (0..2).for_each(|k| sums[k] += within[k]);
            }
            for (i, (count, sums)) in found.into_iter().enumerate() {
                let share = count as f64 / (FINE * FINE) as f64;
                assert!((share - weights[i] / total).abs() < 4e-3, "{i} of {size:?}: {share}");
                assert!(count == 0 || sums.iter().all(|sum| (sum / count as f64 - 0.5).abs() < 0.02));
            }
            let ([column, row], _) = quadrants.find([1.0 - f32::EPSILON / 2.0; 2]);
            assert!(weights[row * columns + column] > 0.0);
        }
    }
}
