//! Rays against triangles. Finds hits, never colours.

mod bounds;
mod bvh;
mod by_area;
mod flat;
mod hilbert;
mod nearby;
mod nearest;
#[cfg(test)]
mod numbers;
mod packet_origins;
mod packet_walk;
mod ray_packet;
mod shadows;
mod sweep;
mod tree;
mod triangle;
mod walk;

pub use bvh::{Bvh, Hit};
pub use flat::{FlatBox, FlatBvh};
pub use nearby::Closest;
pub(crate) use nearby::distance_to_triangle;
pub use nearest::{Nearest, RayInterval};
pub use packet_origins::{PacketOrigins, ParallelRays};
pub use ray_packet::{PacketView, RayPacket};
pub use sweep::{EightTriangles, Sweep};
pub use triangle::Ray;
