//! Bookkeeping of a collection whose processes are started by others, such as `taotie.ray`: plan, manifest and page.

use super::{BatchArgs, outcome, states_json};
use crate::{Outcome, console};
use anyhow::{Context, Result};
use serde_json::json;
use std::io::{self, BufRead};
use taotie_batch::{Collection, Remote, Told, write_page};

/// The subcommand that does it; not for users.
pub const BOOK: &str = "batch-book";

/// Prints a line for each job to do, then an empty one; reads a line for each finished job, and prints its state; at
/// the end of stdin, writes the page and prints a summary. Every line is JSON.
pub fn run(args: &BatchArgs) -> Result<Outcome> {
    args.check()?;
    let collection = Collection::read(&args.collection)?;
    let mut remote = Remote::open(&collection, &args.options(), args.jobs.unwrap_or(1) as usize)?;
    for planned in &remote.planned {
        console::result(&serde_json::to_string(planned)?)?;
    }
    console::result("")?;
    for line in io::stdin().lock().lines() {
        let ended: Told = serde_json::from_str(&line?).context("stdin: expected the end of a job")?;
        let record = remote.add(ended)?;
        console::result(
            &json!({ "id": record.id, "state": record.state, "error": record.error }).to_string(),
        )?;
    }
    let summary = remote.summary();
    let pages = if args.shard.is_none() { write_page(&collection)? } else { Vec::new() };
    let report = json!({
        "states": states_json(&summary),
        "attempts": summary.attempts,
        "known": summary.known,
        "files": pages.iter().map(|page| page.to_string_lossy()).collect::<Vec<_>>(),
        "warnings": console::json_warnings(&summary.warnings),
    });
    console::result(&report.to_string())?;
    Ok(outcome(&summary))
}
