//! The models to bake.

use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// A glTF file.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Model {
    /// Its path below the given folder, starting with that folder's name, with `/` on every system.
    pub name: String,
    /// Its path.
    pub path: PathBuf,
}

impl Model {
    fn new(folder: &Path, path: PathBuf) -> Self {
        let below = path.strip_prefix(folder).unwrap_or(&path);
        let parts = folder.file_name().into_iter().chain(below.iter());
        let parts: Vec<_> = parts.map(|part| part.to_string_lossy()).collect();
        Self { name: parts.join("/"), path }
    }

    /// Returns just the file name.
    pub fn file_name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// Returns the `.gltf` and `.glb` files in the folders, sorted. With `only`, names must contain one of its texts.
///
/// # Errors
/// If a folder cannot be listed.
pub fn below(folders: &[PathBuf], only: &[String]) -> Result<Vec<Model>> {
    let mut models = Vec::new();
    for folder in folders {
        // So that `.` and `..` have names.
        let folder = folder.canonicalize().with_context(|| folder.display().to_string())?;
        let found = files(&folder)?.into_iter().filter(|path| is_gltf(path));
        models.extend(found.map(|path| Model::new(&folder, path)));
    }
    models.retain(|model| only.is_empty() || only.iter().any(|text| model.name.contains(text)));
    models.sort();
    models.dedup();
    Ok(models)
}

fn is_gltf(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| extension == "gltf" || extension == "glb")
}

fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() { found.extend(files(&path)?) } else { found.push(path) }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_found_in_subfolders_and_sorted_by_name() -> Result<()> {
        let place = tempfile::tempdir()?;
        let folder = place.path().join("shared");
        fs::create_dir_all(folder.join("b/deep"))?;
        for name in ["z.gltf", "b/deep/a b.GLB", "b/picture.png", "b/x.gltf.json"] {
            fs::write(folder.join(name), "")?;
        }
        let names = |only: &[&str]| -> Result<Vec<String>> {
            let only: Vec<String> = only.iter().map(|text| (*text).to_owned()).collect();
            Ok(below(&[folder.clone(), folder.clone()], &only)?.into_iter().map(|model| model.name).collect())
        };
        assert_eq!(names(&[])?, ["shared/b/deep/a b.GLB", "shared/z.gltf"]);
        assert_eq!(names(&["deep/"])?, ["shared/b/deep/a b.GLB"]);
        assert!(names(&["nothing"])?.is_empty());
        assert!(below(&[folder.join("gone")], &[]).is_err());
        Ok(())
    }
}
