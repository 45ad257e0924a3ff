//! Rays against triangles. Finds hits, never colours.

mod bvh;
mod hilbert;
mod nearby;
mod nearest;
mod sheaf;
mod tree;
mod triangle;
mod walk;

pub use bvh::{Bvh, Hit};
pub use nearby::Closest;
pub use nearest::{Nearest, Stretch};
pub use sheaf::{Sheaf, SheafView};
pub use triangle::Ray;
