//! Packs UV islands into a square, wasting as little of it as possible.

use super::island::{Mask, Run};
use crate::parallel;
use std::collections::BTreeMap;

/// Masks with fewer cells are so often alike that the findings for one are reused for the next.
const SMALL: usize = 64;
/// Masks with more cells are tried in their four rotations in parallel.
const LARGE: usize = 4096;
/// The number of rows of a mask compared with the longest free runs before cells are examined.
const PROBES: usize = 8;

/// The position of a UV island: cells from the left and the top, after clockwise quarter turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placement {
    pub quarters: u8,
    pub x: u32,
    pub y: u32,
}

/// The bin into which UV islands are packed, and the gap needed around each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bin {
    /// Cells across.
    pub width: u32,
    /// Cells between UV islands.
    pub gap: u32,
    /// The number of cells down at which the search is abandoned.
    pub most: u32,
}

impl Bin {
    /// Returns a number of UV islands above which they cannot fit into a square of the bin's width, however small.
    pub fn room(&self) -> u64 {
        // If two UV islands have cells in the same square of this side, the gap between them is too narrow.
        let side =
            1 + (0..self.gap).take_while(|apart| 2 * apart * apart < self.gap * self.gap).count() as u32;
        u64::from(self.width.div_ceil(side)).pow(2)
    }
}

/// Puts UV islands, each given in its four rotations, into a bin in the order of `order`: each as far up as possible,
/// then as far left. Returns the positions and the number of rows used; `None` if a UV island is wider than the bin,
/// or the rows exceed the maximum.
///
/// Law: UV islands are at least `gap` cells apart.
pub(super) fn pack(islands: &[[Mask; 4]], order: &[u32], bin: &Bin) -> Option<(Vec<Placement>, u32)> {
    let mut board = Board::new(bin);
    let mut places = vec![Placement { quarters: 0, x: 0, y: 0 }; islands.len()];
    let mut used = 0;
    for island in order {
        let turns = &islands[*island as usize];
        let place = board.find(turns)?;
        let mask = &turns[place.quarters as usize];
        board.stamp(mask, place);
        used = used.max(place.y + mask.height());
        if used > bin.most {
            return None;
        }
        places[*island as usize] = place;
    }
    Some((places, used))
}

/// Free cells: all but UV islands with their gap around them.
struct Board {
    width: u32,
    /// The free runs of each row, in order; missing rows are free.
    rows: Vec<Vec<Run>>,
    /// The longest free run of each existing row.
    longest: Vec<u32>,
    /// The width of the gap to both sides in each row above and below.
    halves: Vec<u32>,
    /// Rows above which a small mask found no position.
    known: BTreeMap<Mask, u32>,
}

impl Board {
    fn new(bin: &Bin) -> Self {
        let gap = i64::from(bin.gap);
        // The cell itself, and those whose nearest points are closer than the gap.
        let is_near = |dx: i64, dy: i64| {
            let [x, y] = [dx, dy].map(|d: i64| (d - 1).max(0));
            dx.max(dy) == 0 || x * x + y * y < gap * gap
        };
        let half = |dy: i64| (0..=gap).rev().find(|dx| is_near(*dx, dy));
        Self {
            width: bin.width,
            rows: Vec::new(),
            longest: Vec::new(),
            halves: (0..=gap).map_while(half).map(|half| half as u32).collect(),
            known: BTreeMap::new(),
        }
    }

    /// Returns the best position of a UV island in any of its rotations: the one that ends first.
    fn find(&mut self, turns: &[Mask; 4]) -> Option<Placement> {
        let place = |quarters: usize| {
            let mask = &turns[quarters];
            let start = if mask.cells() < SMALL { self.known.get(mask).copied().unwrap_or(0) } else { 0 };
            let [x, y] = self.place(mask, start)?;
            Some(Placement { quarters: quarters as u8, x, y })
        };
        let found: Vec<Option<Placement>> = match turns[0].cells() > LARGE {
            true => parallel::tasks(turns.len(), &place),
            false => (0..turns.len()).map(place).collect(),
        };
        for (mask, place) in turns.iter().zip(&found) {
            if let Some(place) = place.filter(|_| mask.cells() < SMALL) {
                self.known.insert(mask.clone(), place.y);
            }
        }
        let end = |place: &Placement| place.y + turns[place.quarters as usize].height();
        found.into_iter().flatten().min_by_key(|place| (end(place), place.x, place.quarters))
    }

    /// Returns the first row from `start`, and in it the first column, at which a mask is free.
    fn place(&self, mask: &Mask, start: u32) -> Option<[u32; 2]> {
        if mask.width > self.width {
            return None;
        }
        let mut runs: Vec<(u32, Run)> =
            (0..).zip(&mask.rows).flat_map(|(y, row)| row.iter().map(move |run| (y, *run))).collect();
        // Long runs first: they rule out the most.
        runs.sort_by_key(|(y, [from, to])| (from.wrapping_sub(*to), *y));
        let everywhere = [0, self.width - mask.width + 1];
        let (mut columns, mut left) = (Vec::new(), Vec::new());
        for top in start.. {
            let longest = |y: u32| self.longest.get((top + y) as usize).copied().unwrap_or(self.width);
            if runs.iter().take(PROBES).any(|(y, [from, to])| longest(*y) < to - from) {
                continue;
            }
            columns.clear();
            columns.push(everywhere);
            for (y, run) in &runs {
                let Some(free) = self.rows.get((top + y) as usize) else { continue };
                keep(&columns, free, *run, &mut left);
                std::mem::swap(&mut columns, &mut left);
                if columns.is_empty() {
                    break;
                }
            }
            if let Some([first, _]) = columns.first() {
                return Some([*first, top]);
            }
        }
        None
    }

    /// Marks the cells of a mask and those around it as taken.
    fn stamp(&mut self, mask: &Mask, place: Placement) {
        let reach = self.halves.len().saturating_sub(1) as u32;
        let rows = (place.y + mask.height() + reach) as usize;
        if self.rows.len() < rows {
            self.rows.resize(rows, vec![[0, self.width]]);
            self.longest.resize(rows, self.width);
        }
        for (y, row) in (place.y..).zip(&mask.rows) {
            for near in y.saturating_sub(reach)..=y + reach {
                let Some(half) = self.halves.get(near.abs_diff(y) as usize).copied() else { continue };
                for [from, to] in row {
                    let from = (place.x + from).saturating_sub(half);
                    take(&mut self.rows[near as usize], [from, place.x + to + half]);
                }
            }
        }
        for y in place.y.saturating_sub(reach) as usize..rows {
            self.longest[y] = self.rows[y].iter().map(|[from, to]| to - from).max().unwrap_or(0);
        }
    }
}

/// Removes the cells of a run from the free runs of a row.
fn take(free: &mut Vec<Run>, [from, to]: Run) {
    let first = free.partition_point(|run| run[1] <= from);
    let behind = first + free[first..].partition_point(|run| run[0] < to);
    if first < behind {
        let ends = [[free[first][0], from], [to, free[behind - 1][1]]];
        free.splice(first..behind, ends.into_iter().filter(|[from, to]| from < to));
    }
}

/// Keeps those columns at which a mask's run is inside one of the free runs of a row. Columns are runs too.
fn keep(columns: &[Run], free: &[Run], [from, to]: Run, kept: &mut Vec<Run>) {
    kept.clear();
    let mut i = 0;
    for [first, end] in columns {
        // Free runs that end before the cells of the first column are of no use to later ones.
        while free.get(i).is_some_and(|free| free[1] < first + to) {
            i += 1;
        }
        for free in free[i..].iter().take_while(|free| free[0] < end + from) {
            let columns =
                [free[0].saturating_sub(from).max(*first), (free[1] + 1).saturating_sub(to).min(*end)];
            if columns[0] < columns[1] {
                kept.push(columns);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(width: u32, height: u32) -> [Mask; 4] {
        let [flat, upright] = [[width, height], [height, width]]
            .map(|[w, h]| Mask { width: w, rows: vec![vec![[0, w]]; h as usize] });
        [flat.clone(), upright.clone(), flat, upright]
    }

    /// Returns the cells of all UV islands, each drawn with its letter.
    fn drawn(islands: &[[Mask; 4]], places: &[Placement], size: [u32; 2]) -> Vec<String> {
        let mut cells = vec![vec!['.'; size[0] as usize]; size[1] as usize];
        for ((turns, place), name) in islands.iter().zip(places).zip('a'..) {
            for (y, row) in turns[place.quarters as usize].rows.iter().enumerate() {
                for x in row.iter().flat_map(|[from, to]| *from..*to) {
                    let cell = &mut cells[place.y as usize + y][(place.x + x) as usize];
                    assert_eq!(*cell, '.', "UV islands overlap");
                    *cell = name;
                }
            }
        }
        cells.iter().map(|row| row.iter().collect()).collect()
    }

    #[test]
    fn rectangles_lie_side_by_side_with_their_gap() {
        let islands = [rectangle(4, 2), rectangle(2, 2), rectangle(7, 1)];
        let bin = Bin { width: 8, gap: 1, most: 100 };
        let (places, used) = pack(&islands, &[0, 1, 2], &bin).unwrap();
        assert_eq!(used, 4);
        assert_eq!(drawn(&islands, &places, [8, 4]), ["aaaa.bb.", "aaaa.bb.", "........", "ccccccc."]);
        assert!(pack(&islands, &[0, 1, 2], &Bin { most: 3, ..bin }).is_none());
        assert!(pack(&[rectangle(9, 9)], &[0], &bin).is_none());
    }

    #[test]
    fn no_more_islands_fit_than_there_is_room_for() {
        for (gap, width, room) in [(0, 8, 64), (1, 8, 16), (2, 9, 9), (3, 8, 4), (4, 8, 4)] {
            let bin = Bin { width, gap, most: 1000 };
            assert_eq!(bin.room(), room, "{bin:?}");
            let order: Vec<u32> = (0..room as u32 + 1).collect();
            let islands = vec![rectangle(1, 1); order.len()];
            let (_, rows) = pack(&islands, &order, &bin).unwrap();
            assert!(rows > width, "{bin:?}: {rows} rows");
        }
    }

    #[test]
    fn without_a_gap_islands_touch() {
        let islands = [rectangle(4, 2), rectangle(4, 2)];
        let (places, used) = pack(&islands, &[0, 1], &Bin { width: 8, gap: 0, most: 100 }).unwrap();
        assert_eq!(used, 2);
        assert_eq!(drawn(&islands, &places, [8, 2]), ["aaaabbbb", "aaaabbbb"]);
    }

    #[test]
    fn a_small_island_goes_into_a_hole() {
        let ring = |y: u32| if (1..9).contains(&y) { vec![[0, 1], [9, 10]] } else { vec![[0, 10]] };
        let ring = Mask { width: 10, rows: (0..10).map(ring).collect() };
        let islands = [[ring.clone(), ring.clone(), ring.clone(), ring], rectangle(4, 4)];
        let (places, used) = pack(&islands, &[0, 1], &Bin { width: 10, gap: 2, most: 100 }).unwrap();
        assert_eq!((used, places[1]), (10, Placement { quarters: 0, x: 3, y: 3 }));
    }

    #[test]
    fn what_is_taken_is_no_longer_free() {
        let mut row = vec![[0, 150]];
        take(&mut row, [10, 20]);
        take(&mut row, [60, 70]);
        take(&mut row, [15, 18]);
        assert_eq!(row, [[0, 10], [20, 60], [70, 150]]);
        take(&mut row, [55, 80]);
        take(&mut row, [0, 5]);
        take(&mut row, [140, 160]);
        assert_eq!(row, [[5, 10], [20, 55], [80, 140]]);
        take(&mut row, [0, 200]);
        assert!(row.is_empty());
    }

    #[test]
    fn columns_are_kept_where_a_run_is_free() {
        let free = [[0, 4], [6, 12], [13, 14], [20, 30]];
        let kept = |columns: &[Run], run: Run| {
            let mut kept = vec![[99, 99]];
            keep(columns, &free, run, &mut kept);
            let by_cell = (0..40u32).filter(|x| columns.iter().any(|[from, to]| (from..to).contains(&x)));
            let is_free = |x: u32| free.iter().any(|[from, to]| *from <= x + run[0] && x + run[1] <= *to);
            let cells: Vec<u32> = kept.iter().flat_map(|[from, to]| *from..*to).collect();
            assert_eq!(cells, by_cell.filter(|x| is_free(*x)).collect::<Vec<u32>>(), "{columns:?} {run:?}");
            kept
        };
        assert_eq!(kept(&[[0, 28]], [0, 3]), [[0, 2], [6, 10], [20, 28]]);
        assert_eq!(kept(&[[0, 28]], [2, 5]), [[4, 8], [18, 26]]);
        kept(&[[1, 2], [7, 9], [11, 22]], [1, 2]);
        kept(&[[0, 1], [3, 4], [5, 30]], [0, 1]);
        kept(&[[0, 30]], [5, 16]);
    }

    #[test]
    fn many_rectangles_keep_their_gap() {
        let islands: Vec<[Mask; 4]> = (0..40).map(|i| rectangle(20 + 3 * i % 70, 5 + i % 7)).collect();
        let order: Vec<u32> = (0..40).collect();
        let (places, used) = pack(&islands, &order, &Bin { width: 200, gap: 3, most: 1000 }).unwrap();
        drawn(&islands, &places, [200, used]);
        for (i, a) in places.iter().enumerate() {
            for (j, b) in places.iter().enumerate().skip(i + 1) {
                let side = |p: &Placement, k: usize| {
                    let mask = &islands[k][p.quarters as usize];
                    [[p.x, p.x + mask.width], [p.y, p.y + mask.height()]]
                };
                let apart = |k: usize| {
                    let (a, b) = (side(a, i)[k], side(b, j)[k]);
                    b[0].saturating_sub(a[1]).max(a[0].saturating_sub(b[1]))
                };
                assert!(apart(0).pow(2) + apart(1).pow(2) >= 9, "{a:?} {b:?}");
            }
        }
    }
}
