//! A comparison by surface methods as files: every picture, `sheet.png`, `report.json`, its tables as CSV, and
//! `report.html`.
//!
//! ```no_run
//! use std::path::Path;
//! use taotie::Progress;
//! use taotie::comparison::{Comparison, ComparisonOptions, Subject};
//! use taotie_report::comparison::{Options, write};
//!
//! let scene = taotie::io::load_model("low.glb".as_ref())?.scene;
//! let reference = taotie::io::load_model("scan.ply".as_ref())?.scene;
//! let subject = Subject::new("low.glb", &scene).with_reference("scan.ply", &reference);
//! let comparison = Comparison::of(&subject, &ComparisonOptions::default(), Progress::SILENT)?;
//! let written = write(&comparison, &Options::default(), Path::new("comparison"))?;
//! println!("{} files", written.files.len());
//! # Ok::<(), taotie::Error>(())
//! ```

mod document;
mod files;
mod one_surface;
mod page;
mod picture_tables;
mod tables;

pub use document::{Document, SCHEMA};
pub use files::possible_files;

use crate::Page;
use files::Files;
use serde_json::Value;
use std::path::{Path, PathBuf};
use taotie::Result;
use taotie::comparison::Comparison;
use taotie::io::FileSet;

/// The options of the files of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The heading of the page.
    pub title: String,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top_deg: f64,
    /// The choice of material, repeated in `report.json`; null where there is none.
    pub material: Value,
    /// The choice of environment, repeated in `report.json`; null where there is none.
    pub environment: Value,
    /// Also writes normals and angular errors as OpenEXR: the numbers themselves, unit vectors in world space and degrees.
    pub exr: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            title: "Comparison".into(),
            heat_top_deg: 30.0,
            material: Value::Null,
            environment: Value::Null,
            exr: false,
        }
    }
}

/// The files of a comparison.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Written {
    /// The content of `report.json`.
    pub document: Document,
    /// The files in the order in which they were written.
    pub files: Vec<PathBuf>,
}

/// Makes the page of a comparison.
///
/// # Errors
/// [`taotie::Error::Invalid`] where a picture has no pixels.
pub fn page(comparison: &Comparison, options: &Options) -> Result<Page> {
    page::page(comparison, &Document::new(comparison, options)?, options)
}

/// Writes pictures, contact sheet, `report.json`, tables as CSV and `report.html` into `folder`, which is made if it is not
/// there. All appear together, or none.
///
/// # Errors
/// [`taotie::Error::Io`] where a file cannot be written.
pub fn write(comparison: &Comparison, options: &Options, folder: &Path) -> Result<Written> {
    FileSet::one(|set| write_in(set, comparison, options, folder))
}

/// Writes the files of [`write()`] as files of a set, which the caller commits.
///
/// # Errors
/// As [`write()`], and [`taotie::Error::Invalid`] where a file that was read would be written over.
pub fn write_in(set: &FileSet, comparison: &Comparison, options: &Options, folder: &Path) -> Result<Written> {
    let mut files = Files::new(set, folder, options.heat_top_deg as f32)?;
    files.write(comparison)?;
    if options.exr {
        files.write_exact(comparison)?;
    }
    let document = Document::new(comparison, options)?;
    files.write_text("report.json", &document.json()?)?;
    for (name, table) in tables::files(&document) {
        files.write_text(name, &table)?;
    }
    let page = page::page(comparison, &document, options)?;
    files.write_text("report.html", &crate::html(&page))?;
    Ok(Written { document, files: files.written })
}
