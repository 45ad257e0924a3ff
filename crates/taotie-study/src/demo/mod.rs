//! The demo's files: the vessel as models, its pictures by every surface method and shading model, the methods
//! measured against its relief as geometry, and the figures for pouring.
//!
//! ```no_run
//! use std::path::Path;
//! use taotie_io::FileSet;
//! use taotie_study::demo::{Output, Vessel, export, gallery};
//!
//! let (vessel, files) = (Vessel::new(2048), FileSet::new());
//! let output = Output { files: &files, folder: Path::new("."), side: 360 };
//! export::write(&output, &vessel)?;
//! let (sheet, pictures) = gallery::write_sheet(&vessel, &output, &|_done| ())?;
//! assert_eq!(pictures.len(), 16);
//! files.commit()?;
//! # Ok::<(), taotie_engine::Error>(())
//! ```

pub mod export;
pub mod gallery;
pub mod glb;
pub mod moving;
mod output;
pub mod stage;
pub mod truth;
mod vessel;

pub use output::Output;
pub use vessel::Vessel;
