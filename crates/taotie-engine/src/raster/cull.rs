//! Finds the small triangles that are visible at all, eight at a time and exactly.

use super::{Faces, SUBPIXELS, Viewport};
use crate::math::dispatch_registers;
use fearless_simd::{Level, Simd, i32x8, mask32x8, prelude::*};

/// Triangles tested together: filled in one by one long before they are read as packs.
pub(super) const BLOCK: usize = 64;

const PACK: usize = 8;

/// Triangles with a longer side take the slow path: products of shorter ones fit 32 bits.
const LONG: i32 = 1 << 15;

/// Corners of the triangles of a block, x and y alternating, in 1/256 pixel.
pub(super) struct Corners {
    pub places: [[[i32; 2]; BLOCK]; 3],
}

/// Facts about the triangles of a block; bit i belongs to triangle i.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct CullResult {
    /// The triangles that cover a sample, or have enough samples around them that they may.
    pub seen: u64,
    /// The counter-clockwise triangles.
    pub counter_clockwise: u64,
    /// The triangles that are too large for this test or need clipping.
    pub unknown: u64,
}

/// The visibility test for a viewport.
#[derive(Debug, Clone, Copy)]
pub(super) struct Culling {
    viewport: Viewport,
    faces: Faces,
    level: Level,
}

impl Culling {
    pub fn new(viewport: &Viewport, faces: Faces, level: Level) -> Self {
        Self { viewport: *viewport, faces, level }
    }

    /// Tests the first `count` triangles of a block; the others must exist but may have any values.
    pub fn test(&self, corners: &Corners, count: usize) -> CullResult {
        dispatch_registers!(self.level, simd => self.block(simd, corners, count))
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, corners: &Corners, count: usize) -> CullResult {
        let mut all = CullResult::default();
        let mut start = 0;
        while start < count {
            let small = Small::load(simd, corners, start);
            let unknown = !small.is_small();
            let (turned, drawn) = small.turn(self.faces);
            let clockwise = small.clockwise(turned);
            let seen = drawn & !unknown;
            if seen.any_true() {
                let seen = seen & clockwise.covers(&self.viewport, seen);
                all.seen |= seen.to_bitmask() << start;
            }
            all.counter_clockwise |= turned.to_bitmask() << start;
            all.unknown |= unknown.to_bitmask() << start;
            start += PACK;
        }
        let asked = u64::MAX >> (BLOCK - count);
        CullResult { seen: all.seen & asked, unknown: all.unknown & asked, ..all }
    }
}

/// Eight triangles.
#[derive(Clone, Copy)]
struct Small<S: Simd> {
    simd: S,
    x: [i32x8<S>; 3],
    y: [i32x8<S>; 3],
    /// Left, top, right, bottom.
    bounds: [i32x8<S>; 4],
}

impl<S: Simd> Small<S> {
    #[inline(always)]
    fn load(simd: S, corners: &Corners, start: usize) -> Self {
        let (x0, y0) = load_places(simd, &corners.places[0][start..start + PACK]);
        let (x1, y1) = load_places(simd, &corners.places[1][start..start + PACK]);
        let (x2, y2) = load_places(simd, &corners.places[2][start..start + PACK]);
        let low = [x0.min(x1).min(x2), y0.min(y1).min(y2)];
        let high = [x0.max(x1).max(x2), y0.max(y1).max(y2)];
        Self { simd, x: [x0, x1, x2], y: [y0, y1, y2], bounds: [low[0], low[1], high[0], high[1]] }
    }

    #[inline(always)]
    fn is_small(&self) -> mask32x8<S> {
        let [left, top, right, bottom] = self.bounds;
        let long = self.splat(LONG);
        (right - left).simd_lt(long) & (bottom - top).simd_lt(long)
    }

    /// Returns the counter-clockwise triangles, and those with an area and a face that is drawn.
    #[inline(always)]
    fn turn(&self, faces: Faces) -> (mask32x8<S>, mask32x8<S>) {
        let ([x0, x1, x2], [y0, y1, y2]) = (self.x, self.y);
        let area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
        let zero = self.splat(0);
        let (turned, straight) = (area.simd_lt(zero), area.simd_gt(zero));
        let drawn = match faces {
            Faces::CounterClockwise => turned,
            Faces::Clockwise => straight,
            Faces::Both => turned | straight,
        };
        (turned, drawn)
    }

    /// The same with the corners of `turned` ones in clockwise order.
    #[inline(always)]
    fn clockwise(&self, turned: mask32x8<S>) -> Self {
        let ([x0, x1, x2], [y0, y1, y2]) = (self.x, self.y);
        let x = [x0, turned.select(x2, x1), turned.select(x1, x2)];
        let y = [y0, turned.select(y2, y1), turned.select(y1, y2)];
        Self { x, y, ..*self }
    }

    /// Returns the triangles, among those `asked` for, that cover a sample of the image. A triangle with more than
    /// two columns or rows of samples around it counts as covering one.
    #[inline(always)]
    fn covers(&self, viewport: &Viewport, asked: mask32x8<S>) -> mask32x8<S> {
        let mut covers = self.splat(0).simd_lt(self.splat(0));
        for &offset in viewport.pattern.offsets() {
            covers |= self.covers_at(viewport, offset);
            if !(asked & !covers).any_true() {
                break;
            }
        }
        covers
    }

    #[inline(always)]
    fn covers_at(&self, viewport: &Viewport, [sx, sy]: [i32; 2]) -> mask32x8<S> {
        let [left, top, right, bottom] = self.bounds;
        let (column, row) = (self.first(left, sx), self.first(top, sy));
        let columns = self.last(right, sx, viewport.width) - column;
        let rows = self.last(bottom, sy, viewport.height) - row;
        let (zero, one) = (self.splat(0), self.splat(1));
        let some = columns.simd_ge(zero) & rows.simd_ge(zero);
        let many = columns.simd_gt(one) | rows.simd_gt(one);
        if !(some & !many).any_true() {
            return some;
        }
        let at = [(column << 8) + sx, (row << 8) + sy];
        let edges = [self.edge([0, 1], at), self.edge([1, 2], at), self.edge([2, 0], at)];
        let (wide, tall) = (columns.simd_ge(one), rows.simd_ge(one));
        let [here, right] = [self.inside(&edges), self.inside(&moved(&edges, 1)) & wide];
        let edges = moved(&edges, 2);
        let [below, across] = [self.inside(&edges) & tall, self.inside(&moved(&edges, 1)) & wide & tall];
        some & (many | here | right | below | across)
    }

    /// The first column or row of samples at or after `low`.
    #[inline(always)]
    fn first(&self, low: i32x8<S>, offset: i32) -> i32x8<S> {
        ((low + (SUBPIXELS - 1 - offset)) >> 8).max(self.splat(0))
    }

    /// The last column or row of samples at or before `high`.
    #[inline(always)]
    fn last(&self, high: i32x8<S>, offset: i32, side: u32) -> i32x8<S> {
        ((high - offset) >> 8).min(self.splat(side as i32 - 1))
    }

    /// Returns the triangles for which no edge function is negative.
    #[inline(always)]
    fn inside(&self, edges: &[[i32x8<S>; 3]; 3]) -> mask32x8<S> {
        (edges[0][0] | edges[1][0] | edges[2][0]).simd_ge(self.splat(0))
    }

    /// The edge function from corner `i` to corner `j`, lowered by one unless the edge is a top or left one, at a
    /// position; with its steps one pixel to the right and one pixel down.
    #[inline(always)]
    fn edge(&self, [i, j]: [usize; 2], [x, y]: [i32x8<S>; 2]) -> [i32x8<S>; 3] {
        let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
        let zero = self.splat(0);
        let top_left = dy.simd_lt(zero) | dy.simd_eq(zero) & dx.simd_gt(zero);
        let value = dx * (y - self.y[i]) - dy * (x - self.x[i]);
        [value - top_left.select(zero, self.splat(1)), zero - (dy << 8), dx << 8]
    }

    #[inline(always)]
    fn splat(&self, value: i32) -> i32x8<S> {
        i32x8::splat(self.simd, value)
    }
}

/// Eight positions as x and y.
#[inline(always)]
fn load_places<S: Simd>(simd: S, places: &[[i32; 2]]) -> (i32x8<S>, i32x8<S>) {
    let (low, high) = places.as_flattened().split_at(PACK);
    i32x8::from_slice(simd, low).deinterleave(i32x8::from_slice(simd, high))
}

/// Edge functions one `step` further: 1 to the right, 2 down.
#[inline(always)]
fn moved<S: Simd>(edges: &[[i32x8<S>; 3]; 3], step: usize) -> [[i32x8<S>; 3]; 3] {
    let mut moved = *edges;
    for edge in &mut moved {
        edge[0] += edge[step];
    }
    moved
}
