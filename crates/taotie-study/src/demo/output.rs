//! Where pictures go, and how large they are.

use std::path::Path;
use taotie::io::FileSet;

/// The place and size of pictures.
#[derive(Debug, Clone, Copy)]
pub struct Output<'a> {
    /// The set that the files go to.
    pub files: &'a FileSet,
    /// The folder, which must be there.
    pub folder: &'a Path,
    /// Side of each picture of a contact sheet, pixels.
    pub side: u32,
}
