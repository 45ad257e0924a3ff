//! A sound file, with the files that it references.

/// A sound file.
#[derive(Debug, Clone)]
pub struct Seed {
    /// Its name, by which findings refer to it; the extension decides which targets take it.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
    /// The files that it references.
    pub companions: Vec<File>,
}

/// A file referenced by another.
#[derive(Debug, Clone)]
pub struct File {
    /// Its name without the folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl Seed {
    /// Creates a file that references no other.
    pub(super) fn single(name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.to_owned(), bytes: bytes.into(), companions: Vec::new() }
    }

    /// Returns the extension, in lower case.
    pub fn extension(&self) -> String {
        self.name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase()
    }

    /// Returns the name without folders.
    pub fn file_name(&self) -> &str {
        self.name.rsplit('/').next().unwrap_or_default()
    }
}
