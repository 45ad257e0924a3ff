//! Columns: one number for each of many points, so that neighbours load as one pack.

use super::pack::MOST_LANES;
use std::ops::{Deref, DerefMut};

/// The number of points that pass through a stage together; small enough to stay in the L1 and L2 caches.
pub const BATCH: usize = 256;

/// The number of entries of a column: a pack may be stored starting at any point.
pub const COLUMN: usize = BATCH + MOST_LANES;

/// A value for each point, in code that loads whole registers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Aligned<T>(pub [T; COLUMN]);

/// One number per point.
pub type Column = Aligned<f32>;

/// One word per point.
pub type Words = Aligned<u32>;

/// Four adjacent numbers per point.
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
