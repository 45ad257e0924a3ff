//! Rays against triangles. Finds hits, never colours.

mod bvh;
mod by_area;
mod nearby;
mod packet;
mod ray;
mod sweep;
mod tree;

pub use bvh::{Bvh, FlatBox, FlatBvh, Hit, Nearest, RayInterval};
pub use nearby::Closest;
pub(crate) use nearby::farthest_distance;
pub use packet::{PacketOrigins, PacketView, ParallelRays, RayPacket};
pub use ray::Ray;
pub(crate) use sweep::{EightTriangles, Sweep};

/// Numbers for the tests of this module.
#[cfg(test)]
mod numbers {
    /// Numbers in [0, 1) from a linear congruence.
    pub(super) fn numbers(mut state: u32) -> impl FnMut() -> f32 {
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        }
    }
}
