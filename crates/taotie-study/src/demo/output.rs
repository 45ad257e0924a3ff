//! The location and size of pictures.

use std::path::Path;
use taotie_io::FileSet;

/// The location and size of pictures.
#[derive(Debug, Clone, Copy)]
pub struct Output<'a> {
    /// The file set that the files belong to.
    pub files: &'a FileSet,
    /// The folder, which must exist.
    pub folder: &'a Path,
    /// The side of each picture on a contact sheet, pixels.
    pub side: u32,
}
