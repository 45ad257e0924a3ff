//! The silhouette of a UV island in cells: every cell that it touches.

use super::flatten::bounds;

/// Columns from the first, inclusive, to the last, exclusive.
pub(super) type Run = [u32; 2];

/// A silhouette, row by row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Mask {
    pub width: u32,
    pub rows: Vec<Vec<Run>>,
}

/// Returns a point after clockwise quarter turns.
pub(super) fn turned([x, y]: [f64; 2], quarters: u8) -> [f64; 2] {
    match quarters % 4 {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

/// Returns the minimum coordinates of triangles after quarter turns: the position of a mask's corner.
pub(super) fn corner(laid: &[[[f64; 2]; 3]], quarters: u8) -> [f64; 2] {
    bounds(laid.iter().flatten().map(|p| turned(*p, quarters)))[0]
}

impl Mask {
    /// Draws triangles, rotated and with `scale` cells per unit. Gaps in a row no wider than `gap` are filled.
    pub fn new(laid: &[[[f64; 2]; 3]], quarters: u8, scale: f64, gap: u32) -> Self {
        let [low, high] = bounds(laid.iter().flatten().map(|p| turned(*p, quarters)));
        let cells = |k: usize| ((high[k] - low[k]) * scale).max(0.0) as usize + 1;
        let (width, height) = (cells(0), cells(1));
        let mut rows = vec![Vec::new(); height];
        for triangle in laid {
            let place = |p: [f64; 2]| {
                let [x, y] = turned(p, quarters);
                [(x - low[0]) * scale, (y - low[1]) * scale]
            };
            touch(triangle.map(place), &mut rows);
        }
        rows.iter_mut().for_each(|row| join(row, gap));
        Self { width: width as u32, rows }
    }

    pub fn height(&self) -> u32 {
        self.rows.len() as u32
    }

    /// Returns the number of cells.
    pub fn cells(&self) -> usize {
        self.rows.iter().flatten().map(|[from, to]| (to - from) as usize).sum()
    }
}

/// Adds the cells that a triangle touches.
fn touch(corners: [[f64; 2]; 3], rows: &mut [Vec<Run>]) {
    let [[_, top], [_, bottom]] = bounds(corners.into_iter());
    let [first, last] = [top, bottom].map(|y| (y.max(0.0) as usize).min(rows.len() - 1));
    for (y, row) in rows.iter_mut().enumerate().take(last + 1).skip(first) {
        let [left, right] = extent(corners, y as f64);
        if left <= right {
            row.push([left.max(0.0) as u32, right.max(0.0) as u32 + 1]);
        }
    }
}

/// Returns the minimum and maximum x of a triangle between y and y + 1.
fn extent(corners: [[f64; 2]; 3], y: f64) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |x: f64| range = [range[0].min(x), range[1].max(x)];
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        if p[1] >= y && p[1] <= y + 1.0 {
            add(p[0]);
        }
        for line in [y, y + 1.0] {
            if (p[1] < line) != (q[1] < line) {
                add(p[0] + (q[0] - p[0]) * (line - p[1]) / (q[1] - p[1]));
            }
        }
    }
    range
}

/// Sorts runs and joins those that touch, overlap or have a gap of at most `gap`.
fn join(row: &mut Vec<Run>, gap: u32) {
    row.sort_unstable();
    row.dedup_by(|next, run| {
        let joined = next[0] <= run[1] + gap;
        if joined {
            run[1] = run[1].max(next[1]);
        }
        joined
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_touched_cell_is_in_the_mask() {
        let triangle = [[[0.0, 0.0], [4.0, 0.0], [0.0, 2.0]]];
        let mask = Mask::new(&triangle, 0, 1.0, 0);
        assert_eq!(
            (mask.width, mask.rows.as_slice()),
            (5, [vec![[0, 5]], vec![[0, 3]], vec![[0, 1]]].as_slice())
        );
        let upright = Mask::new(&triangle, 1, 1.0, 0);
        assert_eq!((upright.width, upright.height()), (3, 5));
        assert_eq!(corner(&triangle, 1), [-2.0, 0.0]);
    }

    #[test]
    fn small_gaps_are_filled() {
        let mut row = vec![[5, 6], [0, 2], [1, 3], [9, 10]];
        join(&mut row, 2);
        assert_eq!(row, [[0, 6], [9, 10]]);
    }
}
