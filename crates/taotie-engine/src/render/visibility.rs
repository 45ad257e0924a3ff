//! The surfaces visible at a sample of a tile's pixels: triangles projected and sorted into tiles, and visible pixels
//! sorted by triangle, since values that the fragments of a triangle share are computed once, and divided into
//! batches.

use super::batch::BATCH;
use super::camera::View;
use super::draw::Draw;
use crate::error::Result;
use crate::math::{Mat4, SimdLevel, Vec3, dispatch_registers};
use crate::parallel;
use crate::raster::{Bins, Faces, Geometry, NO_TRIANGLE, TILE_PIXELS, TILE_SIZE, TilePlane, Viewport};
use fearless_simd::{Level, Simd, f64x4, prelude::*, u32x16};

/// Consecutive pixels in a row of a tile that show the same triangle at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleSpan {
    /// The first pixel, `y · TILE_SIZE + x` in the tile.
    pub start: u32,
    /// One more than the last pixel.
    pub end: u32,
    /// The triangle's index over all draws.
    pub triangle: u32,
    /// Reversed depth of layers that may be transparent; 0, the farthest, for opaque ones.
    pub depth: f32,
}

impl VisibleSpan {
    /// The number of pixels.
    pub fn len(&self) -> usize {
        (self.end - self.start) as usize
    }

    /// Returns true if it contains no pixel.
    pub fn is_empty(&self) -> bool {
        self.start == self.end
    }
}

/// At most `BATCH` consecutive entries in a list of visible pixels.
#[derive(Debug, Clone, Copy)]
pub struct VisibleBatch<'s> {
    spans: &'s [VisibleSpan],
    /// The pixels of the first span that belong to the previous batch.
    skipped: u32,
    len: usize,
}

/// Divides spans into batches, all full except the last.
pub fn batches(spans: &[VisibleSpan]) -> impl Iterator<Item = VisibleBatch<'_>> {
    let (mut rest, mut taken) = (spans, 0);
    std::iter::from_fn(move || {
        rest.first()?;
        let (spans, skipped, mut room) = (rest, taken, BATCH as u32);
        while let [span, more @ ..] = rest {
            let left = span.end - span.start - taken;
            if left > room {
                (taken, room) = (taken + room, 0);
                break;
            }
            (rest, taken, room) = (more, 0, room - left);
        }
        let count = spans.len() - rest.len() + usize::from(taken > 0);
        Some(VisibleBatch { spans: &spans[..count], skipped, len: BATCH - room as usize })
    })
}

impl VisibleBatch<'_> {
    /// The number of pixels.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true if it contains no pixel.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The spans, without the parts that belong to other batches.
    pub fn spans(&self) -> impl Iterator<Item = VisibleSpan> {
        let (mut skipped, mut left) = (self.skipped, self.len as u32);
        self.spans.iter().map(move |span| {
            let start = span.start + skipped;
            let end = span.end.min(start + left);
            (skipped, left) = (0, left - (end - start));
            VisibleSpan { start, end, ..*span }
        })
    }

    /// Each pixel with its span.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, VisibleSpan)> {
        self.spans().flat_map(|span| (span.start..span.end).map(move |pixel| (pixel, span)))
    }
}

/// Vertices per task.
const BLOCK: usize = 4096;

/// The triangles of an image. Its memory can be reused for the next one.
#[derive(Debug, Default)]
pub(super) struct Projected {
    /// Each draw's vertices in clip space.
    pub clip: Vec<Vec<[f32; 4]>>,
    /// The opaque triangles, which hide everything behind them.
    pub opaque: Bins,
    /// The triangles that may have holes.
    pub layered: Bins,
}

impl Projected {
    /// Projects, clips and bins all draws.
    ///
    /// # Errors
    /// If the SIMD level is not available on this machine.
    pub fn rebuild(
        &mut self,
        draws: &[Draw<'_>],
        view: &View,
        viewport: &Viewport,
        simd: SimdLevel,
    ) -> Result<()> {
        let level = simd.dispatch()?;
        self.clip.resize_with(draws.len(), Vec::new);
        for (draw, clip) in draws.iter().zip(&mut self.clip) {
            project(draw.positions, &view.clip_from_world, level, clip);
        }
        self.opaque.rebuild(&geometry(draws, &self.clip, false), viewport, simd)?;
        self.layered.rebuild(&geometry(draws, &self.clip, true), viewport, simd)
    }
}

/// Replaces `clip` by the images of `positions`, rounded once from double precision.
fn project(positions: &[Vec3], clip_from_world: &Mat4, level: Level, clip: &mut Vec<[f32; 4]>) {
    clip.resize(positions.len(), [0.0; 4]);
    parallel::pieces(clip, BLOCK, &|i, clip| {
        let positions = &positions[i * BLOCK..][..clip.len()];
        dispatch_registers!(level, simd => project_block(simd, clip_from_world, positions, clip));
    });
}

/// The four coordinates of a vertex side by side, two vertices at a time.
#[inline(always)]
fn project_block<S: Simd>(simd: S, m: &Mat4, positions: &[Vec3], clip: &mut [[f32; 4]]) {
    let (pairs, last) = positions.as_chunks::<2>();
    for (pair, clip) in pairs.iter().zip(clip.chunks_exact_mut(2)) {
        let (first, second) = (transform(simd, m, pair[0]), transform(simd, m, pair[1]));
        first.narrow(second).store_slice(clip.as_flattened_mut());
    }
    if let ([position], Some(clip)) = (last, clip.last_mut()) {
        let image = transform(simd, m, *position);
        let both: fearless_simd::f32x8<S> = image.narrow(image);
        clip.copy_from_slice(&both.as_slice()[..4]);
    }
}

/// [`Mat4::transform_homogeneous`], bit for bit.
#[inline(always)]
fn transform<S: Simd>(simd: S, m: &Mat4, p: Vec3) -> f64x4<S> {
    let [a, b, c, d] = &m.columns;
    let (a, b) = (f64x4::from_slice(simd, a), f64x4::from_slice(simd, b));
    let (c, d) = (f64x4::from_slice(simd, c), f64x4::from_slice(simd, d));
    a * f64::from(p.x) + b * f64::from(p.y) + c * f64::from(p.z) + d
}

fn geometry<'g>(draws: &'g [Draw<'_>], clip: &'g [Vec<[f32; 4]>], layered: bool) -> Vec<Geometry<'g>> {
    let pairs = draws.iter().zip(clip);
    pairs
        .filter(|(draw, _)| draw.layered() == layered)
        .map(|(draw, clip)| Geometry {
            clip,
            triangles: draw.mesh.triangles(),
            faces: match (draw.material.double_sided, draw.mirrored) {
                (true, _) => Faces::Both,
                (false, false) => Faces::CounterClockwise,
                (false, true) => Faces::Clockwise,
            },
            first_id: draw.first_triangle,
        })
        .collect()
}

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

    #[test]
    fn batches_have_every_pixel_once_and_all_but_the_last_are_full() {
        let lengths = [31, 225, 3, 256, 300, 1, 1, 700, 5];
        let mut spans = Vec::new();
        for (triangle, length) in lengths.into_iter().enumerate() {
            let start = spans.last().map_or(7, |last: &VisibleSpan| last.end + 2);
            spans.push(VisibleSpan { start, end: start + length, triangle: triangle as u32, depth: 0.0 });
        }
        for spans in [&spans[..], &spans[..2], &spans[3..4], &[]] {
            let expected: Vec<(u32, u32)> = spans
                .iter()
                .flat_map(|span| (span.start..span.end).map(|pixel| (pixel, span.triangle)))
                .collect();
            let all: Vec<VisibleBatch<'_>> = batches(spans).collect();
            let found: Vec<(u32, u32)> = all
                .iter()
                .flat_map(|batch| batch.pixels().map(|(pixel, span)| (pixel, span.triangle)))
                .collect();
            assert_eq!(found, expected);
            assert!(all.iter().all(|batch| batch.len() == batch.pixels().count() && !batch.is_empty()));
            assert!(all.iter().rev().skip(1).all(|batch| batch.len() == BATCH));
        }
    }

    #[test]
    fn packs_project_as_single_vertices_do() {
        let m = Mat4::rotation_about(Vec3::new(0.0, 0.6, 0.8), 0.7)
            * Mat4::translation(Vec3::new(0.3, -2.0, 1e-3));
        let positions: Vec<Vec3> =
            (0..7).map(|i| Vec3::new(0.1 * i as f32, 3.7 - 0.9 * i as f32, 1e3 / (i as f32 - 2.5))).collect();
        let expected: Vec<[f32; 4]> =
            positions.iter().map(|p| m.transform_homogeneous(p.to_f64()).map(|v| v as f32)).collect();
        for simd in SimdLevel::available() {
            let mut clip = Vec::new();
            project(&positions, &m, simd.dispatch().unwrap(), &mut clip);
            assert_eq!(clip, expected, "{simd:?}");
        }
    }

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
