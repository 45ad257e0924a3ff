//! Where a collection's files lie: objects under their content addresses, and links to them that people can read.

use crate::objects::Object;
use crate::record::{FileEntry, Part};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};
use taotie::io::{FileSet, file_size, read_bytes, sha256};
use taotie::{Error, Result};

/// The file that says that an object is complete: it is the last to be there.
const RESULT: &str = "object.json";

/// The part of an object's own words that tells of its files.
#[derive(Deserialize)]
struct Listed {
    files: Vec<FileEntry>,
}

/// The folder of a collection's files.
#[derive(Debug, Clone)]
pub struct Store {
    root: PathBuf,
}

impl Store {
    /// Takes a folder, which may not be there yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// Returns the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Makes the folders that all objects share.
    ///
    /// # Errors
    /// [`Error::Io`] where the system refuses.
    pub fn make(&self) -> Result<()> {
        let folder = self.root.join("objects");
        fs::create_dir_all(&folder).map_err(|e| Error::io(folder, e))
    }

    /// Returns the folder of an object, relative to the root.
    pub fn folder(address: &str) -> String {
        format!("objects/{}/{address}", &address[..2.min(address.len())])
    }

    /// Returns the folder of an object.
    pub fn path(&self, address: &str) -> PathBuf {
        self.root.join(Self::folder(address))
    }

    /// Returns an object's description of itself; `None` if it is missing, incomplete, or has figures of another version.
    pub fn object<T: Object>(&self, address: &str) -> Option<T> {
        let told: T = self.told(address)?;
        (told.is_current() && are_there(&self.path(address), told.files())).then_some(told)
    }

    fn told<T: DeserializeOwned>(&self, address: &str) -> Option<T> {
        serde_json::from_slice(&read_bytes(&self.path(address).join(RESULT)).ok()?).ok()
    }

    /// Says whether all files of a part are there, each with its length, and the object says so itself.
    pub fn holds(&self, part: &Part) -> bool {
        let is_told = |told: Listed| told.files == part.files;
        self.told(&part.address).is_some_and(is_told) && are_there(&self.path(&part.address), &part.files)
    }

    /// Claims the place of an object in a set of files; returns its folder.
    ///
    /// # Errors
    /// Those of [`FileSet::claim_folder`].
    pub fn claim(&self, address: &str, files: &FileSet) -> Result<PathBuf> {
        let folder = self.path(address);
        if let Some(shared) = folder.parent() {
            fs::create_dir_all(shared).map_err(|e| Error::io(shared, e))?;
        }
        files.claim_folder(&folder)?;
        Ok(folder)
    }

    /// Says that an object is complete, once all its files are in their places: what is there without this is made anew.
    /// `files` is a set of its own, which signals stop.
    ///
    /// # Errors
    /// Those of writing.
    pub fn tell(&self, address: &str, object: &impl Object, files: &FileSet) -> Result<()> {
        let text = serde_json::to_string(object).expect("all keys are text");
        files.write_text(&self.path(address).join(RESULT), &text)?;
        files.commit()
    }

    /// Removes what a process that was killed left of an object.
    pub fn sweep(&self, address: &str) {
        let folder = self.path(address);
        if folder.is_dir() {
            let files = FileSet::new();
            let _ = files.claim_folder(&folder);
            drop(files);
            // One that holds anything stays.
            let _ = fs::remove_dir(&folder);
        }
    }

    /// Makes `assets/ID/NAME` for each file: a link to it in its object.
    ///
    /// # Errors
    /// [`Error::Io`] where the system refuses.
    pub fn link(&self, id: &str, parts: &[Part]) -> Result<()> {
        let folder = self.root.join("assets").join(id);
        fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
        // From assets/ID back to the root.
        let up = "../".repeat(1 + id.split('/').count());
        let files = parts.iter().flat_map(|part| part.files.iter().map(move |file| (part, file)));
        for (part, file) in files.filter(|(_, file)| !file.name.contains('/')) {
            let target = format!("{up}{}/{}", Self::folder(&part.address), file.name);
            link(&target, &folder.join(&file.name)).map_err(|e| Error::io(folder.join(&file.name), e))?;
        }
        Ok(())
    }
}

fn are_there(folder: &Path, files: &[FileEntry]) -> bool {
    files
        .iter()
        .all(|file| fs::metadata(folder.join(&file.name)).is_ok_and(|about| about.len() == file.bytes))
}

/// Makes a link in one step, in place of an earlier one.
#[cfg(unix)]
fn link(target: &str, path: &Path) -> std::io::Result<()> {
    if fs::read_link(path).is_ok_and(|there| there.as_os_str() == target) {
        return Ok(());
    }
    let beside = path.with_file_name(format!(".taotie-link-{}", std::process::id()));
    let _ = fs::remove_file(&beside);
    std::os::unix::fs::symlink(target, &beside)?;
    fs::rename(&beside, path)
}

/// Links need rights elsewhere; the page and the manifest name the objects themselves.
#[cfg(not(unix))]
fn link(_: &str, _: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Returns what is to be told of a file that was written.
///
/// # Errors
/// Those of reading.
pub fn entry(name: &str, path: &Path) -> Result<FileEntry> {
    Ok(FileEntry { name: name.into(), bytes: file_size(path)?, sha256: sha256(path)? })
}
