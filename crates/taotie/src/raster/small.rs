//! Triangles that are small relative to a tile, set up eight at a time: edge functions and depth as planes over its
//! pixels.

use super::setup::ScreenTriangle;
use super::{SUBPIXELS, Tile};
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
