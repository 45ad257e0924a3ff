//! The scans of a collection.

use super::content::Source;
use super::list;
use super::scan::{Found, Scan};
use crate::input::slashed;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result, Warnings};
use toml::Spanned;
use walkdir::WalkDir;

/// The file extensions of models, in lower case.
pub const MODEL_EXTENSIONS: [&str; 5] = ["gltf", "glb", "obj", "ply", "stl"];

/// A search for scans.
struct Search<'a> {
    /// The folder that paths are relative to.
    folder: &'a Path,
    /// The output folder, which is not searched.
    output: Option<PathBuf>,
    found: BTreeMap<String, Scan>,
    warnings: Warnings,
}

/// Finds the scans of all sources.
///
/// # Errors
/// [`Error::Io`] if a folder or a list does not exist; [`Error::Invalid`] if two scans have the same id, or there are
/// none.
pub fn find(sources: &[Spanned<Source>], folder: &Path, output: &Path) -> Result<Found> {
    let output = output.canonicalize().ok();
    let mut search = Search { folder, output, found: BTreeMap::new(), warnings: Warnings::default() };
    for source in sources {
        search.read(source.get_ref())?;
    }
    match search.found.is_empty() {
        true => Err(Error::invalid(
            "[[source]]",
            "no models found; models are .gltf, .glb, .obj, .ply and .stl files",
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

    /// Adds every model in a folder, at any depth; ids are relative to it.
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

    /// Adds every file that matches a pattern; ids are relative to the part of it without wildcards.
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
            return Err(Error::invalid(format!("the id `{}`", scan.id), "use names separated by /"));
        }
        let path = scan.path.clone();
        match self.found.insert(scan.id.clone(), scan) {
            Some(before) if before.path != path => Err(Error::invalid(
                format!("the id `{}`", before.id),
                format!(
                    "used by both {} and {}; set ids in a list, or use one folder above both",
                    before.path.display(),
                    path.display()
                ),
            )),
            _ => Ok(()),
        }
    }

    /// Returns true if a file is in our output folder.
    fn is_own(&self, path: &Path) -> bool {
        let inside = |output: &PathBuf| path.canonicalize().is_ok_and(|path| path.starts_with(output));
        self.output.as_ref().is_some_and(inside)
    }
}

fn not_walked(folder: &Path, error: walkdir::Error) -> Error {
    let path = error.path().unwrap_or(folder).to_path_buf();
    let cause = error.into_io_error();
    Error::io(path, cause.unwrap_or_else(|| std::io::Error::other("folder links form a loop")))
}

fn is_model(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|extension| MODEL_EXTENSIONS.contains(&extension.as_str()))
}

fn has_wildcard(part: &std::ffi::OsStr) -> bool {
    part.to_string_lossy().contains(['*', '?', '['])
}
