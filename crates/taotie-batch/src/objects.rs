//! What objects say of themselves. Nothing in it depends on the machine, or on when it was made.

use crate::record::{FileEntry, Part, SCHEMA, ShortFigures};
use crate::store::entry;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use taotie::Result;
use taotie::asset::{Figures, Warning};

/// What an object says of itself.
pub trait Object: Serialize + DeserializeOwned {
    /// Returns its files, but for that which says so.
    fn files(&self) -> &[FileEntry];
    /// Returns the kind of its files.
    fn kind(&self) -> &str;

    /// Returns `true` if its figures are those of this version.
    fn is_current(&self) -> bool {
        true
    }

    /// Returns the part of an asset that it is.
    fn into_part(self, address: String, reused: bool) -> Part {
        Part { kind: self.kind().into(), address, files: self.files().to_vec(), reused }
    }
}

/// An asset with its proof.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AssetObject {
    /// `asset`.
    pub kind: String,
    /// The version of its figures, [`SCHEMA`].
    #[serde(default)]
    pub schema: u32,
    /// The version of the program.
    pub version: String,
    /// Triangles of the scan.
    pub triangles_in: usize,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// Texels across and down.
    pub size: [u32; 2],
    /// What was measured.
    pub figures: Figures,
    /// What was wrong and put right.
    pub warnings: Vec<Warning>,
    /// Its files, the model first.
    pub files: Vec<FileEntry>,
}

/// What is made of an asset's own file.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DerivedObject {
    /// What it is.
    pub kind: String,
    /// The version of the program.
    pub version: String,
    /// Its files.
    pub files: Vec<FileEntry>,
}

impl Object for AssetObject {
    fn files(&self) -> &[FileEntry] {
        &self.files
    }

    fn kind(&self) -> &str {
        &self.kind
    }

    fn is_current(&self) -> bool {
        self.schema == SCHEMA
    }
}

impl Object for DerivedObject {
    fn files(&self) -> &[FileEntry] {
        &self.files
    }

    fn kind(&self) -> &str {
        &self.kind
    }
}

impl AssetObject {
    /// Returns the figures that lists show.
    pub fn short(&self) -> ShortFigures {
        ShortFigures {
            triangles_in: self.triangles_in,
            triangles: self.triangles.clone(),
            size: self.size,
            ..ShortFigures::of(&self.figures)
        }
    }
}

impl DerivedObject {
    /// Tells of files that were written: names with paths.
    ///
    /// # Errors
    /// Those of reading them.
    pub fn of(kind: &str, files: Vec<(String, PathBuf)>) -> Result<Self> {
        let files = entries(&files)?;
        Ok(Self { kind: kind.into(), version: crate::address::VERSION.into(), files })
    }
}

/// Returns what is to be told of files that were written: names with paths.
///
/// # Errors
/// Those of reading them.
pub fn entries(files: &[(String, PathBuf)]) -> Result<Vec<FileEntry>> {
    files.iter().map(|(name, path)| entry(name, path)).collect()
}
