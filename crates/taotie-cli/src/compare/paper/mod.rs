//! The tables of the seed paper, recomputed.
//!
//! All that is known is what is printed ([`printed`]). From it come the law of N2 and N3 with the g of each row
//! ([`law`]), the angles ([`angles`]), the misprints ([`misprints`]) and what follows ([`study`]).

mod angles;
mod law;
mod misprints;
mod page;
mod printed;
mod range;
mod study;
mod text;
mod words;

use crate::console;
use anyhow::Result;
use serde::Serialize;
use std::path::{Path, PathBuf};
use study::Study;

/// Version of the JSON.
const SCHEMA: u32 = 1;

/// Prints the study as text or JSON; with `out`, writes `paper.html` and `paper.json` to that folder, which is made
/// if it is not there.
///
/// # Errors
/// Where the folder cannot be made or written to.
pub fn run(json: bool, out: Option<&Path>) -> Result<()> {
    let study = Study::new();
    let files = out.map(|folder| write(folder, &study)).transpose()?.unwrap_or_default();
    if json {
        return console::result(&document(&study)?);
    }
    console::result(text::of(&study).trim_end())?;
    if !files.is_empty() {
        console::result("")?;
    }
    for file in &files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}

fn write(folder: &Path, study: &Study) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).map_err(|error| taotie::Error::io(folder, error))?;
    let files = ["paper.html", "paper.json"].map(|name| folder.join(name));
    taotie::io::write_text(&files[0], &taotie_report::html(&page::of(study)))?;
    taotie::io::write_text(&files[1], &format!("{}\n", document(study)?))?;
    Ok(files.into())
}

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

fn document(study: &Study) -> Result<String> {
    let law = "N = N1 + s · (g/255) · (1, 1, 0), s = 5 for N2 and 50 for N3";
    let version = env!("CARGO_PKG_VERSION");
    let document = Document { schema: SCHEMA, version, source: words::SOURCE, law, study };
    Ok(serde_json::to_string_pretty(&document)?)
}
