//! One triangle of any size in a tile, eight pixels at a time.

use super::setup::ScreenTriangle;
use super::sink::Sink;
use super::{SUBPIXELS, TILE_SIZE, Tile};
use fearless_simd::{Simd, f32x8, i32x8, prelude::*};

const SIDE: i32 = TILE_SIZE as i32;
const PACK: i32 = 8;

/// Edge values beyond this decide for the whole tile, since the steps within a tile have a smaller sum.
const FAR: i64 = 1 << 30;

/// A triangle relative to a tile: edge functions and depth as planes over its pixels.
pub(super) struct TileTriangle {
    /// Pixels of the tile to visit: left, top, right, bottom, inclusive.
    pub bounds: [i32; 4],
    /// The edge functions, each: value at pixel (0, 0), step per column, step per row. Inside if all values are ≥ 0.
    pub edges: [[i32; 3]; 3],
    /// The same for depth.
    pub depth: [f32; 3],
    /// The range of the corners' depths; depth stays within it.
    pub depth_range: [f32; 2],
    pub id: u32,
}

impl TileTriangle {
    pub fn new(triangle: &ScreenTriangle, tile: &Tile, [sx, sy]: [i32; 2]) -> Option<Self> {
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
pub(super) fn scan_packs<S: Simd, K: Sink>(simd: S, triangle: &TileTriangle, sink: &mut K) {
    let [left, _, right, _] = triangle.bounds;
    if right - left < PACK {
        // One pack per row; it may begin anywhere as long as it ends in its row.
        scan_column::<S, K, false>(simd, triangle, left.min(SIDE - PACK), sink);
        return;
    }
    let mut column = left & !(PACK - 1);
    while column <= right {
        scan_column::<S, K, true>(simd, triangle, column, sink);
        column += PACK;
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

/// `depth` clamped to the range; NaN stays.
#[inline(always)]
pub(super) fn clamped<S: Simd>(depth: f32x8<S>, [low, high]: [f32x8<S>; 2]) -> f32x8<S> {
    let depth = depth.simd_lt(low).select(low, depth);
    high.simd_lt(depth).select(high, depth)
}
