//! The report on a model, to be printed as text or JSON.

use super::words;
use serde::Serialize;
use std::path::Path;
use taotie::inspection::Inspection;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 5;

/// The printed report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The path as given.
    pub model: String,
    /// The content of the model and its defects.
    #[serde(flatten)]
    pub inspection: Inspection,
    /// Suggestions.
    pub hints: Vec<String>,
}

impl Report {
    /// Makes the report on the model at `path`.
    pub fn new(path: &Path, inspection: Inspection) -> Self {
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            model: path.display().to_string(),
            hints: inspection.hints().iter().filter_map(words::hint).collect(),
            inspection,
        }
    }
}
