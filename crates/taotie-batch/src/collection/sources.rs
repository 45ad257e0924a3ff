//! The objects of a collection, scans and folders of photographs: found in folders, by patterns, and in lists, which are
//! CSV with a header, or one JSON object per line.

use super::content::{Override, Source};
use crate::record::slashed;
use glob::Pattern;
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result, Warnings};
use taotie_io::read_bytes;
use taotie_photometric::{Relightable, is_photograph, marks_photographs};
use toml::Spanned;
use walkdir::{DirEntry, WalkDir};

/// The kind of an object, which determines what is made of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A scan, which is baked.
    Scan,
    /// Photographs under changing light, from which normals are estimated.
    Photographs,
}

/// An object of a collection: a scan, or photographs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    /// Its id in the collection, with `/` between folders.
    pub id: String,
    /// Its kind.
    pub kind: Kind,
    /// Its file, or the folder of photographs, relative to the folder of the collection's file.
    pub path: PathBuf,
    /// Its title, for people.
    pub title: Option<String>,
}

/// The objects of a collection, with warnings about its lists.
#[derive(Debug, Default)]
pub struct Found {
    /// The objects, by id.
    pub scans: Vec<Scan>,
    /// Parts of lists that were ignored.
    pub warnings: Warnings,
}

/// The file extensions of models, in lower case.
const MODEL_EXTENSIONS: [&str; 6] = ["gltf", "glb", "obj", "ply", "stl", "fbx"];

/// Why a link is not followed.
const LOOP: &str = "the link leads back to a folder above it";

/// A search for scans.
struct Search<'a> {
    /// The folder that paths are relative to.
    folder: &'a Path,
    /// The output folder, which is not searched.
    output: Option<PathBuf>,
    found: BTreeMap<String, Scan>,
    /// The ids in lower case, and as they are.
    folded: HashMap<String, String>,
    warnings: Warnings,
}

/// The files below a folder that belong to a source.
struct Below<'a> {
    root: &'a Path,
    /// The number of folder levels to search.
    depth: usize,
    /// Decides by the path below the root, with `/` between folders.
    is_wanted: &'a dyn Fn(&str) -> bool,
    /// The files that mark an object.
    marks: Marks,
}

/// The files that mark an object.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Marks {
    /// Models, and files of lights, which mark their folder.
    ModelsAndLights,
    /// Images, which mark their folder.
    Images,
}

/// Finds the scans of all sources.
///
/// # Errors
/// [`Error::Io`] if a folder or a list does not exist; [`Error::Invalid`] if the ids of two scans are equal or differ
/// only in case, or there are none.
pub fn find(sources: &[Spanned<Source>], folder: &Path, output: &Path) -> Result<Found> {
    let output = output.canonicalize().ok();
    let (found, folded) = (BTreeMap::new(), HashMap::new());
    let mut search = Search { folder, output, found, folded, warnings: Warnings::default() };
    for source in sources {
        search.read(source.get_ref())?;
    }
    match search.found.is_empty() {
        true => Err(Error::invalid(
            "[[source]]",
            "no models and no photographs found; models are .gltf, .glb, .obj, .ply, .stl and .fbx files, photographs are in \
             folders with an .lp file or light_directions.txt, or below a source with the key `photographs`",
        )),
        false => Ok(Found { scans: search.found.into_values().collect(), warnings: search.warnings }),
    }
}

impl Search<'_> {
    fn read(&mut self, source: &Source) -> Result<()> {
        if let Some(folder) = &source.folder {
            let root = self.folder.join(folder);
            let marks = Marks::ModelsAndLights;
            self.read_below(Below { root: &root, depth: usize::MAX, is_wanted: &|_| true, marks })?;
        }
        if let Some(folder) = &source.photographs {
            let root = self.folder.join(folder);
            let marks = Marks::Images;
            self.read_below(Below { root: &root, depth: usize::MAX, is_wanted: &|_| true, marks })?;
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

    /// Adds every object below a folder; ids are relative to it. Links that lead nowhere are scans that cannot be read if
    /// they have a model's name; anything else that cannot be read is skipped with a warning.
    fn read_below(&mut self, Below { root, depth, is_wanted, marks }: Below<'_>) -> Result<()> {
        let output = self.output.clone();
        let is_own = |path: &Path| is_inside(output.as_deref(), path);
        let walk = WalkDir::new(root).max_depth(depth).follow_links(true).sort_by_file_name();
        // The walk itself finds links to folders above a link, up to the root.
        let (whole, mut loops) = (root.canonicalize().ok(), Vec::new());
        let mut is_searched = |entry: &DirEntry| {
            let is_folder = entry.file_type().is_dir();
            let is_loop = is_folder && entry.depth() > 0 && leads_above(entry, whole.as_deref());
            loops.extend(is_loop.then(|| entry.path().to_path_buf()));
            !(is_loop || is_folder && is_own(entry.path()))
        };
        let entries = walk.into_iter().filter_entry(&mut is_searched);
        for entry in entries {
            let path = match entry {
                Ok(entry) if entry.file_type().is_file() => entry.into_path(),
                Ok(_) => continue,
                Err(error) if error.depth() == 0 => return Err(not_walked(root, error)),
                Err(error) => match self.broken_link(error) {
                    Some(path) => path,
                    None => continue,
                },
            };
            let Some((kind, path)) = marks.object(path, root) else { continue };
            let below = slashed(path.strip_prefix(root).unwrap_or(&path));
            if is_wanted(&below) && !is_own(&path) {
                let id = if below.is_empty() { name_of_folder(&path) } else { below };
                self.add(Scan { id, kind, path, title: None })?;
            }
        }
        loops.iter().for_each(|path| self.skip(path, LOOP));
        Ok(())
    }

    fn skip(&mut self, path: &Path, why: &str) {
        let shown = path.strip_prefix(self.folder).unwrap_or(path);
        self.warnings.note(format!("skipped {}: {why}", shown.display()), 1);
    }

    /// Returns the link that could not be followed, if it has a model's name; notes any other error as a warning.
    fn broken_link(&mut self, error: walkdir::Error) -> Option<PathBuf> {
        let path = error.path()?.to_path_buf();
        if error.loop_ancestor().is_none() && is_model(&path) && path.is_symlink() {
            return Some(path);
        }
        let why = match (error.loop_ancestor(), error.io_error()) {
            (Some(_), _) => LOOP.into(),
            (_, Some(cause)) if cause.kind() == ErrorKind::NotFound => {
                "the link's target does not exist".into()
            }
            (_, cause) => cause.map_or_else(|| "it cannot be read".into(), ToString::to_string),
        };
        self.skip(&path, &why);
        None
    }

    /// Adds every model that matches a pattern; ids are relative to the part of it without wildcards.
    fn read_glob(&mut self, pattern: &str) -> Result<()> {
        let mut fixed: Vec<_> = Path::new(pattern).components().collect();
        let wild = fixed.iter().position(|part| has_wildcard(part.as_os_str()));
        let rest: PathBuf = fixed.split_off(wild.unwrap_or(fixed.len().saturating_sub(1))).iter().collect();
        let root = self.folder.join(fixed.iter().collect::<PathBuf>());
        let wrong = |error: glob::PatternError| Error::invalid(format!("glob {pattern}"), error.to_string());
        let wanted = Pattern::new(&slashed(&rest)).map_err(wrong)?;
        let is_deep = rest.components().any(|part| part.as_os_str() == "**");
        let depth = if is_deep { usize::MAX } else { rest.components().count() };
        let before = self.found.len();
        if root.is_dir() {
            // A pattern is for what is below its root.
            let is_wanted = |below: &str| !below.is_empty() && Override::covers(&wanted, below);
            // The files of a folder that matches are one level further down.
            let depth = depth.saturating_add(1);
            let marks = Marks::ModelsAndLights;
            self.read_below(Below { root: &root, depth, is_wanted: &is_wanted, marks })?;
        }
        if self.found.len() == before {
            self.warnings.note(format!("glob `{pattern}` adds no object"), 1);
        }
        Ok(())
    }

    fn add(&mut self, mut scan: Scan) -> Result<()> {
        if let Ok(path) = scan.path.strip_prefix(self.folder) {
            scan.path = if path.as_os_str().is_empty() { ".".into() } else { path.to_path_buf() };
        }
        if scan.id.split('/').any(|part| matches!(part, "" | "." | "..")) || scan.id.contains('\\') {
            return Err(Error::invalid(format!("the id `{}`", scan.id), "use names separated by /"));
        }
        let other = self.folded.insert(scan.id.to_lowercase(), scan.id.clone());
        if let Some(other) = other.filter(|other| *other != scan.id) {
            return Err(Error::invalid(
                format!("the ids `{other}` and `{}`", scan.id),
                "differ only in case, which many file systems ignore; rename one, or set ids in a list",
            ));
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
}

impl Marks {
    /// Returns the object that a file marks; the folder `root` itself has no other name than its own.
    fn object(self, file: PathBuf, root: &Path) -> Option<(Kind, PathBuf)> {
        let folder = |file: &Path| file.parent().unwrap_or(root).to_path_buf();
        match self {
            Self::ModelsAndLights if is_model(&file) => Some((Kind::Scan, file)),
            Self::ModelsAndLights if marks_photographs(&file) => Some((Kind::Photographs, folder(&file))),
            Self::Images if is_photograph(&file) => Some((Kind::Photographs, folder(&file))),
            _ => None,
        }
    }
}

impl Kind {
    /// Returns the kind of an object that a list names.
    fn of(path: &Path) -> Self {
        let is_light = |path: &Path| marks_photographs(path) || Relightable::is_named(path);
        if path.is_dir() || is_light(path) { Self::Photographs } else { Self::Scan }
    }
}

/// Returns `true` for a link to `root` or a folder above it.
fn leads_above(entry: &DirEntry, root: Option<&Path>) -> bool {
    let target = entry.path_is_symlink().then(|| entry.path().canonicalize().ok()).flatten();
    target.zip(root).is_some_and(|(target, root)| root.starts_with(target))
}

/// Returns the name of a folder, also of one written as `.`.
fn name_of_folder(path: &Path) -> String {
    let whole = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    whole.file_name().map(|name| slashed(name.as_ref())).unwrap_or_default()
}

/// Returns true if a path is in the output folder, or is that folder.
fn is_inside(output: Option<&Path>, path: &Path) -> bool {
    output.is_some_and(|output| path.canonicalize().is_ok_and(|path| path.starts_with(output)))
}

fn not_walked(folder: &Path, error: walkdir::Error) -> Error {
    let cause = error.into_io_error();
    Error::io(folder, cause.unwrap_or_else(|| std::io::Error::other("folder links form a loop")))
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
        Scan { id, kind: Kind::of(&own), path: own, title: words(self.title) }
    }
}
