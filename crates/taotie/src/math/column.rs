//! Columns: one number of each of many points, so that neighbours load as one pack.

use super::pack::MOST_LANES;
use std::ops::{Deref, DerefMut};

/// The number of points that go through a stage together; small enough to stay in the nearest caches.
pub const BATCH: usize = 256;

/// The number of entries of a column: a pack may be stored from any point on.
pub const COLUMN: usize = BATCH + MOST_LANES;

/// Something of each point, where registers are read in one piece.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Aligned<T>(pub [T; COLUMN]);

/// One number of each point.
pub type Column = Aligned<f32>;

/// One word of each point.
pub type Words = Aligned<u32>;

/// Four numbers of each point that come together.
pub type Quads = Aligned<[f32; 4]>;

impl Column {
    /// All zero.
    pub const ZERO: Self = Self([0.0; COLUMN]);
    /// All one.
    pub const ONE: Self = Self([1.0; COLUMN]);
}

impl Words {
    /// All zero.
    pub const ZERO: Self = Self([0; COLUMN]);
}

impl Quads {
    /// All zero.
    pub const ZERO: Self = Self([[0.0; 4]; COLUMN]);
}

impl<T> Deref for Aligned<T> {
    type Target = [T; COLUMN];
    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T> DerefMut for Aligned<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}
