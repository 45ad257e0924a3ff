//! The storage of a collection's files: objects under their content addresses, and readable links to them.

use crate::objects::Object;
use crate::record::{FileEntry, Part};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result};
use taotie_io::{FileSet, read_bytes};

/// The file that marks an object as complete: it is written last.
const RESULT: &str = "object.json";

/// The part of an object's description that lists its files.
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
    /// Creates a store in a folder, which need not exist yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// Returns the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Creates the folders that all objects share.
    ///
    /// # Errors
    /// [`Error::Io`] if the system refuses.
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

    /// Returns an object's description; `None` if it is missing, incomplete, or has another version's figures.
    pub fn object<T: Object>(&self, address: &str) -> Option<T> {
        let found: T = self.described(address)?;
        (found.is_current() && are_there(&self.path(address), found.files())).then_some(found)
    }

    fn described<T: DeserializeOwned>(&self, address: &str) -> Option<T> {
        serde_json::from_slice(&read_bytes(&self.path(address).join(RESULT)).ok()?).ok()
    }

    /// Returns true if all files of a part exist with the right lengths, and the object lists them too.
    pub fn holds(&self, part: &Part) -> bool {
        let listed = |found: Listed| found.files == part.files;
        self.described(&part.address).is_some_and(listed) && are_there(&self.path(&part.address), &part.files)
    }

    /// Claims the folder of an object in a set of files; returns the folder.
    ///
    /// # Errors
    /// The errors of [`FileSet::claim_folder`].
    pub fn claim(&self, address: &str, files: &FileSet) -> Result<PathBuf> {
        let folder = self.path(address);
        if let Some(shared) = folder.parent() {
            fs::create_dir_all(shared).map_err(|e| Error::io(shared, e))?;
        }
        files.claim_folder(&folder)?;
        Ok(folder)
    }

    /// Marks an object as complete, once all its files are in place: an object without this mark is made again.
    /// `files` is a separate set, which signals can stop.
    ///
    /// # Errors
    /// Write errors.
    pub fn complete(&self, address: &str, object: &impl Object, files: &FileSet) -> Result<()> {
        let text = serde_json::to_string(object).expect("all keys are text");
        files.write_text(&self.path(address).join(RESULT), &text)?;
        files.commit()
    }

    /// Removes the remains of an object whose process was killed.
    pub fn sweep(&self, address: &str) {
        let folder = self.path(address);
        if folder.is_dir() {
            let files = FileSet::new();
            let _ = files.claim_folder(&folder);
            drop(files);
            // A folder that is not empty stays.
            let _ = fs::remove_dir(&folder);
        }
    }

    /// Creates `assets/ID/NAME` for each file: a link to the file in its object.
    ///
    /// # Errors
    /// [`Error::Io`] if the system refuses.
    pub fn link(&self, id: &str, parts: &[Part]) -> Result<()> {
        let folder = self.root.join("assets").join(id);
        fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
        // The way from assets/ID back to the root.
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

/// Creates a link atomically, replacing an earlier one.
#[cfg(unix)]
fn link(target: &str, path: &Path) -> std::io::Result<()> {
    if fs::read_link(path).is_ok_and(|there| there.as_os_str() == target) {
        return Ok(());
    }
    let temporary = path.with_file_name(format!(".taotie-link-{}", std::process::id()));
    let _ = fs::remove_file(&temporary);
    std::os::unix::fs::symlink(target, &temporary)?;
    fs::rename(&temporary, path)
}

/// Elsewhere, links need special rights; the page and the manifest name the objects themselves.
#[cfg(not(unix))]
fn link(_: &str, _: &Path) -> std::io::Result<()> {
    Ok(())
}
