//! Columns and rows of eight items at a time: blocks of rays, or shadows of triangles.

use super::tree::WIDTH;
use crate::math::{Mask, Pack};

/// The columns and rows of eight items: minimum and maximum, `low[axis][i]`; ∞ and −∞ for none.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub low: [[f32; WIDTH]; 2],
    pub high: [[f32; WIDTH]; 2],
}

impl Bounds {
    pub const EMPTY: Self = Self { low: [[f32::INFINITY; WIDTH]; 2], high: [[f32::NEG_INFINITY; WIDTH]; 2] };

    /// Returns the items that overlap these columns and rows, one bit each.
    #[inline(always)]
    pub fn touched<P: Pack>(&self, token: P::Token, [low, high]: [[f32; 2]; 2]) -> u64 {
        let mut touched = 0;
        for k in (0..WIDTH).step_by(P::LANES) {
            let zero = P::splat(token, 0.0);
            let mut within = zero.le(zero);
            for axis in 0..2 {
                within = within.and(P::load(token, &self.low[axis][k..]).le(P::splat(token, high[axis])));
                within = within.and(P::splat(token, low[axis]).le(P::load(token, &self.high[axis][k..])));
            }
            touched |= P::bits(within) << k;
        }
        touched
    }

    /// Returns the bounds of one.
    #[inline(always)]
    pub fn of(&self, i: usize) -> [[f32; 2]; 2] {
        [[self.low[0][i], self.low[1][i]], [self.high[0][i], self.high[1][i]]]
    }

    pub fn set(&mut self, i: usize, [low, high]: [[f32; 2]; 2]) {
        for axis in 0..2 {
            self.low[axis][i] = low[axis];
            self.high[axis][i] = high[axis];
        }
    }

    /// Returns the bounds of all.
    #[inline(always)]
    pub fn all(&self) -> [[f32; 2]; 2] {
        let mut all = Self::EMPTY.of(0);
        for i in 0..WIDTH {
            all = joined(all, self.of(i));
        }
        all
    }
}

/// Returns the bounds of both, ignoring NaN.
#[inline(always)]
pub(super) fn joined(all: [[f32; 2]; 2], [low, high]: [[f32; 2]; 2]) -> [[f32; 2]; 2] {
    let least = |axis: usize| if low[axis] < all[0][axis] { low[axis] } else { all[0][axis] };
    let most = |axis: usize| if high[axis] > all[1][axis] { high[axis] } else { all[1][axis] };
    [[least(0), least(1)], [most(0), most(1)]]
}
