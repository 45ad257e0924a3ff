//! Coverage and depth of one tile, eight pixels at a time.

use super::setup::ScreenTriangle;
use super::small::{BLOCK, Corners, FEW, PACK as SIDE_BY_SIDE, Samples, Setups};
use super::{Bins, SUBPIXELS, Viewport};
use crate::error::Result;
use crate::math::SimdLevel;
use fearless_simd::{Simd, dispatch, f32x8, i32x8, mask32x8, prelude::*, u32x8};

/// The side of a tile in pixels.
pub const TILE_SIZE: u32 = 64;

/// The pixels of a tile.
pub const TILE_PIXELS: usize = (TILE_SIZE * TILE_SIZE) as usize;

/// The id that says "nothing here".
pub const NO_TRIANGLE: u32 = u32::MAX;

const SIDE: i32 = TILE_SIZE as i32;
const PACK: i32 = 8;

/// Edge values beyond this decide the whole tile, since steps within a tile sum to less.
const FAR: i64 = 1 << 30;

/// A tile by its place in the picture.
#[derive(Debug, Clone, Copy)]
pub struct Tile {
    /// Index, row by row.
    pub index: usize,
    /// The left column of pixels.
    pub x: u32,
    /// The top row of pixels.
    pub y: u32,
    /// Columns that are inside the picture, 1 to [`TILE_SIZE`].
    pub width: u32,
    /// Rows that are inside the picture.
    pub height: u32,
}

impl Tile {
    /// The tile of `viewport` with this index.
    pub fn new(viewport: &Viewport, index: usize) -> Self {
        let (across, _) = viewport.tiles();
        let x = (index as u32 % across) * TILE_SIZE;
        let y = (index as u32 / across) * TILE_SIZE;
        let width = TILE_SIZE.min(viewport.width - x);
        let height = TILE_SIZE.min(viewport.height - y);
        Self { index, x, y, width, height }
    }
}

/// The nearest triangle at one sample of each pixel of a tile. Pixel (x, y) is at `y · TILE_SIZE + x`.
#[derive(Debug, Clone)]
pub struct TilePlane {
    /// Triangle ids, or [`NO_TRIANGLE`].
    pub ids: Vec<u32>,
    /// Reversed depth: 1 near, 0 far or nothing.
    pub depths: Vec<f32>,
}

impl Default for TilePlane {
    fn default() -> Self {
        Self { ids: vec![NO_TRIANGLE; TILE_PIXELS], depths: vec![0.0; TILE_PIXELS] }
    }
}

/// A triangle seen at a sample, in front of what is opaque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// `y · TILE_SIZE + x` in the tile.
    pub pixel: u32,
    /// Triangle id.
    pub id: u32,
    /// Reversed depth.
    pub depth: f32,
}

/// Fills `plane` with the nearest triangle of `bins` at the sample `offset` (1/256 pixel). At equal depth the
/// triangle drawn first stays.
///
/// # Errors
/// Where the SIMD level is not to be had on this machine.
pub fn rasterize_opaque(
    bins: &Bins,
    tile: &Tile,
    offset: [i32; 2],
    simd: SimdLevel,
    plane: &mut TilePlane,
) -> Result<()> {
    let level = simd.dispatch()?;
    plane.ids.fill(NO_TRIANGLE);
    plane.depths.fill(0.0);
    let mut sink = Nearest { plane };
    dispatch!(level, simd => scan_triangles(simd, bins, tile, offset, &mut sink));
    Ok(())
}

/// Lists every triangle of `bins` in front of `opaque` at the sample `offset`, in drawing order.
///
/// # Errors
/// Where the SIMD level is not to be had on this machine.
pub fn rasterize_layers(
    bins: &Bins,
    tile: &Tile,
    offset: [i32; 2],
    simd: SimdLevel,
    opaque: &TilePlane,
) -> Result<Vec<Layer>> {
    let level = simd.dispatch()?;
    let mut layers = Vec::new();
    let mut sink = InFront { opaque, layers: &mut layers };
    dispatch!(level, simd => scan_triangles(simd, bins, tile, offset, &mut sink));
    Ok(layers)
}

/// What becomes of covered pixels.
trait Sink {
    /// Eight pixels from `pixel` on; `covered` says which, `depth` how near.
    fn pack<S: Simd>(&mut self, pixel: usize, covered: mask32x8<S>, depth: f32x8<S>, id: u32);

    /// One pixel.
    fn one(&mut self, pixel: usize, depth: f32, id: u32);
}

struct Nearest<'a> {
    plane: &'a mut TilePlane,
}

impl Sink for Nearest<'_> {
    #[inline(always)]
    fn pack<S: Simd>(&mut self, pixel: usize, covered: mask32x8<S>, depth: f32x8<S>, id: u32) {
        let simd = depth.token();
        let depths = &mut self.plane.depths[pixel..pixel + PACK as usize];
        let before = f32x8::from_slice(simd, depths);
        let wins = covered & before.simd_lt(depth);
        if wins.any_true() {
            wins.select(depth, before).store_slice(depths);
            let ids = &mut self.plane.ids[pixel..pixel + PACK as usize];
            let old = u32x8::from_slice(simd, ids);
            wins.select(u32x8::splat(simd, id), old).store_slice(ids);
        }
    }

    #[inline(always)]
    fn one(&mut self, pixel: usize, depth: f32, id: u32) {
        if self.plane.depths[pixel] < depth {
            self.plane.depths[pixel] = depth;
            self.plane.ids[pixel] = id;
        }
    }
}

struct InFront<'a> {
    opaque: &'a TilePlane,
    layers: &'a mut Vec<Layer>,
}

impl Sink for InFront<'_> {
    #[inline(always)]
    fn pack<S: Simd>(&mut self, pixel: usize, covered: mask32x8<S>, depth: f32x8<S>, id: u32) {
        let simd = depth.token();
        let before = f32x8::from_slice(simd, &self.opaque.depths[pixel..pixel + PACK as usize]);
        let seen = covered & before.simd_lt(depth);
        if !seen.any_true() {
            return;
        }
        let mut depths = [0.0; 8];
        depth.store_slice(&mut depths);
        let mut flags = [0.0; 8];
        seen.select(f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.0)).store_slice(&mut flags);
        for i in 0..8 {
            if flags[i] != 0.0 {
                self.layers.push(Layer { pixel: (pixel + i) as u32, id, depth: depths[i] });
            }
        }
    }

    #[inline(always)]
    fn one(&mut self, pixel: usize, depth: f32, id: u32) {
        if self.opaque.depths[pixel] < depth {
            self.layers.push(Layer { pixel: pixel as u32, id, depth });
        }
    }
}

/// A triangle relative to a tile: edge functions and depth as planes over its pixels.
struct TileTriangle {
    /// Pixels of the tile to visit: left, top, right, bottom, inclusive.
    bounds: [i32; 4],
    /// For each edge: value at pixel (0, 0), step a column, step a row. Inside where all values are ≥ 0.
    edges: [[i32; 3]; 3],
    /// The same for depth.
    depth: [f32; 3],
    /// Depth stays within the corners'.
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
/// edges: for the others C is lowered by one.
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

#[inline(always)]
fn scan_triangles<S: Simd, K: Sink>(simd: S, bins: &Bins, tile: &Tile, offset: [i32; 2], sink: &mut K) {
    let mut scan = Scan { simd, tile, offset, samples: Samples::new(tile, offset), corners: Corners::new() };
    for (triangles, members) in bins.tile(tile.index) {
        for members in members.chunks(BLOCK) {
            scan.block(triangles, members, sink);
        }
    }
}

/// Going over the triangles of a tile.
struct Scan<'a, S> {
    simd: S,
    tile: &'a Tile,
    offset: [i32; 2],
    samples: Samples,
    corners: Corners,
}

impl<S: Simd> Scan<'_, S> {
    /// At most [`BLOCK`] triangles.
    #[inline(always)]
    fn block<K: Sink>(&mut self, triangles: &[ScreenTriangle], members: &[u32], sink: &mut K) {
        for (i, member) in members.iter().enumerate() {
            self.corners.set(i, &triangles[*member as usize]);
        }
        for (i, members) in members.chunks(SIDE_BY_SIDE).enumerate() {
            let (setups, small) = Setups::new(self.simd, &self.corners, i * SIDE_BY_SIDE, &self.samples);
            let all = (1 << members.len()) - 1;
            if small & all == all && setups.few_samples() & all == all {
                scan_few(self.simd, &setups, triangles, members, sink);
            } else {
                self.one_by_one(&setups, small, triangles, members, sink);
            }
        }
    }

    #[inline(always)]
    fn one_by_one<K: Sink>(
        &self,
        setups: &Setups<S>,
        small: u64,
        triangles: &[ScreenTriangle],
        members: &[u32],
        sink: &mut K,
    ) {
        let columns = Columns::new(setups);
        for (i, member) in members.iter().enumerate() {
            let triangle = &triangles[*member as usize];
            let setup = match small >> i & 1 == 1 {
                true => columns.triangle(i, triangle.id),
                false => TileTriangle::new(triangle, self.tile, self.offset),
            };
            if let Some(setup) = setup {
                scan_packs(self.simd, &setup, sink);
            }
        }
    }
}

/// Set-ups of eight triangles in memory.
struct Columns {
    integers: [[i32; SIDE_BY_SIDE]; 13],
    floats: [[f32; SIDE_BY_SIDE]; 5],
}

impl Columns {
    #[inline(always)]
    fn new<S: Simd>(setups: &Setups<S>) -> Self {
        let mut columns = Self { integers: [[0; SIDE_BY_SIDE]; 13], floats: [[0.0; SIDE_BY_SIDE]; 5] };
        for k in 0..4 {
            setups.bounds[k].store_slice(&mut columns.integers[k]);
        }
        for k in 0..9 {
            setups.edges[k / 3][k % 3].store_slice(&mut columns.integers[4 + k]);
        }
        for k in 0..3 {
            setups.depth[k].store_slice(&mut columns.floats[k]);
        }
        for k in 0..2 {
            setups.depth_range[k].store_slice(&mut columns.floats[3 + k]);
        }
        columns
    }

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

/// Triangles with at most four columns and rows of samples around them: all triangles of the pack at one sample each, then
/// the samples that they cover one by one.
#[inline(always)]
fn scan_few<S: Simd, K: Sink>(
    simd: S,
    setups: &Setups<S>,
    triangles: &[ScreenTriangle],
    members: &[u32],
    sink: &mut K,
) {
    let [left, top, right, bottom] = setups.bounds;
    let mut depths = [[0.0f32; SIDE_BY_SIDE]; FEW * FEW];
    let mut covered = i32x8::splat(simd, 0);
    let mut row = 0;
    while row < FEW {
        let y = top + row as i32;
        let row_there = y.simd_le(bottom);
        if !row_there.any_true() {
            break;
        }
        let mut edges = [left; 3];
        for k in 0..3 {
            let [constant, a, b] = setups.edges[k];
            edges[k] = a * left + (constant + b * y);
        }
        let y: f32x8<S> = y.to_float();
        let depth_row = setups.depth[0] + setups.depth[2] * y;
        let mut column = 0;
        while column < FEW {
            let x = left + column as i32;
            let there = row_there & x.simd_le(right);
            if !there.any_true() {
                break;
            }
            let inside = there & (edges[0] | edges[1] | edges[2]).simd_ge(i32x8::splat(simd, 0));
            let sample = row * FEW + column;
            covered = covered | inside.select(i32x8::splat(simd, 1 << sample), i32x8::splat(simd, 0));
            let x: f32x8<S> = x.to_float();
            let depth = clamped(x * setups.depth[1] + depth_row, setups.depth_range);
            depth.store_slice(&mut depths[sample]);
            for k in 0..3 {
                edges[k] = edges[k] + setups.edges[k][1];
            }
            column += 1;
        }
        row += 1;
    }
    let mut first = [0; SIDE_BY_SIDE];
    (top * SIDE + left).store_slice(&mut first);
    let mut samples = [0; SIDE_BY_SIDE];
    covered.store_slice(&mut samples);
    for (i, member) in members.iter().enumerate() {
        let id = triangles[*member as usize].id;
        let mut left = samples[i] as u32;
        while left != 0 {
            let sample = left.trailing_zeros() as usize;
            left &= left - 1;
            let pixel = first[i] as usize + sample / FEW * TILE_SIZE as usize + sample % FEW;
            sink.one(pixel, depths[sample][i], id);
        }
    }
}

#[inline(always)]
fn scan_packs<S: Simd, K: Sink>(simd: S, triangle: &TileTriangle, sink: &mut K) {
    let [left, top, right, bottom] = triangle.bounds;
    let columns = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let [origin, step_x, step_y] = triangle.depth;
    let [low, high] = triangle.depth_range;
    let range = [f32x8::splat(simd, low), f32x8::splat(simd, high)];
    let [e0, e1, e2] = triangle.edges;
    let down = [i32x8::splat(simd, e0[2]), i32x8::splat(simd, e1[2]), i32x8::splat(simd, e2[2])];
    let mut column = left & !(PACK - 1);
    while column <= right {
        let x = columns + column;
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
            if inside.any_true() {
                let depth = clamped(depth_column + (origin + step_y * row as f32), range);
                sink.pack((row * SIDE + column) as usize, inside, depth, triangle.id);
            }
            edges = [edges[0] + down[0], edges[1] + down[1], edges[2] + down[2]];
            row += 1;
        }
        column += PACK;
    }
}

#[inline(always)]
fn clamped<S: Simd>(depth: f32x8<S>, [low, high]: [f32x8<S>; 2]) -> f32x8<S> {
    let depth = depth.simd_lt(low).select(low, depth);
    high.simd_lt(depth).select(high, depth)
}
