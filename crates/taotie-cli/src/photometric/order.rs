//! An estimate that was ordered, by the command or by a collection: photographs, options, and where to write.

use super::scan::Scan;
use crate::console::name_of;
use std::path::{Path, PathBuf};
use taotie_engine::Progress;
use taotie_engine::image::Image;
use taotie_io::{FileSet, Limits};
use taotie_photometric::{PhotographSet, PhotometricOptions};

/// Photographs, and what to make of them.
pub struct Order<'a> {
    /// The folder or file, as the report and the page name it.
    pub input: String,
    /// The photographs.
    pub set: &'a PhotographSet,
    /// The options.
    pub options: &'a PhotometricOptions,
    /// The folder to write to.
    pub output: &'a Path,
    /// The set that the files belong to.
    pub files: &'a FileSet,
    /// Limits of memory and image sizes.
    pub limits: Limits,
    /// True to write `report.html`.
    pub has_page: bool,
    /// True to give names of files without their folders, so that all files are the same on every machine.
    pub is_portable: bool,
    /// A scan of large shapes.
    pub scan: Option<Scan>,
    /// True normals, at the size of the photographs or a multiple.
    pub truth: Option<Image>,
    /// Stages.
    pub progress: Progress<'a>,
}

impl Order<'_> {
    /// Returns the path of an output.
    pub fn path(&self, name: &str) -> PathBuf {
        self.output.join(name)
    }

    /// Returns a path as reports show it.
    pub fn shown(&self, path: &Path) -> String {
        if self.is_portable { name_of(path) } else { path.display().to_string() }
    }
}
