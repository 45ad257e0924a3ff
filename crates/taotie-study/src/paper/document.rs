//! The study as files: a page for people, JSON for machines.

use super::study::Study;
use super::words;
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie::{Error, Result, io};

/// Version of the JSON.
const SCHEMA: u32 = 1;

/// The JSON document.
#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    version: &'static str,
    source: &'static str,
    law: &'static str,
    #[serde(flatten)]
    study: &'a Study,
}

impl Study {
    /// Returns the study as JSON, without an end of line.
    pub fn json(&self) -> String {
        let law = "N = N1 + s · (g/255) · (1, 1, 0), s = 5 for N2 and 50 for N3";
        let version = env!("CARGO_PKG_VERSION");
        let document = Document { schema: SCHEMA, version, source: words::SOURCE, law, study: self };
        serde_json::to_string_pretty(&document).expect("the study has only text keys")
    }

    /// Writes `paper.html` and `paper.json` to `folder`, which is made if it is not there; returns the files.
    ///
    /// # Errors
    /// [`Error::Io`] where the folder cannot be made or written to.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
        let files = ["paper.html", "paper.json"].map(|name| folder.join(name));
        io::write_text(&files[0], &taotie_report::html(&self.page()))?;
        io::write_text(&files[1], &format!("{}\n", self.json()))?;
        Ok(files.into())
    }
}
