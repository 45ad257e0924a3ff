//! Places that a file may not be written to: folders, devices, and files that were read.

use crate::error::{Error, Result};
use same_file::is_same_file;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Returns the folder that a file is in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Refuses what cannot be replaced by a file: folders, devices, pipes.
pub(super) fn refuse_special(path: &Path) -> Result<()> {
    let why = match fs::metadata(path) {
        Ok(about) if about.is_dir() => "it is a folder; give a file name",
        Ok(about) if !about.is_file() => "it is not a regular file; give another name",
        _ => return Ok(()),
    };
    Err(Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, why)))
}

/// Refuses to write a file that was read.
pub(super) fn refuse_read(target: &Path, sources: &[PathBuf]) -> Result<()> {
    if !target.is_file() {
        return Ok(());
    }
    let is_target = |source: &&PathBuf| source.is_file() && is_same_file(target, source).unwrap_or(false);
    let Some(source) = sources.iter().find(is_target) else { return Ok(()) };
    let (target, source) = (target.display(), source.display());
    let why = format!("it would be written over {source}, which is read; give another name or folder");
    Err(Error::invalid(target.to_string(), why))
}
