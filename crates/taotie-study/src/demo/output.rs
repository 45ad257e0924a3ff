//! Where pictures go, and how large they are.

use std::path::Path;

/// The place and size of pictures.
#[derive(Debug, Clone, Copy)]
pub struct Output<'a> {
    /// The folder, which must be there.
    pub folder: &'a Path,
    /// Side of each picture of a contact sheet, pixels.
    pub side: u32,
}
