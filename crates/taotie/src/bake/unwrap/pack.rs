//! UV islands put into a square so that little of it is lost.

use super::mask::{Mask, Run};
use crate::parallel;
use std::collections::BTreeMap;

/// Masks with fewer cells are so often alike that what is known of one is kept for the next.
const SMALL: usize = 64;
/// Masks with more cells are sought a place for in their four turns at once.
const LARGE: usize = 4096;
/// The number of rows of a mask that are held against the longest free runs before cells are looked at.
const PROBES: usize = 8;

/// The place of a UV island: cells from the left and the top, after quarter turns to the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placement {
    pub quarters: u8,
    pub x: u32,
    pub y: u32,
}

/// The bin that UV islands are packed into, and what is needed around each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bin {
    /// Cells across.
    pub width: u32,
    /// Cells between UV islands.
    pub gap: u32,
    /// Cells down, at which the search is given up.
    pub most: u32,
}

/// Puts UV islands, each given in its four turns, into a bin in the order of `order`: each as far up as it can be, then
/// as far left. Gives the places and how many rows are used; `None` where a UV island is wider than the bin, or the
/// rows are more than the most.
///
/// Law: UV islands lie at least `gap` cells apart.
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

/// Cells that are taken, each UV island with its gap around it.
struct Board {
    width: u32,
    words: usize,
    /// `words` numbers a row; a row that is not there yet is free.
    taken: Vec<u64>,
    /// The longest run of free cells in each row that is there.
    free: Vec<u32>,
    /// The width of the gap to both sides in each row above and below.
    halves: Vec<u32>,
    /// Rows above which a small mask found no place.
    known: BTreeMap<Mask, u32>,
}

impl Board {
    fn new(bin: &Bin) -> Self {
        let gap = i64::from(bin.gap);
        // Cells whose nearest points are less than the gap apart.
        let is_near = |dx: i64, dy: i64| {
            let [dx, dy] = [dx, dy].map(|d: i64| (d - 1).max(0));
            dx * dx + dy * dy < gap * gap
        };
        let half = |dy: i64| (0..=gap).rev().find(|dx| is_near(*dx, dy));
        Self {
            width: bin.width,
            words: bin.width.div_ceil(64) as usize,
            taken: Vec::new(),
            free: Vec::new(),
            halves: (0..=gap).map_while(half).map(|half| half as u32).collect(),
            known: BTreeMap::new(),
        }
    }

    fn row(&self, y: u32) -> Option<&[u64]> {
        self.taken.get(y as usize * self.words..(y as usize + 1) * self.words)
    }

    /// Returns the best place of a UV island in any of its turns: the one that ends first.
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

    /// Returns the first row from `start`, and in it the first column, where a mask is free.
    fn place(&self, mask: &Mask, start: u32) -> Option<[u32; 2]> {
        if mask.width > self.width {
            return None;
        }
        let mut runs: Vec<(u32, Run)> =
            (0..).zip(&mask.rows).flat_map(|(y, row)| row.iter().map(move |run| (y, *run))).collect();
        // Long runs first: they rule out most.
        runs.sort_by_key(|(y, [from, to])| (from.wrapping_sub(*to), *y));
        let beyond = self.beyond(self.width - mask.width);
        let (mut blocked, mut scratch) = (beyond.clone(), vec![0; self.words]);
        let probes: Vec<(u32, u32)> =
            runs.iter().take(PROBES).map(|(y, [from, to])| (*y, to - from)).collect();
        for top in start.. {
            let free = |y: u32| self.free.get((top + y) as usize).copied().unwrap_or(self.width);
            if probes.iter().any(|(y, length)| free(*y) < *length) {
                continue;
            }
            blocked.copy_from_slice(&beyond);
            for (y, run) in &runs {
                let Some(row) = self.row(top + y) else { continue };
                block(row, *run, &mut blocked, &mut scratch);
                if blocked.iter().all(|word| *word == u64::MAX) {
                    break;
                }
            }
            if let Some(word) = blocked.iter().position(|word| *word != u64::MAX) {
                return Some([64 * word as u32 + blocked[word].trailing_ones(), top]);
            }
        }
        None
    }

    /// Returns a row in which the columns after `last` are blocked.
    fn beyond(&self, last: u32) -> Vec<u64> {
        let word = |i: usize| match (last + 1).saturating_sub(64 * i as u32) {
            free if free >= 64 => 0,
            free => u64::MAX << free,
        };
        (0..self.words).map(word).collect()
    }

    /// Takes the cells of a mask and those around it.
    fn stamp(&mut self, mask: &Mask, place: Placement) {
        let reach = self.halves.len().saturating_sub(1) as u32;
        let rows = (place.y + mask.height() + reach) as usize;
        if self.taken.len() < rows * self.words {
            self.taken.resize(rows * self.words, 0);
            self.free.resize(rows, self.width);
        }
        for (y, row) in (place.y..).zip(&mask.rows) {
            for near in y.saturating_sub(reach)..=y + reach {
                let Some(half) = self.halves.get(near.abs_diff(y) as usize).copied() else { continue };
                let taken = &mut self.taken[near as usize * self.words..][..self.words];
                for [from, to] in row {
                    let from = (place.x + from).saturating_sub(half);
                    set(taken, [from, (place.x + to + half).min(self.width)]);
                }
            }
        }
        for y in place.y.saturating_sub(reach) as usize..rows {
            self.free[y] = longest_free(&self.taken[y * self.words..][..self.words], self.width);
        }
    }
}

/// Returns the length of the longest run of bits that are not set, below `width`.
fn longest_free(row: &[u64], width: u32) -> u32 {
    let (mut longest, mut run, mut x) = (0, 0, 0);
    while x < width {
        let word = row[x as usize / 64] >> (x % 64);
        let left = (64 - x % 64).min(width - x);
        let taken = word.trailing_ones().min(left);
        if taken > 0 {
            (run, x) = (0, x + taken);
        } else {
            let free = word.trailing_zeros().min(left);
            (run, x) = (run + free, x + free);
            longest = longest.max(run);
        }
    }
    longest
}

/// Sets the bits from the first to before the last.
fn set(row: &mut [u64], [from, to]: Run) {
    for (i, word) in row.iter_mut().enumerate().take(to.div_ceil(64) as usize).skip(from as usize / 64) {
        let first = 64 * i as u32;
        let low = u64::MAX << from.saturating_sub(first);
        let high = if to - first >= 64 { u64::MAX } else { !(u64::MAX << (to - first)) };
        *word |= low & high;
    }
}

/// Blocks the columns at which a mask's run would meet a taken cell: those with one at column + `from` to before
/// column + `to`.
fn block(row: &[u64], [from, to]: Run, blocked: &mut [u64], scratch: &mut [u64]) {
    shift(row, from, scratch);
    let length = to - from;
    let mut covered = 1;
    while covered < length {
        let step = covered.min(length - covered);
        dilate(scratch, step);
        covered += step;
    }
    blocked.iter_mut().zip(scratch).for_each(|(blocked, more)| *blocked |= *more);
}

/// Moves a row by `by` columns to the left.
fn shift(row: &[u64], by: u32, into: &mut [u64]) {
    let (words, bits) = (by as usize / 64, by % 64);
    let word = |i: usize| row.get(i).copied().unwrap_or(0);
    for (i, out) in into.iter_mut().enumerate() {
        let low = word(i + words) >> bits;
        *out = if bits == 0 { low } else { low | word(i + words + 1) << (64 - bits) };
    }
}

/// Sets what is `by` columns to the left of what is set too.
fn dilate(row: &mut [u64], by: u32) {
    let (words, bits) = (by as usize / 64, by % 64);
    for i in 0..row.len() {
        let word = |k: usize| row.get(k).copied().unwrap_or(0);
        let low = word(i + words) >> bits;
        let moved = if bits == 0 { low } else { low | word(i + words + 1) << (64 - bits) };
        row[i] |= moved;
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

    /// Returns the cells of all UV islands, each drawn with its number.
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
    fn a_small_island_goes_into_a_hole() {
        let ring = |y: u32| if (1..9).contains(&y) { vec![[0, 1], [9, 10]] } else { vec![[0, 10]] };
        let ring = Mask { width: 10, rows: (0..10).map(ring).collect() };
        let islands = [[ring.clone(), ring.clone(), ring.clone(), ring], rectangle(4, 4)];
        let (places, used) = pack(&islands, &[0, 1], &Bin { width: 10, gap: 2, most: 100 }).unwrap();
        assert_eq!((used, places[1]), (10, Placement { quarters: 0, x: 3, y: 3 }));
    }

    #[test]
    fn the_longest_free_run_is_found() {
        let mut row = vec![0; 3];
        assert_eq!(longest_free(&row, 150), 150);
        set(&mut row, [10, 20]);
        set(&mut row, [60, 70]);
        assert_eq!(longest_free(&row, 150), 80);
        set(&mut row, [75, 150]);
        assert_eq!(longest_free(&row, 150), 40);
    }

    #[test]
    fn rows_over_many_words_are_searched_as_narrow_ones_are() {
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
