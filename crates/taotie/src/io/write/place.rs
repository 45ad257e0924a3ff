//! Rejects paths that must not be written to: folders, devices, and inputs.

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

/// Rejects anything that cannot be replaced by a file: folders, devices, pipes.
pub(super) fn refuse_special(path: &Path) -> Result<()> {
    let why = match fs::metadata(path) {
        Ok(about) if about.is_dir() => "expected a file, found a folder",
        Ok(about) if !about.is_file() => "not a regular file; choose another name",
        _ => return Ok(()),
    };
    Err(Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, why)))
}

/// Rejects overwriting an input.
pub(super) fn refuse_read(target: &Path, sources: &[PathBuf]) -> Result<()> {
    if !target.is_file() {
        return Ok(());
    }
    let is_target = |source: &&PathBuf| source.is_file() && is_same_file(target, source).unwrap_or(false);
    let Some(source) = sources.iter().find(is_target) else { return Ok(()) };
    let (target, source) = (target.display(), source.display());
    let why = format!("it would overwrite the input {source}; choose another name or folder");
    Err(Error::invalid(target.to_string(), why))
}
