//! The files covered by a certificate, with the hashes of their bytes.

use super::scan::{About, all_files};
use super::write::WrittenAsset;
use crate::error::Result;
use crate::io::{self, Limits, StoredImage, StoredParts};
use std::path::Path;

/// A file with the hash of its bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HashedFile {
    /// Its name, without folders.
    pub name: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// The SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A map of an asset with the hash of its bytes as stored: those of the PNG, WebP, JPEG or KTX2 file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct HashedMap {
    /// Its use, such as `normal`.
    pub uses: String,
    /// Its file, without folders; `None` if it is in the model file.
    pub file: Option<String>,
    /// Its length in bytes; `None` if the file was missing.
    pub bytes: Option<u64>,
    /// The SHA-256 of its bytes, hexadecimal; `None` if the file was missing.
    pub sha256: Option<String>,
}

/// An asset's files and maps.
#[derive(Debug, Clone, Default)]
pub(super) struct AssetFiles {
    /// The model file first; without the maps.
    pub files: Vec<HashedFile>,
    pub maps: Vec<HashedMap>,
}

impl HashedFile {
    fn read(path: &Path) -> Result<Self> {
        Ok(Self { name: name_of(path), bytes: io::file_size(path)?, sha256: io::sha256(path)? })
    }

    /// Reads the files of a scan, the model file first; empty for a scan in memory.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if one cannot be read.
    pub(super) fn of_scan(about: &About) -> Result<Vec<Self>> {
        let Some((own, others)) = about.files.split_first() else { return Ok(Vec::new()) };
        let own = Self { name: name_of(own), bytes: io::file_size(own)?, sha256: about.sha256()? };
        std::iter::once(Ok(own)).chain(others.iter().map(|file| Self::read(file))).collect()
    }
}

impl HashedMap {
    fn read(uses: String, path: &Path) -> Result<Self> {
        let found = path.is_file().then(|| HashedFile::read(path)).transpose()?;
        let (bytes, sha256) = found.map(|found| (found.bytes, found.sha256)).unzip();
        Ok(Self { uses, file: Some(name_of(path)), bytes, sha256 })
    }
}

impl From<StoredImage> for HashedMap {
    fn from(image: StoredImage) -> Self {
        let (bytes, sha256) = image.bytes.unzip();
        let file = image.file.as_deref().map(name_of);
        Self { uses: image.uses.join(", "), file, bytes, sha256 }
    }
}

impl AssetFiles {
    /// Reads and hashes the files of a model.
    ///
    /// # Errors
    /// Those of reading them.
    pub fn of_model(path: &Path, limits: &Limits) -> Result<Self> {
        if !io::is_gltf(path)? {
            let mut others = io::load_model_within(path, limits)?.files;
            let files = all_files(path, &mut others);
            let files = files.iter().map(|file| HashedFile::read(file)).collect::<Result<_>>()?;
            return Ok(Self { files, maps: Vec::new() });
        }
        let StoredParts { mut buffers, images, maps_beside } = StoredParts::read(path, limits)?;
        let files = all_files(path, &mut buffers);
        let separate = maps_beside.into_iter().map(|(uses, file)| HashedMap::read(uses, &file));
        Ok(Self {
            files: files.iter().map(|file| HashedFile::read(file)).collect::<Result<_>>()?,
            maps: images
                .into_iter()
                .map(|image| Ok(HashedMap::from(image)))
                .chain(separate)
                .collect::<Result<_>>()?,
        })
    }

    /// Hashes the files of a written asset, or standalone maps with their low-poly mesh.
    ///
    /// # Errors
    /// Those of reading them.
    pub fn of_written(written: &WrittenAsset) -> Result<Self> {
        if !written.is_alone() {
            return Self::of_model(&written.current(), &Limits::of_own_files());
        }
        let low = written.asset.made.low_files.iter().map(|file| HashedFile::read(file));
        let map = |note: super::map_note::MapNote| {
            let file = note.file.unwrap_or_default();
            let map =
                HashedMap::read(crate::names::Named::name(note.map).to_owned(), &written.set.current(&file))?;
            Ok(HashedMap { file: Some(name_of(&file)), ..map })
        };
        Ok(Self {
            files: low.collect::<Result<_>>()?,
            maps: written.maps().into_iter().map(map).collect::<Result<_>>()?,
        })
    }
}

/// Returns the name of a file without its folders, which are private and differ between machines.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Serializes paths to JSON without their folders.
#[cfg(feature = "serde")]
pub(super) mod named {
    use super::name_of;
    use serde::{Serialize, Serializer};
    use std::path::{Path, PathBuf};

    /// Writes an optional path.
    pub fn option<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
        path.as_deref().map(name_of).serialize(serializer)
    }

    /// Writes a list of paths.
    pub fn list<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(paths.iter().map(|path: &PathBuf| name_of(Path::new(path))))
    }
}
