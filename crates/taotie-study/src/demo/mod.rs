//! The demo's files: the vessel as models, its pictures by every surface method and shading model, and the figures of
//! its pouring.

pub mod export;
pub mod gallery;
pub mod glb;
pub mod moving;
mod output;
pub mod stage;
mod vessel;

pub use output::Output;
pub use vessel::Vessel;
