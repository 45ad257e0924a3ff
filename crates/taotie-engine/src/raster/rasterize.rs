//! Finds the triangles visible in one tile: visits them by their size, small ones eight at a time, others one by one,
//! eight pixels at a time.

use super::bin::Bins;
use super::screen::ScreenTriangle;
use super::small::{BLOCK, Corners, FEW, Few, PACK, Samples, Setups, clamped};
use super::tile::{InFront, Layer, Nearest, Sink, Tile, TilePlane, TileSample};
use super::{SUBPIXELS, TILE_SIZE};
use crate::error::Result;
use crate::math::{SimdLevel, dispatch_registers};
use fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};

/// Fills `plane` with the nearest triangle of `bins` at a sample. At equal depth, the triangle drawn first wins.
///
/// # Errors
/// If the SIMD level is not available on this machine.
pub fn rasterize_opaque(
    bins: &Bins,
    at: TileSample<'_>,
    simd: SimdLevel,
    plane: &mut TilePlane,
) -> Result<()> {
    let level = simd.dispatch()?;
    plane.clear();
    if let (Some(ids), Some(depths)) = (plane.ids.first_chunk_mut(), plane.depths.first_chunk_mut()) {
        let mut sink = Nearest { ids, depths };
        dispatch_registers!(level, simd => scan(simd, bins, at, &mut sink));
    }
    Ok(())
}

/// Lists every triangle of `bins` in front of `opaque` at a sample, in drawing order.
///
/// # Errors
/// If the SIMD level is not available on this machine.
pub fn rasterize_layers(
    bins: &Bins,
    at: TileSample<'_>,
    simd: SimdLevel,
    opaque: &TilePlane,
) -> Result<Vec<Layer>> {
    let level = simd.dispatch()?;
    let mut layers = Vec::new();
    let mut sink = InFront { opaque: &opaque.depths, layers: &mut layers };
    dispatch_registers!(level, simd => scan(simd, bins, at, &mut sink));
    Ok(layers)
}

/// Passes the coverage of the triangles of `bins` to `sink`, in drawing order.
#[inline(always)]
fn scan<S: Simd, K: Sink>(simd: S, bins: &Bins, at: TileSample<'_>, sink: &mut K) {
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

const SIDE: i32 = TILE_SIZE as i32;

/// Pixels processed side by side.
const STEP: i32 = 8;

/// Edge values beyond this decide for the whole tile, since the steps within a tile have a smaller sum.
const FAR: i64 = 1 << 30;

/// A triangle relative to a tile: edge functions and depth as planes over its pixels.
struct TileTriangle {
    /// Pixels of the tile to visit: left, top, right, bottom, inclusive.
    bounds: [i32; 4],
    /// The edge functions, each: value at pixel (0, 0), step per column, step per row. Inside if all values are ≥ 0.
    edges: [[i32; 3]; 3],
    /// The same for depth.
    depth: [f32; 3],
    /// The range of the corners' depths; depth stays within it.
    depth_range: [f32; 2],
    id: u32,
}

impl TileTriangle {
    fn new(triangle: &ScreenTriangle, tile: &Tile, [sx, sy]: [i32; 2]) -> Option<Self> {
        let origin = [tile.x as i32 * SUBPIXELS + sx, tile.y as i32 * SUBPIXELS + sy];
        let [left, top, right, bottom] = triangle.bounds();
        let first = |v: i32, o: i32| (v - o + SUBPIXELS - 1).div_euclid(SUBPIXELS).max(0);
        let last = |v: i32, o: i32, side: u32| (v - o).div_euclid(SUBPIXELS).min(side as i32 - 1);
        let bounds = [
            first(left, origin[0]),
            first(top, origin[1]),
            last(right, origin[0], tile.width),
            last(bottom, origin[1], tile.height),
        ];
        if bounds[0] > bounds[2] || bounds[1] > bounds[3] {
            return None;
        }
        let edges =
            [edge(triangle, [0, 1], origin), edge(triangle, [1, 2], origin), edge(triangle, [2, 0], origin)];
        let [a, b, c] = triangle.depth;
        Some(Self {
            bounds,
            edges,
            depth: depth_plane(triangle, origin),
            depth_range: [a.min(b).min(c), a.max(b).max(c)],
            id: triangle.id,
        })
    }
}

/// The edge function from corner `i` to corner `j` over the samples of the tile.
///
/// In 1/256 pixel it is 256·(A·column + B·row) + C with integers A, B, C; since A·column + B·row is an integer, its
/// sign is that of A·column + B·row + ⌊C/256⌋, which fits 32 bits. Samples on an edge count only for top and left
/// edges: for the others, C is lowered by one.
fn edge(triangle: &ScreenTriangle, [i, j]: [usize; 2], [ox, oy]: [i32; 2]) -> [i32; 3] {
    let dx = i64::from(triangle.x[j] - triangle.x[i]);
    let dy = i64::from(triangle.y[j] - triangle.y[i]);
    let top_left = dy < 0 || (dy == 0 && dx > 0);
    let at_origin = dx * i64::from(oy - triangle.y[i]) - dy * i64::from(ox - triangle.x[i]);
    let constant = (at_origin - i64::from(!top_left)).div_euclid(i64::from(SUBPIXELS)).clamp(-FAR - 1, FAR);
    [constant as i32, -dy as i32, dx as i32]
}

fn depth_plane(triangle: &ScreenTriangle, [ox, oy]: [i32; 2]) -> [f32; 3] {
    let [x, y] = [triangle.x.map(f64::from), triangle.y.map(f64::from)];
    let z = triangle.depth.map(f64::from);
    let area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    let dz_dx = ((z[1] - z[0]) * (y[2] - y[0]) - (z[2] - z[0]) * (y[1] - y[0])) / area;
    let dz_dy = ((z[2] - z[0]) * (x[1] - x[0]) - (z[1] - z[0]) * (x[2] - x[0])) / area;
    let at_origin = z[0] + dz_dx * (f64::from(ox) - x[0]) + dz_dy * (f64::from(oy) - y[0]);
    let subpixels = f64::from(SUBPIXELS);
    [at_origin as f32, (dz_dx * subpixels) as f32, (dz_dy * subpixels) as f32]
}

/// Visits the packs of pixels around a triangle, column by column.
#[inline(always)]
fn scan_packs<S: Simd, K: Sink>(simd: S, triangle: &TileTriangle, sink: &mut K) {
    let [left, _, right, _] = triangle.bounds;
    if right - left < STEP {
        // One pack per row; it may begin anywhere as long as it ends in its row.
        scan_column::<S, K, false>(simd, triangle, left.min(SIDE - STEP), sink);
        return;
    }
    let mut column = left & !(STEP - 1);
    while column <= right {
        scan_column::<S, K, true>(simd, triangle, column, sink);
        column += STEP;
    }
}

/// Visits a pack of pixels in each row. `SPARSE` is faster if many packs may have no covered pixel.
#[inline(always)]
fn scan_column<S: Simd, K: Sink, const SPARSE: bool>(
    simd: S,
    triangle: &TileTriangle,
    column: i32,
    sink: &mut K,
) {
    let [_, top, right, bottom] = triangle.bounds;
    let [origin, step_x, step_y] = triangle.depth;
    let [low, high] = triangle.depth_range;
    let range = [f32x8::splat(simd, low), f32x8::splat(simd, high)];
    let [e0, e1, e2] = triangle.edges;
    let x = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]) + column;
    let there = x.simd_le(i32x8::splat(simd, right));
    let mut edges = [
        x * e0[1] + (e0[0] + e0[2] * top),
        x * e1[1] + (e1[0] + e1[2] * top),
        x * e2[1] + (e2[0] + e2[2] * top),
    ];
    let x: f32x8<S> = x.to_float();
    let depth_column = x * step_x;
    let mut row = top;
    while row <= bottom {
        let inside = there & (edges[0] | edges[1] | edges[2]).simd_ge(i32x8::splat(simd, 0));
        if !SPARSE || inside.any_true() {
            let depth = clamped(depth_column + (origin + step_y * row as f32), range);
            sink.pack((row * SIDE + column) as usize, inside, depth, triangle.id);
        }
        edges = [edges[0] + e0[2], edges[1] + e1[2], edges[2] + e2[2]];
        row += 1;
    }
}
