//! A sound file, with the files that it references; and those of a user's folder.

use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

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

/// The largest file that is used, and the most bytes of all its companion files together.
const LARGEST: u64 = 1 << 20;

/// Returns the files in `folder`, at any depth, that are small enough, each with the files next to it; sorted by
/// name.
///
/// # Errors
/// If a file or folder cannot be read.
pub fn seeds_in(folder: &Path) -> Result<Vec<Seed>> {
    let mut paths = Vec::new();
    list(folder, &mut paths)?;
    paths.sort();
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        let bytes = fs::read(path).with_context(|| path.display().to_string())?;
        Ok(Seed { name, bytes, companions: companions(path, &paths)? })
    };
    paths.iter().map(read).collect()
}

/// Lists the files in `folder`, at any depth, that are small enough.
fn list(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries =
        fs::read_dir(folder).with_context(|| format!("{}: could not be listed", folder.display()))?;
    for entry in entries {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            list(&entry.path(), paths)?;
        } else if entry.metadata()?.len() <= LARGEST {
            paths.push(entry.path());
        }
    }
    Ok(())
}

/// Returns the files next to the model `path`, up to a total size; none for formats that do not reference files.
fn companions(path: &Path, all: &[PathBuf]) -> Result<Vec<File>> {
    let names_files = path.extension().is_some_and(|e| e == "gltf" || e == "obj" || e == "ply");
    let mut left = LARGEST as usize;
    let mut files = Vec::new();
    for other in all.iter().filter(|other| names_files && *other != path && other.parent() == path.parent()) {
        let bytes = fs::read(other).with_context(|| other.display().to_string())?;
        if let Some(rest) = left.checked_sub(bytes.len()) {
            left = rest;
            let name = other.file_name().unwrap_or_default().to_string_lossy().into_owned();
            files.push(File { name, bytes });
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_files_are_taken_with_those_beside_models() {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir(place.path().join("m")).unwrap();
        for (name, length) in
            [("m/a.gltf", 3), ("m/a.bin", 5), ("b.png", 7), ("large.png", LARGEST as usize + 1)]
        {
            fs::write(place.path().join(name), vec![0; length]).unwrap();
        }
        let seeds = seeds_in(place.path()).unwrap();
        let names: Vec<&str> = seeds.iter().map(|seed| seed.name.as_str()).collect();
        assert_eq!(names, ["b.png", "m/a.bin", "m/a.gltf"]);
        let counts: Vec<usize> = seeds.iter().map(|seed| seed.companions.len()).collect();
        assert_eq!(counts, [0, 0, 1]);
        assert!(seeds_in(&place.path().join("none")).is_err());
    }
}
