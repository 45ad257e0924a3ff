//! The scans of a collection: found in folders, by patterns, and in lists, which are CSV with a header, or one JSON
//! object per line.

use super::content::Source;
use crate::record::slashed;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result, Warnings};
use taotie_io::read_bytes;
use toml::Spanned;
use walkdir::WalkDir;

/// A scan of a collection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    /// Its id in the collection, with `/` between folders.
    pub id: String,
    /// Its file, relative to the folder of the collection's file.
    pub path: PathBuf,
    /// Its title, for people.
    pub title: Option<String>,
}

/// The scans of a collection, with warnings about its lists.
#[derive(Debug, Default)]
pub struct Found {
    /// The scans, by id.
    pub scans: Vec<Scan>,
    /// Parts of lists that were ignored.
    pub warnings: Warnings,
}

/// The file extensions of models, in lower case.
const MODEL_EXTENSIONS: [&str; 5] = ["gltf", "glb", "obj", "ply", "stl"];

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
            let (scans, warnings) = read_list(&self.folder.join(path))?;
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

/// The columns that are read; all others are ignored.
const COLUMNS: [&str; 3] = ["path", "id", "title"];

/// A line of a list.
#[derive(Deserialize)]
struct Entry {
    path: String,
    id: Option<String>,
    title: Option<String>,
}

/// Reads a list; its paths are relative to its own folder.
///
/// # Errors
/// [`Error::Parse`] with the line.
fn read_list(path: &Path) -> Result<(Vec<Scan>, Warnings)> {
    let bytes = read_bytes(path)?;
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("csv") => of_csv(path, &bytes),
        Some("jsonl" | "ndjson") => of_jsonl(path, &bytes),
        _ => Err(Error::unsupported(path.display().to_string(), "lists must be .csv or .jsonl")),
    }
}

fn of_csv(path: &Path, bytes: &[u8]) -> Result<(Vec<Scan>, Warnings)> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes);
    let wrong = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        Error::parse(path, format!("line {line}"), error.to_string())
    };
    let head = reader.headers().map_err(wrong)?.clone();
    if !head.iter().any(|column| column == "path") {
        return Err(Error::parse(
            path,
            "line 1",
            "missing column `path`: the first line must name the columns",
        ));
    }
    let mut warnings = Warnings::default();
    for column in head.iter().filter(|column| !COLUMNS.contains(column)) {
        warnings.note(format!("{}: ignored unknown column `{column}`", path.display()), 1);
    }
    let entries = reader.deserialize::<Entry>().map(|entry| entry.map_err(wrong));
    let scans = entries.map(|entry| entry.map(|entry| entry.scan(path))).collect::<Result<_>>()?;
    Ok((scans, warnings))
}

fn of_jsonl(path: &Path, bytes: &[u8]) -> Result<(Vec<Scan>, Warnings)> {
    let text = String::from_utf8_lossy(bytes);
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let read = |(number, line): (usize, &str)| {
        let entry: serde_json::Result<Entry> = serde_json::from_str(line);
        entry.map(|entry| entry.scan(path)).map_err(|error| {
            Error::parse(path, format!("line {}", number + 1), format!("{error}; expected {{\"path\": …}}"))
        })
    };
    Ok((lines.map(read).collect::<Result<_>>()?, Warnings::default()))
}

impl Entry {
    fn scan(self, list: &Path) -> Scan {
        let own = list.parent().unwrap_or(Path::new("")).join(&self.path);
        let words = |text: Option<String>| text.filter(|text| !text.is_empty());
        // Drop `..` and the root: neither can be part of an id.
        let named = Path::new(&self.path).components();
        let named = named.filter(|part| matches!(part, std::path::Component::Normal(_)));
        let id = words(self.id).unwrap_or_else(|| slashed(&named.collect::<PathBuf>()));
        Scan { id, path: own, title: words(self.title) }
    }
}
