//! Triangles that are small relative to a tile, set up eight at a time: edge functions and depth as planes over its
//! pixels. Those with few samples around them are tested eight at a time too, at one sample each.

use super::screen::ScreenTriangle;
use super::tile::{Sink, Tile};
use super::{SUBPIXELS, TILE_SIZE};
use fearless_simd::{Simd, f32x8, f64x4, i32x8, mask32x8, prelude::*};

/// Triangles set up together: filled in one by one long before they are read as packs.
pub(super) const BLOCK: usize = 64;

/// Triangles processed side by side.
pub(super) const PACK: usize = 8;

/// Triangles with a longer side, in 1/256 pixel, are not small: products of shorter ones with positions within a tile
/// fit 32 bits.
const LONG: i32 = 1 << 14;

/// The corners of a block of triangles, one column per coordinate.
pub(super) struct Corners {
    x: [[i32; BLOCK]; 3],
    y: [[i32; BLOCK]; 3],
    depth: [[f32; BLOCK]; 3],
}

impl Corners {
    pub fn new() -> Self {
        Self { x: [[0; BLOCK]; 3], y: [[0; BLOCK]; 3], depth: [[0.0; BLOCK]; 3] }
    }

    #[inline(always)]
    pub fn set(&mut self, i: usize, triangle: &ScreenTriangle) {
        for k in 0..3 {
            self.x[k][i] = triangle.x[k];
            self.y[k][i] = triangle.y[k];
            self.depth[k][i] = triangle.depth[k];
        }
    }
}

/// Eight triangles relative to the samples of a tile. The values of a triangle that is not small are meaningless.
#[derive(Clone, Copy)]
pub(super) struct Setups<S: Simd> {
    /// Pixels of the tile to visit: left, top, right, bottom, inclusive; none where left > right or top >
    /// bottom.
    pub bounds: [i32x8<S>; 4],
    /// The edge functions, each: value at pixel (0, 0), step per column, step per row. Inside if all values are ≥ 0.
    pub edges: [[i32x8<S>; 3]; 3],
    /// The same for depth.
    pub depth: [f32x8<S>; 3],
    /// The range of the corners' depths; depth stays within it.
    pub depth_range: [f32x8<S>; 2],
}

/// The position of a tile's first sample in 1/256 pixel, and its size.
#[derive(Clone, Copy)]
pub(super) struct Samples {
    pub origin: [i32; 2],
    pub size: [i32; 2],
}

impl Samples {
    pub fn new(tile: &Tile, [sx, sy]: [i32; 2]) -> Self {
        let origin = [tile.x as i32 * SUBPIXELS + sx, tile.y as i32 * SUBPIXELS + sy];
        Self { origin, size: [tile.width as i32, tile.height as i32] }
    }
}

/// The corners of eight triangles.
#[derive(Clone, Copy)]
struct Octet<S: Simd> {
    simd: S,
    x: [i32x8<S>; 3],
    y: [i32x8<S>; 3],
}

impl<S: Simd> Setups<S> {
    /// Sets up the triangles from `start` onwards, and returns which of them are small.
    #[inline(always)]
    pub fn new(simd: S, corners: &Corners, start: usize, samples: &Samples) -> (Self, mask32x8<S>) {
        let octet = Octet::load(simd, corners, start);
        let [left, top, right, bottom] = octet.bounds();
        let long = i32x8::splat(simd, LONG);
        let small = (right - left).simd_lt(long) & (bottom - top).simd_lt(long);
        let [ox, oy] = samples.origin;
        let bounds = [
            octet.first(left, ox),
            octet.first(top, oy),
            octet.last(right, ox, samples.size[0]),
            octet.last(bottom, oy, samples.size[1]),
        ];
        let origin = samples.origin;
        let edges = [octet.edge([0, 1], origin), octet.edge([1, 2], origin), octet.edge([2, 0], origin)];
        let z = [
            f32x8::from_slice(simd, &corners.depth[0][start..start + PACK]),
            f32x8::from_slice(simd, &corners.depth[1][start..start + PACK]),
            f32x8::from_slice(simd, &corners.depth[2][start..start + PACK]),
        ];
        let depth_range = [least(least(z[0], z[1]), z[2]), most(most(z[0], z[1]), z[2])];
        let setups = Self { bounds, edges, depth: octet.depth_plane(z, origin), depth_range };
        (setups, small)
    }
}

impl<S: Simd> Octet<S> {
    #[inline(always)]
    fn load(simd: S, corners: &Corners, start: usize) -> Self {
        let end = start + PACK;
        let ([x0, x1, x2], [y0, y1, y2]) = (&corners.x, &corners.y);
        let x = [
            i32x8::from_slice(simd, &x0[start..end]),
            i32x8::from_slice(simd, &x1[start..end]),
            i32x8::from_slice(simd, &x2[start..end]),
        ];
        let y = [
            i32x8::from_slice(simd, &y0[start..end]),
            i32x8::from_slice(simd, &y1[start..end]),
            i32x8::from_slice(simd, &y2[start..end]),
        ];
        Self { simd, x, y }
    }

    #[inline(always)]
    fn bounds(&self) -> [i32x8<S>; 4] {
        let ([x0, x1, x2], [y0, y1, y2]) = (self.x, self.y);
        [x0.min(x1).min(x2), y0.min(y1).min(y2), x0.max(x1).max(x2), y0.max(y1).max(y2)]
    }

    #[inline(always)]
    fn first(&self, low: i32x8<S>, origin: i32) -> i32x8<S> {
        ((low + (SUBPIXELS - 1 - origin)) >> 8).max(i32x8::splat(self.simd, 0))
    }

    #[inline(always)]
    fn last(&self, high: i32x8<S>, origin: i32, side: i32) -> i32x8<S> {
        ((high - origin) >> 8).min(i32x8::splat(self.simd, side - 1))
    }

    /// Equivalent to `edge` of large triangles, without overflow.
    #[inline(always)]
    fn edge(&self, [i, j]: [usize; 2], [ox, oy]: [i32; 2]) -> [i32x8<S>; 3] {
        let (zero, one) = (i32x8::splat(self.simd, 0), i32x8::splat(self.simd, 1));
        let (ox, oy) = (i32x8::splat(self.simd, ox), i32x8::splat(self.simd, oy));
        let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
        let top_left = dy.simd_lt(zero) | dy.simd_eq(zero) & dx.simd_gt(zero);
        let at_origin = dx * (oy - self.y[i]) - dy * (ox - self.x[i]);
        [(at_origin - top_left.select(zero, one)) >> 8, zero - dy, dx]
    }

    #[inline(always)]
    fn depth_plane(&self, z: [f32x8<S>; 3], [ox, oy]: [i32; 2]) -> [f32x8<S>; 3] {
        let (ox, oy) = (i32x8::splat(self.simd, ox), i32x8::splat(self.simd, oy));
        let ([x0, x1, x2], [y0, y1, y2]) = (self.x, self.y);
        // Integers of at most 24 bits.
        let (x1, y1, x2, y2) = (wide(x1 - x0), wide(y1 - y0), wide(x2 - x0), wide(y2 - y0));
        let (ox, oy) = (wide(ox - x0), wide(oy - y0));
        let (z0, z1, z2) = (z[0].widen(), z[1].widen(), z[2].widen());
        let low = plane([x1.0, x2.0], [y1.0, y2.0], [z0.0, z1.0, z2.0], [ox.0, oy.0]);
        let high = plane([x1.1, x2.1], [y1.1, y2.1], [z0.1, z1.1, z2.1], [ox.1, oy.1]);
        [low[0].narrow(high[0]), low[1].narrow(high[1]), low[2].narrow(high[2])]
    }
}

#[inline(always)]
fn wide<S: Simd>(v: i32x8<S>) -> (f64x4<S>, f64x4<S>) {
    let float: f32x8<S> = v.to_float();
    float.widen()
}

/// Returns the depth at the first sample and its steps, from corners relative to the first one.
#[inline(always)]
fn plane<S: Simd>(
    [x1, x2]: [f64x4<S>; 2],
    [y1, y2]: [f64x4<S>; 2],
    [z0, z1, z2]: [f64x4<S>; 3],
    [ox, oy]: [f64x4<S>; 2],
) -> [f64x4<S>; 3] {
    let area = x1 * y2 - x2 * y1;
    let dz_dx = ((z1 - z0) * y2 - (z2 - z0) * y1) / area;
    let dz_dy = ((z2 - z0) * x1 - (z1 - z0) * x2) / area;
    let at_origin = z0 + dz_dx * ox + dz_dy * oy;
    let subpixels = f64::from(SUBPIXELS);
    [at_origin, dz_dx * subpixels, dz_dy * subpixels]
}

/// The minimum; `a` if either is NaN.
#[inline(always)]
fn least<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
    b.simd_lt(a).select(b, a)
}

/// The maximum; `a` if either is NaN.
#[inline(always)]
fn most<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
    a.simd_lt(b).select(b, a)
}

/// The maximum number of columns, and of rows, of samples that count as few.
pub(super) const FEW: usize = 5;

/// The samples covered by eight triangles, and their depths.
pub(super) struct Few {
    /// The pixel of the top left sample around each triangle.
    first: [i32; PACK],
    /// Bit `row · FEW + column` is set if that sample is covered.
    covered: [u32; PACK],
    /// The depths, by `row · FEW + column`.
    depths: [[f32; PACK]; FEW * FEW],
}

impl Few {
    pub fn new() -> Self {
        Self { first: [0; PACK], covered: [0; PACK], depths: [[0.0; PACK]; FEW * FEW] }
    }

    /// Tests the triangles of `asked`, each of which has few samples around it.
    #[inline(always)]
    pub fn fill<S: Simd>(&mut self, simd: S, setups: &Setups<S>, asked: mask32x8<S>) {
        let [left, top, _, bottom] = setups.bounds;
        let mut covered = i32x8::splat(simd, 0);
        let mut row = 0;
        while row < FEW {
            let y = top + row as i32;
            let there = asked & y.simd_le(bottom);
            if !there.any_true() {
                break;
            }
            covered |= self.fill_row(simd, setups, row, there) << (row * FEW) as u32;
            row += 1;
        }
        covered.bitcast::<fearless_simd::u32x8<S>>().store_slice(&mut self.covered);
        (top * TILE_SIZE as i32 + left).store_slice(&mut self.first);
    }

    /// The bits of a row's covered samples.
    #[inline(always)]
    fn fill_row<S: Simd>(&mut self, simd: S, setups: &Setups<S>, row: usize, there: mask32x8<S>) -> i32x8<S> {
        let [left, top, right, _] = setups.bounds;
        let y = top + row as i32;
        let [[c0, a0, b0], [c1, a1, b1], [c2, a2, b2]] = setups.edges;
        let mut edges = [a0 * left + (c0 + b0 * y), a1 * left + (c1 + b1 * y), a2 * left + (c2 + b2 * y)];
        let y: f32x8<S> = y.to_float();
        let [origin, step_x, step_y] = setups.depth;
        let depth_row = origin + step_y * y;
        let zero = i32x8::splat(simd, 0);
        let mut covered = zero;
        let mut column = 0;
        while column < FEW {
            let x = left + column as i32;
            let there = there & x.simd_le(right);
            if !there.any_true() {
                break;
            }
            let inside = there & (edges[0] | edges[1] | edges[2]).simd_ge(zero);
            covered |= inside.select(i32x8::splat(simd, 1 << column), zero);
            let x: f32x8<S> = x.to_float();
            let depth = clamped(x * step_x + depth_row, setups.depth_range);
            depth.store_slice(&mut self.depths[row * FEW + column]);
            edges = [edges[0] + a0, edges[1] + a1, edges[2] + a2];
            column += 1;
        }
        covered
    }

    /// Passes on the samples covered by triangle `i`.
    #[inline(always)]
    pub fn visit<K: Sink>(&self, i: usize, id: u32, sink: &mut K) {
        let mut left = self.covered[i];
        while left != 0 {
            let sample = left.trailing_zeros() as usize;
            left &= left - 1;
            let pixel = self.first[i] as usize + sample / FEW * TILE_SIZE as usize + sample % FEW;
            sink.one(pixel, self.depths[sample][i], id);
        }
    }
}

/// `depth` clamped to the range; NaN stays.
#[inline(always)]
pub(super) fn clamped<S: Simd>(depth: f32x8<S>, [low, high]: [f32x8<S>; 2]) -> f32x8<S> {
    let depth = depth.simd_lt(low).select(low, depth);
    high.simd_lt(depth).select(high, depth)
}
