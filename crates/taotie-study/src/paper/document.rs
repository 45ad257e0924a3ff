//! Writes the study as files: a page for people, JSON for machines.

use super::study::Study;
use super::words;
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie_engine::Result;
use taotie_io::FileSet;

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
    /// Returns the study as JSON, without a trailing newline.
    pub fn json(&self) -> String {
        let law = "N = N1 + s · (g/255) · (1, 1, 0), s = 5 for N2 and 50 for N3";
        let version = env!("CARGO_PKG_VERSION");
        let document = Document { schema: SCHEMA, version, source: words::SOURCE, law, study: self };
        serde_json::to_string_pretty(&document).expect("the study has only text keys")
    }

    /// Writes `paper.html` and `paper.json` to `folder`, which is created if necessary, as files of a set; returns
    /// the files.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if the folder cannot be created or written to.
    pub fn write(&self, set: &FileSet, folder: &Path) -> Result<Vec<PathBuf>> {
        set.claim_folder(folder)?;
        let files = ["paper.html", "paper.json"].map(|name| folder.join(name));
        set.write_text(&files[0], &taotie_report::html(&self.page()))?;
        set.write_text(&files[1], &format!("{}\n", self.json()))?;
        Ok(files.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_files_contain_the_study_and_a_folder_that_cannot_be_created_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let study = Study::new();
        let files = FileSet::one(|set| study.write(set, &folder.path().join("made"))).unwrap();
        let [page, json] = [0, 1].map(|i| std::fs::read_to_string(&files[i]).unwrap());
        assert!(page.contains("<title>Guo and Wang 2025, Tables 2 and 3, recomputed</title>"));
        let read: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((read["schema"].as_u64(), read["source"].as_str()), (Some(1), Some(words::SOURCE)));
        assert_eq!(read["misprints"].as_array().unwrap().len(), study.misprints.len());
        let error = study.write(&FileSet::new(), &files[0].join("below")).unwrap_err().to_string();
        assert!(error.contains("paper.html"), "{error}");
    }
}
