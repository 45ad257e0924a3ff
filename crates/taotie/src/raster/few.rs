//! Triangles with few samples around them: eight triangles at one sample each.

use super::TILE_SIZE;
use super::sink::Sink;
use super::small::{PACK, Setups};
use super::triangle::clamped;
use fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};

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
