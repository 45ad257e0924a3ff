//! The vessel as GLB files, with the texture files written by [`super::export`] next to them.

mod draft;
mod high;
mod pouring;

pub use high::write as write_high;
pub use pouring::write as write_pouring;
