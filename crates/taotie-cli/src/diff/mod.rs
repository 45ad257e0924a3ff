//! `taotie diff`: how two pictures, or the normals that two maps hold, differ.
//!
//! [`Subject`] is what is compared, [`Report`] what came of it; the text and the JSON are two ways to print it.

mod args;
mod heat;
mod measure;
mod report;
mod subject;

pub use args::DiffArgs;

use crate::console;
use crate::{Outcome, studio};
use anyhow::Result;
use report::Report;
use subject::Subject;

/// Runs the subcommand.
pub fn run(args: &DiffArgs) -> Result<Outcome> {
    args.check()?;
    let report = studio::in_pool(args.threads, || compare(args))??;
    match print(args, &report) {
        // A reader that went away still gets the exit code.
        Err(error) if !console::is_broken_pipe(&error) => return Err(error),
        _ => {}
    }
    Ok(if report.threshold.is_some_and(|threshold| threshold.exceeded) {
        Outcome::Different
    } else {
        Outcome::Fine
    })
}

fn print(args: &DiffArgs, report: &Report) -> Result<()> {
    if args.json {
        return console::result(&serde_json::to_string_pretty(report)?);
    }
    console::say_warnings(&report.warnings);
    console::result(report.text().trim_end())
}

fn compare(args: &DiffArgs) -> Result<Report> {
    let (subject, warnings) = Subject::read(args)?;
    let measured = measure::measure(args, &subject)?;
    if let Some(path) = &args.heat {
        heat::write(args, path, &subject)?;
    }
    Report::new(args, &subject, measured, warnings)
}
