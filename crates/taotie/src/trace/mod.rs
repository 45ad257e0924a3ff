//! Rays against triangles. Finds hits, never colours.

mod bvh;
mod by_area;
mod flat;
mod hilbert;
mod nearby;
mod nearest;
mod ray_packet;
mod tree;
mod triangle;
mod walk;

pub use bvh::{Bvh, Hit};
pub use flat::{FlatBox, FlatBvh};
pub use nearby::Closest;
pub use nearest::{Nearest, RayInterval};
pub use ray_packet::{PacketView, RayPacket};
pub use triangle::Ray;
