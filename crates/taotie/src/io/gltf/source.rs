//! The place that a glTF file is taken from.

use crate::error::Result;
use crate::io::file;
use std::borrow::Cow;
use std::path::Path;

/// The place that a glTF file is taken from.
#[derive(Debug, Clone, Copy)]
pub enum GltfSource<'a> {
    /// A file, `.gltf` or `.glb`.
    File(&'a Path),
    /// The bytes of a GLB, which names no files.
    Glb(&'a [u8]),
}

impl<'a> GltfSource<'a> {
    /// Returns its path, that of no file for bytes.
    pub(super) fn path(self) -> &'a Path {
        match self {
            Self::File(path) => path,
            Self::Glb(_) => Path::new("a.glb"),
        }
    }

    /// Returns the bytes of the file itself.
    ///
    /// # Errors
    /// [`crate::Error::Io`] where it cannot be read.
    pub(super) fn bytes(self) -> Result<Cow<'a, [u8]>> {
        match self {
            Self::File(path) => file::read(path).map(Cow::Owned),
            Self::Glb(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}
