//! Rays against triangles. Finds hits, never colours.

mod bvh;
mod triangle;

pub use bvh::{Bvh, Hit};
pub use triangle::Ray;
