//! Lanes of one number, not a pack or a recording: they can be converted to array indices.

use super::{Lane, scalar};

/// A [`Lane`] of one number.
pub trait Number: Lane {
    /// The number as an index: truncated, and 0 if it is negative or NaN.
    fn index(self) -> usize;
    /// The angle of the point (`x`, `y`) from the x axis, [−π, π].
    fn angle(y: Self, x: Self) -> Self;
}

impl Number for f32 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
    #[inline(always)]
    fn angle(y: Self, x: Self) -> Self {
        libm::atan2f(y, x)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
    #[inline(always)]
    fn angle(y: Self, x: Self) -> Self {
        scalar::atan2(y, x)
    }
}
