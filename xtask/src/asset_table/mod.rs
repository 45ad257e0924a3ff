//! `docs/assets-table.md`: all glTF models in some folders, baked to small assets, with figures from the reports.

mod baked;
mod models;
mod process;
mod row;

use crate::computed;
use crate::generated::Generated;
use anyhow::{Context, Result, bail};
use baked::Baked;
use models::Model;
use process::{Ending, Limited};
use row::Row;
use serde_json::Value;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

const PAGE: &str = "docs/assets-table.md";
/// The side of the maps, texels.
const SIZE: &str = "512";
/// The ratio of the triangles of a scan to those of its asset.
const FEWER: u64 = 10;
/// The minimum number of triangles that the command produces.
const FEWEST: u64 = 4;

/// The models, the program and the output of the rows.
#[derive(clap::Args)]
pub struct AssetTableArgs {
    /// Folders of glTF models, including subfolders.
    #[arg(long, value_name = "FOLDER", required = true, num_args = 1..)]
    models: Vec<PathBuf>,
    /// The baking program.
    #[arg(long, value_name = "PATH", default_value = "target/release/taotie")]
    program: PathBuf,
    /// Bake only models whose path contains one of these texts; print the rows instead of updating the page.
    #[arg(long, value_name = "TEXT", num_args = 1..)]
    only: Vec<String>,
    /// Time limit of a bake in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 600)]
    limit: u64,
    /// Print the rows as JSON instead of updating the page.
    #[arg(long)]
    json: bool,
}

/// Bakes every model. The row of a failed bake has its error message.
///
/// # Errors
/// If a folder cannot be listed, or the program does not start.
pub fn rows(args: &AssetTableArgs) -> Result<Vec<Row>> {
    let models = models::below(&args.models, &args.only)?;
    if models.is_empty() {
        bail!("no .gltf or .glb files with these names in {:?}", args.models);
    }
    let baked = models.iter().enumerate().map(|(i, model)| {
        let row = row(args, model).with_context(|| model.path.display().to_string())?;
        writeln!(io::stderr().lock(), "{}/{}  {row}", i + 1, models.len())?;
        Ok(row)
    });
    baked.collect()
}

/// Returns the text to print; `None` if the page is to be updated.
///
/// # Errors
/// None that numbers and text could cause.
pub fn printed(args: &AssetTableArgs, rows: &[Row]) -> Result<Option<String>> {
    Ok(match (args.json, args.only.is_empty()) {
        (true, _) => Some(serde_json::to_string_pretty(&rows.iter().map(Row::json).collect::<Vec<_>>())?),
        (false, false) => Some(row::table(rows)),
        (false, true) => None,
    })
}

/// Returns the page with its tables updated, below the repository's `root`.
///
/// # Errors
/// If the page cannot be read.
pub fn generated(root: &Path, rows: &[Row]) -> Result<Generated> {
    computed::page(root, PAGE, |name| match name {
        "assets" => Some(row::table(rows)),
        "assets-count" => Some(row::count(rows)),
        _ => None,
    })
}

fn row(args: &AssetTableArgs, model: &Model) -> Result<Row> {
    let folder = tempfile::tempdir()?;
    let limited = Limited { program: &args.program, folder: folder.path(), limit: limit(args) };
    let outcome = match bake(&limited, &model.path)? {
        Ok(report) => Baked::of(&report).ok_or_else(|| "its report has missing figures".to_owned()),
        Err(sentence) => Err(sentence.replace(&model.path.display().to_string(), &model.file_name())),
    };
    Ok(Row { model: model.name.clone(), outcome })
}

fn limit(args: &AssetTableArgs) -> Duration {
    Duration::from_secs(args.limit)
}

/// Returns the report of a bake to a tenth of the triangles, or the error message of the command.
fn bake(limited: &Limited<'_>, model: &Path) -> Result<Result<Value, String>> {
    let model = model.as_os_str();
    let inspected = match json_of(limited, &["inspect".as_ref(), model, "--json".as_ref()])? {
        Ok(report) => report,
        Err(sentence) => return Ok(Err(sentence)),
    };
    let triangles = inspected.pointer("/counts/triangles_drawn").and_then(Value::as_u64).unwrap_or(0);
    let wanted = (triangles / FEWER).max(FEWEST).to_string();
    let out = limited.folder.join("out.glb");
    let to = ["bake".as_ref(), model, "-o".as_ref(), out.as_os_str()];
    let options = ["--triangles", &wanted, "--size", SIZE, "--json"].map(AsRef::as_ref);
    json_of(limited, &[&to[..], &options].concat())
}

/// Returns the JSON output of a run, or its error message.
fn json_of(limited: &Limited<'_>, arguments: &[&std::ffi::OsStr]) -> Result<Result<Value, String>> {
    let output = limited.run(arguments)?;
    Ok(match output.ending {
        Ending::Fine => serde_json::from_str(&output.stdout).map_err(|error| format!("no report: {error}")),
        Ending::Failed => Err(output.sentence()),
        Ending::TooLong => Err(format!("not finished after {} s", limited.limit.as_secs())),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_a_place_for_computed_parts() -> Result<()> {
        let text = std::fs::read_to_string(crate::root().join(PAGE))?;
        for name in ["assets", "assets-count"] {
            assert_eq!(text.matches(&computed::start(name)).count(), 1, "{name}");
        }
        generated(&crate::root(), &[]).map(drop)
    }
}
