//! Numbers on the cells of a rectangle, row by row, with a border of one cell on all sides, so that each cell has four
//! neighbours and loops over a row become vector instructions. The border stays zero.

use crate::grid::Grid;
use taotie_engine::parallel;

/// Rows up to which waking other threads takes longer than the work.
const FEW: usize = 128;

/// The size of a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cells {
    /// Columns, without the border.
    pub width: usize,
    /// Rows, without the border.
    pub height: usize,
}

/// A row of numbers with the rows around it: `here[0]` is the border on the left.
#[derive(Clone, Copy)]
pub struct Row<'a, T> {
    /// The row itself.
    pub here: &'a [T],
    /// The row above.
    pub above: &'a [T],
    /// The row below.
    pub below: &'a [T],
}

impl Cells {
    /// Returns the smallest rectangle around the elements of a grid, and the cell of each.
    pub fn around(grid: &Grid) -> (Self, Vec<u32>) {
        let positions = || (0..grid.pixels.len()).map(|i| grid.position(i));
        let low = positions().fold([usize::MAX; 2], |low, p| [low[0].min(p[0]), low[1].min(p[1])]);
        let high = positions().fold([0; 2], |high, p| [high[0].max(p[0] + 1), high[1].max(p[1] + 1)]);
        let [width, height] = [0, 1].map(|c| high[c].saturating_sub(low[c]));
        let cells = Self { width, height };
        let place = |[x, y]: [usize; 2]| cells.at([x - low[0], y - low[1]]) as u32;
        (cells, positions().map(place).collect())
    }

    /// The distance between a cell and the one below.
    pub fn stride(self) -> usize {
        self.width + 2
    }

    /// The number of cells with the border.
    pub fn count(self) -> usize {
        self.stride() * (self.height + 2)
    }

    /// The index of a cell.
    pub fn at(self, [x, y]: [usize; 2]) -> usize {
        (y + 1) * self.stride() + x + 1
    }

    /// Returns row `y` of numbers and those around it, each with its border.
    #[inline]
    pub fn row<T>(self, all: &[T], y: usize) -> Row<'_, T> {
        let stride = self.stride();
        let row = |y: usize| &all[y * stride..(y + 1) * stride];
        Row { here: row(y + 1), above: row(y), below: row(y + 2) }
    }

    /// Returns all rows except the border above and below.
    pub fn rows<T>(self, all: &mut [T]) -> impl Iterator<Item = &mut [T]> {
        all.chunks_mut(self.stride()).skip(1).take(self.height)
    }
}

/// Calls `work` with the number of each row and the row, and returns the sum of the results, in the order of the rows.
pub fn over<R: Send>(rows: impl Iterator<Item = R>, work: impl Fn(usize, &mut R) -> f64 + Sync) -> f64 {
    let mut rows: Vec<(R, f64)> = rows.map(|row| (row, 0.0)).collect();
    match rows.len() < FEW {
        true => rows.iter_mut().enumerate().for_each(|(y, (row, sum))| *sum = work(y, row)),
        false => parallel::change(&mut rows, |y, (row, sum)| *sum = work(y, row)),
    }
    rows.iter().fold(0.0, |total, (_, sum)| total + sum)
}

/// Returns the sum of the terms of a row, added in eight lanes.
#[inline(always)]
pub fn summed(terms: impl Iterator<Item = f64>) -> f64 {
    let mut sums = [0.0; 8];
    for (i, term) in terms.enumerate() {
        sums[i % 8] += term;
    }
    sums.iter().fold(0.0, |total, sum| total + sum)
}
