//! Linear and bilinear interpolation.

use crate::math::{Lane, Vec3};

/// The mean of `a` and `b`; `share`, in [0, 1], is the weight of `b`.
#[inline(always)]
pub fn linear<L: Lane>(a: Vec3<L>, b: Vec3<L>, share: L) -> Vec3<L> {
    a * (share.lit(1.0) - share) + b * share
}

/// Bilinear interpolation of the upper left and right and the lower left and right texels; `across` and `down`, in
/// [0, 1], are the weights of the right and the lower texels.
#[inline(always)]
pub fn bilinear<L: Lane>([a, b, c, d]: [Vec3<L>; 4], [across, down]: [L; 2]) -> Vec3<L> {
    linear(linear(a, b, across), linear(c, d, across), down)
}
