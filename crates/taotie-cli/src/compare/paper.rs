//! `taotie compare --paper`: the tables of Guo and Wang 2025, recomputed.

use crate::console;
use anyhow::Result;
use std::path::Path;
use taotie_io::FileSet;
use taotie_study::paper::Study;

/// Prints the study as text or JSON; with `out`, writes it to that folder, as files of a set.
///
/// # Errors
/// If the folder cannot be created or written to.
pub fn run(json: bool, set: &FileSet, out: Option<&Path>) -> Result<()> {
    let study = Study::new();
    let files = out.map(|folder| study.write(set, folder)).transpose()?.unwrap_or_default();
    set.commit()?;
    if json {
        return console::result(&study.json());
    }
    console::result(study.text().trim_end())?;
    if !files.is_empty() {
        console::result("")?;
    }
    for file in &files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}
