//! Rays against triangles. Finds hits, never colours.

mod bvh;
mod hilbert;
mod nearby;
mod shortlist;
mod tree;
mod triangle;
mod walk;

pub use bvh::{Bvh, Hit};
pub use nearby::Closest;
pub use shortlist::Shortlist;
pub use triangle::Ray;
