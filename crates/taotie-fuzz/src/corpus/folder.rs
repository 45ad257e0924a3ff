//! Files of a folder that is given.

use super::{File, Seed};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// The largest file that is taken, and the most bytes of all files beside it.
const LARGEST: u64 = 1 << 20;

/// Returns the files below `folder` that are small enough, each with those beside it in its own folder; by name.
///
/// # Errors
/// Where a file or folder cannot be read.
pub fn seeds(folder: &Path) -> Result<Vec<Seed>> {
    let mut paths = Vec::new();
    list(folder, &mut paths)?;
    paths.sort();
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        let bytes = fs::read(path).with_context(|| path.display().to_string())?;
        Ok(Seed { name, bytes, beside: beside(path, &paths)? })
    };
    paths.iter().map(read).collect()
}

/// Lists the files below `folder` that are small enough.
fn list(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<()> {
    let entries = fs::read_dir(folder).with_context(|| format!("{}: cannot be listed", folder.display()))?;
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

/// The files in the folder of the model `path`, as far as they are small together; none beside what names no file.
fn beside(path: &Path, all: &[PathBuf]) -> Result<Vec<File>> {
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
        let seeds = seeds(place.path()).unwrap();
        let names: Vec<&str> = seeds.iter().map(|seed| seed.name.as_str()).collect();
        assert_eq!(names, ["b.png", "m/a.bin", "m/a.gltf"]);
        let beside: Vec<usize> = seeds.iter().map(|seed| seed.beside.len()).collect();
        assert_eq!(beside, [0, 0, 1]);
        assert!(super::seeds(&place.path().join("none")).is_err());
    }
}
