//! The source of a glTF file.

use crate::error::Result;
use crate::io::reading::Reading;
use std::borrow::Cow;
use std::path::Path;

/// The source of a glTF file.
#[derive(Debug, Clone, Copy)]
pub enum GltfSource<'a> {
    /// A file, `.gltf` or `.glb`.
    File(&'a Path),
    /// The bytes of a GLB that refers to no files.
    Glb(&'a [u8]),
}

impl<'a> GltfSource<'a> {
    /// Returns its path, or a path to no file for bytes.
    pub(in crate::io) fn path(self) -> &'a Path {
        match self {
            Self::File(path) => path,
            Self::Glb(_) => Path::new("a.glb"),
        }
    }

    /// Returns the bytes of the file itself.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if it cannot be read, [`crate::Error::Limit`] if it does not fit in memory.
    pub(super) fn bytes(self, reading: &Reading) -> Result<Cow<'a, [u8]>> {
        match self {
            Self::File(path) => reading.read_own(path).map(Cow::Owned),
            Self::Glb(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}
