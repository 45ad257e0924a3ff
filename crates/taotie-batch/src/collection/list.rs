//! Lists of scans: CSV with a header, or one JSON object per line.

use super::scan::Scan;
use crate::input::slashed;
use serde::Deserialize;
use std::path::Path;
use taotie_engine::{Error, Result, Warnings};
use taotie_io::read_bytes;

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
pub fn read(path: &Path) -> Result<(Vec<Scan>, Warnings)> {
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
        let id = words(self.id).unwrap_or_else(|| slashed(&named.collect::<std::path::PathBuf>()));
        Scan { id, path: own, title: words(self.title) }
    }
}
