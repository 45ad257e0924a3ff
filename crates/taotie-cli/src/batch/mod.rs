//! `taotie batch`: a whole collection: its work, the check of its files, and its books if others start the processes.

mod worker;

#[cfg(feature = "mcp")]
pub use worker::this_program;
pub use worker::{WORKER, run as work};

use crate::console::{self, Bar};
use crate::{Outcome, options, stop};
use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Serialize;
use serde_json::json;
use std::io::{self, BufRead};
use std::path::PathBuf;
use std::time::Duration;
use taotie::{Bytes, Warning};
use taotie_batch::{
    Audit, AuditOptions, Collection, DriveOptions, Event, Fault, Record, Remote, Shard, State, Summary, Told,
    audit, drive, duration, write_page,
};

const EXAMPLES: &str = "\
Examples:
  taotie batch collection.toml
  taotie batch collection.toml --retry-failed --time-limit 30m
  taotie batch collection.toml --shard 3/8
  taotie batch collection.toml --check --proofs 5

collection.toml specifies scans and folders of photographs, and what to make from them: docs/collections.md. Finished \
assets are not made again, so an interrupted run continues where it stopped. Exit codes: 0 all done, 1 a requirement is not met, 2 an \
asset failed or was refused.";

/// Bakes the scans of a collection, and estimates normals from its photographs.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct BatchArgs {
    /// The collection's file
    pub collection: PathBuf,

    /// Retry assets that failed or were refused before
    #[arg(long, help_heading = "Work")]
    pub retry_failed: bool,
    /// Do only the I-th of N parts, for job arrays on a cluster: each writes its own manifest
    #[arg(long, value_name = "I/N", value_parser = shard, help_heading = "Work")]
    pub shard: Option<Shard>,
    /// Make nothing new: compare all written files with the manifest, and make some assets again
    #[arg(long, conflicts_with_all = ["retry_failed", "shard", "page_only", "jobs", "time_limit", "memory_limit"], help_heading = "Work")]
    pub check: bool,
    /// With --check: the number of assets to make again; their files must be identical bit for bit
    #[arg(long, value_name = "N", default_value_t = 2, requires = "check", help_heading = "Work")]
    pub proofs: usize,
    /// Make nothing: write the collection's page with what is done
    #[arg(long, conflicts_with_all = ["retry_failed", "shard"], help_heading = "Work")]
    pub page_only: bool,

    /// Maximum number of concurrent processes; fewer run if memory is short [default: one per hardware thread]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Running")]
    pub jobs: Option<u32>,
    /// Maximum memory of all processes together, such as 16G [default: the machine's free memory]
    #[arg(long, value_name = "BYTES", value_parser = options::memory, help_heading = "Running")]
    pub memory_limit: Option<Bytes>,
    /// Maximum time per asset, such as 90s, 15m or 2h [default: many times the estimate from its size]
    #[arg(long, value_name = "TIME", value_parser = duration, help_heading = "Running")]
    pub time_limit: Option<Duration>,
    /// Also read files that a model references outside its own folder
    #[arg(long, help_heading = "Running")]
    pub allow_outside: bool,
    /// Print the outcome of the collection as JSON
    #[arg(long, help_heading = "Running")]
    pub json: bool,
}

fn shard(text: &str) -> Result<Shard, String> {
    text.parse().map_err(|error: taotie_engine::Error| error.to_string())
}

impl BatchArgs {
    /// Rejects invalid options, before any work is done.
    fn check(&self) -> Result<()> {
        match self.collection.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("toml") => Ok(()),
            _ => bail!("{}: expected a collection as a .toml file", self.collection.display()),
        }
    }

    /// Returns the options of the work.
    fn options(&self) -> DriveOptions {
        DriveOptions {
            jobs: self.jobs.map(|jobs| jobs as usize),
            memory: self.memory_limit,
            time_limit: self.time_limit,
            shard: self.shard,
            retry_failed: self.retry_failed,
            allow_outside: self.allow_outside,
        }
    }
}

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// Runs the subcommand.
pub fn run(args: &BatchArgs) -> Result<Outcome> {
    args.check()?;
    let collection = Collection::read(&args.collection)?;
    if args.check {
        return check(args, &collection);
    }
    let summary = match args.page_only {
        true => None,
        false => Some(work_through(args, &collection)?),
    };
    // Shards do not know of one another: a later run without --shard writes the page.
    let pages = if args.shard.is_none() { write_page(&collection)? } else { Vec::new() };
    print(args, summary.as_ref(), &pages)?;
    Ok(summary.map_or(Outcome::Fine, |summary| outcome(&summary)))
}

fn work_through(args: &BatchArgs, collection: &Collection) -> Result<Summary> {
    let held = stop::hold();
    let mut listener = Listener::default();
    let summary = drive(collection, &args.options(), &worker::worker()?, &mut |event| {
        listener.hear(event);
        !stop::is_ending()
    });
    drop(listener);
    drop(held);
    let summary = summary?;
    console::say_warnings(&summary.warnings);
    Ok(summary)
}

fn outcome(summary: &Summary) -> Outcome {
    let has = |state: State| summary.states.contains_key(&state);
    match (has(State::Failed) || has(State::Refused), has(State::RequiredNotMet)) {
        (true, _) => Outcome::Failed,
        (false, true) => Outcome::Different,
        (false, false) => Outcome::Fine,
    }
}

/// Prints the outcome of the collection.
fn print(args: &BatchArgs, summary: Option<&Summary>, pages: &[PathBuf]) -> Result<()> {
    if args.json {
        let report = Report {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            collection: console::name_of(&args.collection),
            states: summary.map(States::of),
            attempts: summary.map(|summary| summary.attempts),
            known: summary.map(|summary| summary.known),
            files: pages.iter().map(|page| console::name_of(page)).collect(),
            warnings: summary.map(|summary| summary.warnings.list()),
        };
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    if let Some(summary) = summary {
        let counted = State::ALL.iter().filter_map(|state| Some((state, summary.states.get(state)?)));
        let counts: Vec<String> = counted.map(|(state, count)| format!("{count} {}", state.name())).collect();
        console::result(&format!("{} ({} from earlier runs)", counts.join(", "), summary.known))?;
    }
    pages.first().map_or(Ok(()), |page| console::result(&page.display().to_string()))
}

/// The report on a collection.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The name of the collection's file, without folders.
    collection: String,
    /// The number of assets in each state; `None` with `--page-only`.
    states: Option<States>,
    /// Attempts made by this run; `None` with `--page-only`.
    attempts: Option<usize>,
    /// Assets known from earlier runs; `None` with `--page-only`.
    known: Option<usize>,
    /// The names of the files of the collection's page; empty for shards.
    files: Vec<String>,
    /// Problems and corrections; `None` with `--page-only`.
    warnings: Option<Vec<Warning>>,
}

/// The number of assets in each state.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct States {
    /// All files exist, and all requirements are met.
    done: usize,
    /// All files exist, but a figure does not meet its requirement.
    required_not_met: usize,
    /// They exceed the memory limit or another limit.
    refused: usize,
    /// They could not be made.
    failed: usize,
}

impl States {
    fn of(summary: &Summary) -> Self {
        let count = |state| summary.states.get(&state).copied().unwrap_or(0);
        Self {
            done: count(State::Done),
            required_not_met: count(State::RequiredNotMet),
            refused: count(State::Refused),
            failed: count(State::Failed),
        }
    }
}

/// Version of the JSON that `--check --json` prints.
const AUDIT_SCHEMA: u32 = 1;

/// The report on the files of a collection.
#[derive(Serialize)]
struct AuditReport<'a> {
    /// [`AUDIT_SCHEMA`].
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The name of the collection's file, without folders.
    collection: String,
    #[serde(flatten)]
    audit: &'a Audit,
}

/// Compares the written files with the manifest, for `--check`.
fn check(args: &BatchArgs, collection: &Collection) -> Result<Outcome> {
    let held = stop::hold();
    let bar = Bar::new("check");
    let options = AuditOptions { proofs: args.proofs };
    let audit = audit(collection, &options, &worker::worker()?, &mut |fraction| {
        bar.set(fraction);
        !stop::is_ending()
    });
    drop(bar);
    drop(held);
    let audit = audit?;
    print_audit(args, &audit)?;
    Ok(if audit.faults.is_empty() { Outcome::Fine } else { Outcome::Different })
}

fn print_audit(args: &BatchArgs, audit: &Audit) -> Result<()> {
    let Audit { assets, files, proofs, faults } = audit;
    if args.json {
        let report = AuditReport {
            schema: AUDIT_SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            collection: console::name_of(&args.collection),
            audit,
        };
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    for Fault { id, what } in faults {
        console::result(&format!("{id}: {what}"))?;
    }
    let count = faults.len();
    console::result(&format!("{assets} assets: {files} files read, {proofs} made again, {count} faults"))
}

/// The subcommand of [`keep`]; not for users.
pub const BOOK: &str = "batch-book";

/// Keeps the books of a collection whose processes are started by others, such as `taotie.ray`: plan, manifest and
/// page.
///
/// Prints a line for each job to do, then an empty one; reads a line for each finished job, and prints its state; at
/// the end of stdin, writes the page and prints a summary. Every line is JSON.
pub fn keep(args: &BatchArgs) -> Result<Outcome> {
    args.check()?;
    let collection = Collection::read(&args.collection)?;
    let mut remote = Remote::open(&collection, &args.options(), args.jobs.unwrap_or(1) as usize)?;
    for planned in &remote.planned {
        console::result(&serde_json::to_string(planned)?)?;
    }
    console::result("")?;
    remote.kept.iter().for_each(say_record);
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
        "states": States::of(&summary),
        "attempts": summary.attempts,
        "known": summary.known,
        "files": pages.iter().map(|page| page.to_string_lossy()).collect::<Vec<_>>(),
        "warnings": summary.warnings.list(),
    });
    console::result(&report.to_string())?;
    Ok(outcome(&summary))
}

/// Shows the progress of a collection, and reports what was not made.
#[derive(Default)]
struct Listener {
    bar: Option<Bar>,
}

impl Listener {
    /// Handles an event.
    fn hear(&mut self, event: Event<'_>) {
        match event {
            Event::Planned { todo, known } => {
                console::say(&format!("taotie: {todo} assets to do, {known} from earlier runs"));
                self.bar = (todo > 0).then(|| Bar::new(format!("{todo} assets")));
            }
            Event::Kept(record) | Event::Ended(record) => say_record(record),
            Event::Running { fraction, left, .. } => {
                if let Some(bar) = &self.bar {
                    bar.show_all(fraction, left);
                }
            }
        }
    }
}

/// Reports why an asset was not made or does not meet a requirement.
fn say_record(record: &Record) {
    let name = console::plain(&record.id);
    if let Some(error) = &record.error {
        console::say(&format!("taotie: {name}: {}: {}", record.state.name(), console::plain(error)));
    }
    for met in record.required.iter().filter(|met| !met.met) {
        let figure = met.name();
        console::say(&format!("taotie: {name}: {}: {figure} {}", record.state.name(), met.text()));
    }
}
