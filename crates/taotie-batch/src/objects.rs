//! The descriptions stored with objects. Nothing in them depends on the machine or on when they were made.

use crate::record::{FileEntry, Part, SCHEMA, ShortFigures};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use taotie::asset::{Figures, Warning};
use taotie_engine::Result;

/// The description stored with an object.
pub trait Object: Serialize + DeserializeOwned {
    /// Returns its files, excluding the description itself.
    fn files(&self) -> &[FileEntry];
    /// Returns the kind of its files.
    fn kind(&self) -> &str;

    /// Returns `true` if its figures are those of this version.
    fn is_current(&self) -> bool {
        true
    }

    /// Converts it to a part of an asset.
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
    /// The measured figures.
    pub figures: Figures,
    /// Faults that were fixed.
    pub warnings: Vec<Warning>,
    /// Its files, the model first.
    pub files: Vec<FileEntry>,
}

/// A file derived from an asset's own files.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DerivedObject {
    /// Its kind.
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
    /// Returns the figures shown in lists.
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
    /// Describes files that have been written, given as names and paths.
    ///
    /// # Errors
    /// Read errors.
    pub fn of(kind: &str, files: Vec<(String, PathBuf)>) -> Result<Self> {
        let files = entries(&files)?;
        Ok(Self { kind: kind.into(), version: crate::address::VERSION.into(), files })
    }
}

/// Describes files that have been written, given as names and paths.
///
/// # Errors
/// Read errors.
pub fn entries(files: &[(String, PathBuf)]) -> Result<Vec<FileEntry>> {
    files.iter().map(|(name, path)| FileEntry::of(name, path)).collect()
}
