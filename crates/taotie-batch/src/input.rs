//! The files that an asset is made from.

use crate::settings::AssetSettings;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use taotie::asset::Limits;
use taotie_engine::{Error, Result};
use taotie_io::{load_model_within, sha256};

/// A file that an asset is made from.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its name, relative to the folder of the file that references it.
    pub name: String,
    /// Its path, relative to the folder of the collection's file.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// The time of its last change, nanoseconds since 1970.
    pub modified: u64,
    /// The SHA-256 of its bytes, hexadecimal; empty if it has not been read yet.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sha256: String,
}

impl InputFile {
    /// Queries a file's metadata, without reading it.
    ///
    /// # Errors
    /// [`Error::Io`] if it does not exist.
    pub fn stat(path: &Path) -> Result<Self> {
        let about = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
        let since = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let modified = since.map_or(0, |since| since.as_nanos() as u64);
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, path: path.to_path_buf(), bytes: about.len(), modified, sha256: String::new() })
    }

    /// Reads a file to hash it; its name is relative to `folder` if it is inside it.
    fn read(path: &Path, folder: &Path) -> Result<Self> {
        let known = Self::stat(path)?;
        let name = path.strip_prefix(folder).map_or(known.name, slashed);
        Ok(Self { name, sha256: sha256(path)?, ..known })
    }

    /// Returns true if the file is unchanged, judging by its size and modification time.
    pub fn is_unchanged(&self, folder: &Path) -> bool {
        Self::stat(&folder.join(&self.path))
            .is_ok_and(|now| (now.bytes, now.modified) == (self.bytes, self.modified))
    }
}

/// Reads all files that an asset is made from: those of the scan, in order, then all that its settings name.
///
/// # Errors
/// Read errors.
pub fn read(scan: &[PathBuf], settings: &AssetSettings, limits: &Limits) -> Result<Vec<InputFile>> {
    let mut files = of_model(scan)?;
    for mesh in settings.meshes() {
        let mut others = load_model_within(mesh, limits)?.files;
        others.retain(|other| other != mesh);
        others.sort();
        others.dedup();
        files.extend(of_model(&[vec![mesh.to_path_buf()], others].concat())?);
    }
    if let Some(path) = &settings.packing.provenance {
        files.extend(of_model(std::slice::from_ref(path))?);
    }
    Ok(files)
}

fn of_model(files: &[PathBuf]) -> Result<Vec<InputFile>> {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    files.iter().map(|file| InputFile::read(file, folder)).collect()
}

/// Returns a relative path with `/` as the separator, on every system.
pub fn slashed(path: &Path) -> String {
    let parts = path.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
    parts.collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_files_of_a_model_are_read_and_a_change_is_seen() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        std::fs::create_dir(path("maps")).unwrap();
        std::fs::write(path("a.obj"), "v").unwrap();
        std::fs::write(path("maps/a.png"), "p").unwrap();
        let files = [path("a.obj"), path("maps/a.png")];
        let read = read(&files, &AssetSettings::default(), &Limits::default()).unwrap();
        let names: Vec<_> = read.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["a.obj", "maps/a.png"]);
        assert!(read.iter().all(|file| file.sha256.len() == 64 && file.is_unchanged(Path::new(""))));
        std::fs::write(path("a.obj"), "vv").unwrap();
        assert!(!read[0].is_unchanged(Path::new("")) && read[1].is_unchanged(Path::new("")));
        std::fs::remove_file(path("maps/a.png")).unwrap();
        assert!(!read[1].is_unchanged(Path::new("")));
    }
}
