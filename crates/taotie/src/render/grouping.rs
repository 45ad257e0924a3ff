//! The pixels of a tile, sorted by visible triangle: values shared by the fragments of a triangle are computed once.

use super::visible::VisibleSpan;
use crate::math::dispatch_registers;
use crate::raster::{NO_TRIANGLE, TILE_PIXELS, TILE_SIZE, TilePlane};
use fearless_simd::{Level, Simd, prelude::*, u32x16};

/// Entries of the table from triangle to group; twice the maximum number of groups.
const TABLE: usize = 2 * TILE_PIXELS;

/// Marks the last span.
const LAST: u32 = u32::MAX;

/// Consecutive pixels in a row that show the same triangle.
#[derive(Debug, Clone, Copy)]
struct Span {
    start: u32,
    end: u32,
    /// The next span of the group.
    next: u32,
}

/// The spans of one triangle.
#[derive(Debug, Clone, Copy)]
struct Group {
    triangle: u32,
    first: u32,
    last: u32,
    /// Its index in the table.
    entry: u32,
}

/// Scratch memory for sorting.
#[derive(Debug)]
pub(super) struct Grouping {
    spans: Vec<Span>,
    groups: Vec<Group>,
    /// Indices into `groups`, from 1; 0 if there is none. Open addressing.
    table: Vec<u16>,
}

impl Default for Grouping {
    fn default() -> Self {
        Self { spans: Vec::new(), groups: Vec::new(), table: vec![0; TABLE] }
    }
}

impl Grouping {
    /// Appends the pixels of `plane` to `spans`, those of a triangle together and the triangles in the order of
    /// `rank`; at equal rank, in the order of their first pixels.
    pub(super) fn append(
        &mut self,
        level: Level,
        plane: &TilePlane,
        rank: impl Fn(u32) -> usize,
        spans: &mut Vec<VisibleSpan>,
    ) {
        let (rows, _) = plane.ids.as_chunks();
        for (y, row) in rows.iter().enumerate() {
            let mut ends = dispatch_registers!(level, simd => ends(simd, row));
            let mut start = 0;
            while ends != 0 {
                let end = ends.trailing_zeros() + 1;
                let id = row[start as usize];
                if id != NO_TRIANGLE {
                    let first = y as u32 * TILE_SIZE;
                    self.add(id, first + start, first + end);
                }
                ends &= ends - 1;
                start = end;
            }
        }
        let rank = |group: &Group| rank(group.triangle);
        if !self.groups.is_sorted_by_key(rank) {
            self.groups.sort_by_cached_key(rank);
        }
        for group in self.groups.drain(..) {
            self.table[group.entry as usize] = 0;
            let mut next = group.first;
            while let Some(Span { start, end, next: further }) = self.spans.get(next as usize).copied() {
                spans.push(VisibleSpan { start, end, triangle: group.triangle, depth: 0.0 });
                next = further;
            }
        }
        self.spans.clear();
    }

    fn add(&mut self, triangle: u32, start: u32, end: u32) {
        let index = self.spans.len() as u32;
        self.spans.push(Span { start, end, next: LAST });
        let mut entry = (triangle.wrapping_mul(0x9e37_79b1) >> 16) as usize % TABLE;
        loop {
            match self.table[entry] {
                0 => break,
                found if self.groups[found as usize - 1].triangle == triangle => {
                    let group = &mut self.groups[found as usize - 1];
                    self.spans[group.last as usize].next = index;
                    group.last = index;
                    return;
                }
                _ => entry = (entry + 1) % TABLE,
            }
        }
        self.groups.push(Group { triangle, first: index, last: index, entry: entry as u32 });
        self.table[entry] = self.groups.len() as u16;
    }
}

/// Bit i is set if entry i of a row is the last of equal neighbours.
#[inline(always)]
fn ends<S: Simd>(simd: S, row: &[u32; TILE_SIZE as usize]) -> u64 {
    let same = |at: usize| {
        let here: u32x16<S> = u32x16::from_slice(simd, &row[at..at + 16]);
        here.simd_eq(u32x16::from_slice(simd, &row[at + 1..at + 17])).to_bitmask() << at
    };
    // Nothing follows the last entry, so the last sixteen begin one earlier.
    let last = row.len() - 17;
    !((0..last).step_by(16).fold(0, |all, at| all | same(at)) | same(last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::SimdLevel;

    #[test]
    fn every_pixel_is_there_once_and_triangles_are_together() {
        let mut plane = TilePlane::default();
        for (pixel, id) in plane.ids.iter_mut().enumerate() {
            // Bands, single pixels, and holes.
            *id = match (pixel % 7, pixel / 300) {
                (0, _) => NO_TRIANGLE,
                (1, _) => pixel as u32 * 4096,
                (_, band) => band as u32,
            };
        }
        let (mut grouping, mut spans) = (Grouping::default(), Vec::new());
        for simd in SimdLevel::available() {
            let level = simd.dispatch().unwrap();
            spans.clear();
            grouping.append(level, &plane, |triangle| usize::from(triangle < 100), &mut spans);
            let seen = plane.ids.iter().filter(|id| **id != NO_TRIANGLE).count();
            assert_eq!(spans.iter().map(VisibleSpan::len).sum::<usize>(), seen);
            for span in &spans {
                let shown = &plane.ids[span.start as usize..span.end as usize];
                assert!(shown.iter().all(|id| *id == span.triangle), "{span:?}: {shown:?}");
            }
            let mut groups: Vec<u32> = spans.iter().map(|span| span.triangle).collect();
            groups.dedup();
            let ranks: Vec<bool> = groups.iter().map(|triangle| *triangle < 100).collect();
            assert!(ranks.is_sorted());
            let count = groups.len();
            groups.sort_unstable();
            groups.dedup();
            assert_eq!(groups.len(), count, "a triangle was split");
        }
    }
}
