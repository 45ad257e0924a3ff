//! A file of the output folder.

/// A file by its name in the folder.
pub struct NamedFile {
    /// Its name.
    pub name: String,
    /// Its whole content.
    pub bytes: Vec<u8>,
}

impl NamedFile {
    /// Makes a file.
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}
