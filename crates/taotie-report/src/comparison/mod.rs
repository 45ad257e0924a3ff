//! Writes a comparison of surface methods as files: every picture, `sheet.png`, `report.json`, its tables as CSV, and
//! `report.html`.
//!
//! ```no_run
//! use std::path::Path;
//! use taotie::comparison::{Comparison, ComparisonOptions, Subject};
//! use taotie::{Error, Progress};
//! use taotie_report::comparison::{Options, write};
//!
//! let scene = taotie_io::load_model("low.glb")?.scene;
//! let reference = taotie_io::load_model("scan.ply")?.scene;
//! let subject = Subject::new("low.glb", &scene).with_reference("scan.ply", &reference);
//! let comparison = Comparison::of(&subject, &ComparisonOptions::default(), Progress::SILENT)?;
//! let written = write(&comparison, &Options::default(), Path::new("comparison"))?;
//! println!("{} files", written.files.len());
//! # Ok::<(), Error>(())
//! ```

mod document;
mod files;
mod page;

pub use document::{Document, Options, SCHEMA};
pub use files::possible_files;

use crate::Page;
use files::{Files, tables};
use std::path::{Path, PathBuf};
use taotie::comparison::Comparison;
use taotie_engine::Result;
use taotie_io::FileSet;

/// The files of a comparison.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Written {
    /// The content of `report.json`.
    pub document: Document,
    /// The files, in the order in which they were written.
    pub files: Vec<PathBuf>,
}

/// Builds the page for a comparison.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub fn page(comparison: &Comparison, options: &Options) -> Result<Page> {
    page::page(comparison, &Document::new(comparison, options)?, options)
}

/// Writes pictures, contact sheet, `report.json`, tables as CSV and `report.html` into `folder`, which is created if
/// necessary. Either all files appear or none.
///
/// # Errors
/// [`taotie_engine::Error::Io`] if a file cannot be written.
pub fn write(comparison: &Comparison, options: &Options, folder: &Path) -> Result<Written> {
    FileSet::one(|set| write_in(set, comparison, options, folder))
}

/// Writes the files of [`write()`] to a file set, which the caller commits.
///
/// # Errors
/// As for [`write()`], and [`taotie_engine::Error::Invalid`] if an input file would be overwritten.
pub fn write_in(set: &FileSet, comparison: &Comparison, options: &Options, folder: &Path) -> Result<Written> {
    let mut files = Files::new(set, folder, options.heat_top_deg as f32)?;
    files.write(comparison)?;
    if options.exr {
        files.write_exact(comparison)?;
    }
    let document = Document::new(comparison, options)?;
    files.write_text("report.json", &document.json()?)?;
    for (name, table) in tables(&document) {
        files.write_text(name, &table)?;
    }
    let page = page::page(comparison, &document, options)?;
    files.write_text("report.html", &crate::html(&page))?;
    Ok(Written { document, files: files.written })
}
