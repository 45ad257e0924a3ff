//! The pixel program of `taotie_engine::pixel`, recorded for a variant.

mod frames;
mod inputs;
mod lookups;
mod points;
mod program;
mod shapes;
mod stages;
mod values;

pub use program::PixelProgram;
pub(crate) use program::reads;
