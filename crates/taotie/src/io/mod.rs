//! Reading models and pictures: the one module that touches paths.

mod bitmap;
mod obj;
mod ply;
mod polygon;
mod stl;
mod text;

pub use bitmap::read_bitmap;

use crate::error::{Error, Result, Warnings};
use crate::scene::Scene;
use std::path::Path;

/// What a model file held.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What was wrong but could still be drawn.
    pub warnings: Warnings,
    /// The name of the format.
    pub format: &'static str,
}

/// Reads a model, whose format follows from the file name's extension.
///
/// # Errors
/// [`Error::Io`], [`Error::Parse`], [`Error::Limit`] or [`Error::Unsupported`], each naming the file.
pub fn read_model(path: &Path) -> Result<Loaded> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "obj" => obj::read(path),
        "ply" => ply::read(path),
        "stl" => stl::read(path),
        _ => Err(Error::unsupported(path.display().to_string(), "give a .obj, .ply or .stl file")),
    }
}
