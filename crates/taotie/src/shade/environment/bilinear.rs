//! Means of two and of four texels, by nearness.

use crate::math::{Lane, Vec3};

/// The mean of `a` and of `b`, whose weight is `share`, [0, 1].
#[inline(always)]
pub fn linear<L: Lane>(a: Vec3<L>, b: Vec3<L>, share: L) -> Vec3<L> {
    a * (share.lit(1.0) - share) + b * share
}

/// The mean of the upper two texels and the lower two, left and right; `across` and `down` are the weights of the right
/// and the lower ones, [0, 1].
#[inline(always)]
pub fn bilinear<L: Lane>([a, b, c, d]: [Vec3<L>; 4], [across, down]: [L; 2]) -> Vec3<L> {
    linear(linear(a, b, across), linear(c, d, across), down)
}
