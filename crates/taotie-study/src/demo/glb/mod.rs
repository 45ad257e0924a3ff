//! The vessel as GLB files, their textures beside them as [`super::export`] writes them.

mod draft;
mod high;
mod pouring;

pub use high::write as write_high;
pub use pouring::write as write_pouring;
