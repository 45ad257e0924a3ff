//! Visits the triangles of a tile, by their size.

use super::few::{FEW, Few};
use super::setup::ScreenTriangle;
use super::sink::Sink;
use super::small::{BLOCK, Corners, PACK, Samples, Setups};
use super::triangle::{TileTriangle, scan_packs};
use super::{Bins, TileSample};
use fearless_simd::{Simd, i32x8, mask32x8, prelude::*};

/// Passes the coverage of the triangles of `bins` to `sink`, in drawing order.
#[inline(always)]
pub(super) fn scan<S: Simd, K: Sink>(simd: S, bins: &Bins, at: TileSample<'_>, sink: &mut K) {
    let samples = Samples::new(at.tile, at.offset);
    let mut scan = Scan { simd, at, samples, corners: Corners::new(), few: Few::new() };
    for (triangles, members) in bins.tile(at.tile.index) {
        for members in members.chunks(BLOCK) {
            scan.block(Members { triangles, members }, sink);
        }
    }
}

/// Some of a chunk's triangles, by index.
#[derive(Clone, Copy)]
struct Members<'t> {
    triangles: &'t [ScreenTriangle],
    members: &'t [u32],
}

struct Scan<'a, S> {
    simd: S,
    at: TileSample<'a>,
    samples: Samples,
    corners: Corners,
    few: Few,
}

impl<S: Simd> Scan<'_, S> {
    /// Scans at most [`BLOCK`] triangles.
    #[inline(always)]
    fn block<K: Sink>(&mut self, block: Members<'_>, sink: &mut K) {
        let Members { triangles, members } = block;
        for (i, member) in members.iter().enumerate() {
            self.corners.set(i, &triangles[*member as usize]);
        }
        for (i, members) in members.chunks(PACK).enumerate() {
            let (setups, small) = Setups::new(self.simd, &self.corners, i * PACK, &self.samples);
            self.pack(&setups, small, Members { triangles, members }, sink);
        }
    }

    /// Scans at most [`PACK`] triangles.
    #[inline(always)]
    fn pack<K: Sink>(
        &mut self,
        setups: &Setups<S>,
        small: mask32x8<S>,
        Members { triangles, members }: Members<'_>,
        sink: &mut K,
    ) {
        let all = (1 << members.len()) - 1;
        let few = small & few_samples(self.simd, setups);
        self.few.fill(self.simd, setups, few);
        let (few, small) = (few.to_bitmask(), small.to_bitmask());
        if few & all == all {
            for (i, member) in members.iter().enumerate() {
                self.few.visit(i, triangles[*member as usize].id, sink);
            }
            return;
        }
        let columns = Columns::new(setups);
        for (i, member) in members.iter().enumerate() {
            let triangle = &triangles[*member as usize];
            if few >> i & 1 == 1 {
                self.few.visit(i, triangle.id, sink);
                continue;
            }
            let setup = match small >> i & 1 == 1 {
                true => columns.triangle(i, triangle.id),
                false => TileTriangle::new(triangle, self.at.tile, self.at.offset),
            };
            if let Some(setup) = setup {
                scan_packs(self.simd, &setup, sink);
            }
        }
    }
}

/// The triangles with at most [`FEW`] columns and rows of samples around them.
#[inline(always)]
fn few_samples<S: Simd>(simd: S, setups: &Setups<S>) -> mask32x8<S> {
    let [left, top, right, bottom] = setups.bounds;
    let few = i32x8::splat(simd, FEW as i32);
    (right - left).simd_lt(few) & (bottom - top).simd_lt(few)
}

/// Set-ups of eight triangles in memory.
struct Columns {
    integers: [[i32; PACK]; 13],
    floats: [[f32; PACK]; 5],
}

impl Columns {
    #[inline(always)]
    fn new<S: Simd>(setups: &Setups<S>) -> Self {
        let mut columns = Self { integers: [[0; PACK]; 13], floats: [[0.0; PACK]; 5] };
        for (pack, column) in setups.bounds.iter().zip(&mut columns.integers[..4]) {
            pack.store_slice(column);
        }
        for (pack, column) in setups.edges.as_flattened().iter().zip(&mut columns.integers[4..]) {
            pack.store_slice(column);
        }
        for (pack, column) in setups.depth.iter().zip(&mut columns.floats[..3]) {
            pack.store_slice(column);
        }
        for (pack, column) in setups.depth_range.iter().zip(&mut columns.floats[3..]) {
            pack.store_slice(column);
        }
        columns
    }

    /// Returns triangle `i`, or `None` if there is no sample around it.
    #[inline(always)]
    fn triangle(&self, i: usize, id: u32) -> Option<TileTriangle> {
        let (n, f) = (&self.integers, &self.floats);
        let bounds = [n[0][i], n[1][i], n[2][i], n[3][i]];
        if bounds[0] > bounds[2] || bounds[1] > bounds[3] {
            return None;
        }
        let edges =
            [[n[4][i], n[5][i], n[6][i]], [n[7][i], n[8][i], n[9][i]], [n[10][i], n[11][i], n[12][i]]];
        let depth = [f[0][i], f[1][i], f[2][i]];
        Some(TileTriangle { bounds, edges, depth, depth_range: [f[3][i], f[4][i]], id })
    }
}
