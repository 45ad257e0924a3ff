//! The scans of a collection.

use super::Found;
use super::content::Source;
use super::list;
use crate::input::slashed;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie::{Error, Result, Warnings};
use toml::Spanned;
use walkdir::WalkDir;

/// The extensions of files that are models, in lower case.
pub const MODEL_EXTENSIONS: [&str; 5] = ["gltf", "glb", "obj", "ply", "stl"];

/// A scan of a collection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    /// Its name in the collection, with `/` between folders.
    pub id: String,
    /// Its file, relative to the folder of the collection's file.
    pub path: PathBuf,
    /// What people call it.
    pub title: Option<String>,
}

/// A way to look for scans.
struct Search<'a> {
    /// The folder that paths start from.
    folder: &'a Path,
    /// The folder that is written to, in which nothing is looked for.
    output: Option<PathBuf>,
    found: BTreeMap<String, Scan>,
    warnings: Warnings,
}

/// Looks for the scans of all sources.
///
/// # Errors
/// [`Error::Io`] where a folder or a list is not there; [`Error::Invalid`] where two scans have one id, or there is none.
pub fn find(sources: &[Spanned<Source>], folder: &Path, output: &Path) -> Result<Found> {
    let output = output.canonicalize().ok();
    let mut search = Search { folder, output, found: BTreeMap::new(), warnings: Warnings::default() };
    for source in sources {
        search.read(source.get_ref())?;
    }
    match search.found.is_empty() {
        true => Err(Error::invalid(
            "[[source]]",
            "no model is found; models are .gltf, .glb, .obj, .ply and .stl",
        )),
        false => Ok(Found { scans: search.found.into_values().collect(), warnings: search.warnings }),
    }
}

impl Search<'_> {
    fn read(&mut self, source: &Source) -> Result<()> {
        if let Some(folder) = &source.folder {
            self.read_folder(&self.folder.join(folder))?;
        }
        if let Some(pattern) = &source.glob {
            self.read_glob(pattern)?;
        }
        if let Some(path) = &source.list {
            let (scans, warnings) = list::read(&self.folder.join(path))?;
            self.warnings.absorb(warnings);
            scans.into_iter().try_for_each(|scan| self.add(scan))?;
        }
        Ok(())
    }

    /// Takes every model below a folder; ids are relative to it.
    fn read_folder(&mut self, folder: &Path) -> Result<()> {
        for entry in WalkDir::new(folder).follow_links(true).sort_by_file_name() {
            let entry = entry.map_err(|error| not_walked(folder, error))?;
            if entry.file_type().is_file() && is_model(entry.path()) && !self.is_own(entry.path()) {
                let id = slashed(entry.path().strip_prefix(folder).unwrap_or(entry.path()));
                self.add(Scan { id, path: entry.into_path(), title: None })?;
            }
        }
        Ok(())
    }

    /// Takes every file that matches a pattern; ids are relative to the part of it that has no wildcard.
    fn read_glob(&mut self, pattern: &str) -> Result<()> {
        let whole = self.folder.join(pattern);
        let fixed: PathBuf = whole.components().take_while(|part| !has_wildcard(part.as_os_str())).collect();
        let root = if fixed.is_file() { fixed.parent().unwrap_or(Path::new("")) } else { &fixed };
        let wrong = |error: glob::PatternError| Error::invalid(format!("glob {pattern}"), error.to_string());
        let paths = glob::glob(&whole.to_string_lossy()).map_err(wrong)?;
        for path in paths {
            let path = path.map_err(|error| Error::Io { path: error.path().into(), cause: error.into() })?;
            if path.is_file() && is_model(&path) && !self.is_own(&path) {
                let id = slashed(path.strip_prefix(root).unwrap_or(&path));
                self.add(Scan { id, path, title: None })?;
            }
        }
        Ok(())
    }

    fn add(&mut self, mut scan: Scan) -> Result<()> {
        if let Ok(path) = scan.path.strip_prefix(self.folder) {
            scan.path = path.to_path_buf();
        }
        if scan.id.split('/').any(|part| matches!(part, "" | "." | "..")) || scan.id.contains('\\') {
            return Err(Error::invalid(format!("the id `{}`", scan.id), "write names with / between them"));
        }
        let path = scan.path.clone();
        match self.found.insert(scan.id.clone(), scan) {
            Some(before) if before.path != path => Err(Error::invalid(
                format!("the id `{}`", before.id),
                format!(
                    "both {} and {} have it; give ids in a list, or name one folder above both",
                    before.path.display(),
                    path.display()
                ),
            )),
            _ => Ok(()),
        }
    }

    /// Says whether a file was written by us.
    fn is_own(&self, path: &Path) -> bool {
        let inside = |output: &PathBuf| path.canonicalize().is_ok_and(|path| path.starts_with(output));
        self.output.as_ref().is_some_and(inside)
    }
}

fn not_walked(folder: &Path, error: walkdir::Error) -> Error {
    let path = error.path().unwrap_or(folder).to_path_buf();
    let cause = error.into_io_error();
    Error::io(path, cause.unwrap_or_else(|| std::io::Error::other("folders link to one another in a circle")))
}

fn is_model(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|extension| MODEL_EXTENSIONS.contains(&extension.as_str()))
}

fn has_wildcard(part: &std::ffi::OsStr) -> bool {
    part.to_string_lossy().contains(['*', '?', '['])
}
