//! The file that a target reads.

use std::path::Path;

/// A damaged file on disk.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The file.
    pub path: &'a Path,
    /// Its content.
    pub bytes: &'a [u8],
    /// The seed for the options of later steps.
    pub variant: u64,
}
