//! Between heavy and light: which point of a heavy surface a point of a light one stands for.

mod corners;
mod projection;
mod uv_lookup;

pub use projection::{Match, Projector};
pub use uv_lookup::UvLookup;
