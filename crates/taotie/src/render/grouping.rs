//! The pixels of a tile, sorted by the triangle that they show: what fragments of a triangle share is made once.

use super::visible_sample::VisibleSample;
use crate::raster::{NO_TRIANGLE, TILE_PIXELS, TILE_SIZE, TilePlane};

/// Entries of the table from triangle to group; twice as many as there may be groups.
const TABLE: usize = 2 * TILE_PIXELS;

/// Says that there is no further span.
const LAST: u32 = u32::MAX;

/// Neighbours in a row that show the same triangle.
#[derive(Debug, Clone, Copy)]
struct Span {
    start: u32,
    end: u32,
    /// The group's next span.
    next: u32,
}

/// The spans of one triangle.
#[derive(Debug, Clone, Copy)]
struct Group {
    triangle: u32,
    first: u32,
    last: u32,
    /// Its place in the table.
    entry: u32,
}

/// Room for sorting.
#[derive(Debug)]
pub(super) struct Grouping {
    spans: Vec<Span>,
    groups: Vec<Group>,
    /// Indices into `groups`, from 1; 0 where there is none. Open addressing.
    table: Vec<u16>,
}

impl Default for Grouping {
    fn default() -> Self {
        Self { spans: Vec::new(), groups: Vec::new(), table: vec![0; TABLE] }
    }
}

impl Grouping {
    /// Appends the pixels of `plane` to `samples`, those of a triangle together and the triangles in the order of
    /// `rank`, at equal rank in that of their first pixels.
    pub(super) fn append(
        &mut self,
        plane: &TilePlane,
        rank: impl Fn(u32) -> usize,
        samples: &mut Vec<VisibleSample>,
    ) {
        for (y, row) in plane.ids.chunks_exact(TILE_SIZE as usize).enumerate() {
            let mut start = 0;
            while start < row.len() {
                let id = row[start];
                let length = row[start..].iter().take_while(|other| **other == id).count();
                if id != NO_TRIANGLE {
                    let first = (y * row.len() + start) as u32;
                    self.add(id, first, first + length as u32);
                }
                start += length;
            }
        }
        self.groups.sort_by_cached_key(|group| rank(group.triangle));
        for group in self.groups.drain(..) {
            self.table[group.entry as usize] = 0;
            let mut next = group.first;
            while let Some(span) = self.spans.get(next as usize) {
                samples.extend((span.start..span.end).map(|pixel| VisibleSample {
                    pixel,
                    triangle: group.triangle,
                    depth: plane.depths[pixel as usize],
                }));
                next = span.next;
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

#[cfg(test)]
mod tests {
    use super::*;

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
            plane.depths[pixel] = pixel as f32;
        }
        let (mut grouping, mut samples) = (Grouping::default(), Vec::new());
        for _ in 0..2 {
            samples.clear();
            grouping.append(&plane, |triangle| usize::from(triangle < 100), &mut samples);
            let seen = plane.ids.iter().filter(|id| **id != NO_TRIANGLE).count();
            assert_eq!(samples.len(), seen);
            for sample in &samples {
                assert_eq!(
                    (plane.ids[sample.pixel as usize], sample.depth),
                    (sample.triangle, sample.pixel as f32)
                );
            }
            let mut groups: Vec<u32> = samples.iter().map(|sample| sample.triangle).collect();
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
