//! Fuzzing of all readers and of the code behind them, on stable Rust: `make fuzz TIME=60`.
//!
//! Sound files are damaged in format-aware ways, and read in child processes with limited memory and time. Runs are
//! numbered; a number and a seed give the same run everywhere. A fault is minimised and kept as the name of a sound
//! file and a list of changes.
//!
//! Exit codes: 0 nothing found, 1 findings, 2 error.

mod campaign;
mod case;
mod corpus;
mod mutation;
mod runner;
mod target;
mod worker;

use anyhow::{Context, Result};
use campaign::{Campaign, End, Harvest, Totals};
use case::{Case, Finding};
use clap::{Args, Parser, Subcommand, ValueEnum};
use corpus::Seed;
use runner::{Patience, Runner};
use std::io::{self, Read, Write};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};
use taotie::Bytes;
use target::Target;
use worker::Worker;

/// The folder where findings are kept.
const FINDINGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/findings");
/// How often counts and findings are written: a long session never loses more than this.
const ROUND: Duration = Duration::from_secs(300);
/// The file where the counts of all sessions are kept.
const TOTALS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/totals.json");

/// Damages files and checks that readers, and the code behind them, end with a result or an error.
#[derive(Parser)]
#[command(name = "taotie-fuzz", disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Run for a given time or number of runs.
    Run(RunArgs),
    /// Run the kept findings again; exit with 1 if one still fails.
    Replay {
        /// The folder of findings.
        #[arg(long, default_value = FINDINGS)]
        findings: PathBuf,
        #[command(flatten)]
        bounds: Bounds,
    },
    /// Write the damaged file of a finding.
    Rebuild {
        /// The finding.
        finding: PathBuf,
        /// The file to write.
        #[arg(short, long)]
        output: PathBuf,
        /// A folder of additional sound files.
        #[arg(long)]
        models: Option<PathBuf>,
    },
    /// Print the counts of all sessions as a table.
    Table {
        /// The file of counts.
        #[arg(long, default_value = TOTALS)]
        totals: PathBuf,
    },
    /// The child process.
    #[command(hide = true)]
    Worker(WorkerArgs),
}

#[derive(Args)]
struct RunArgs {
    /// Seconds to run.
    #[arg(long, conflicts_with = "runs", required_unless_present = "runs")]
    time: Option<u64>,
    /// Runs of each reader; bakes and renders get a fiftieth of it.
    #[arg(long)]
    runs: Option<u64>,
    /// The targets, separated by commas; defaults to all.
    #[arg(long, value_delimiter = ',')]
    targets: Vec<Target>,
    /// The seed for all random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Concurrent workers; defaults to one per core.
    #[arg(long)]
    jobs: Option<usize>,
    /// The folder that findings are written to.
    #[arg(long, default_value = FINDINGS)]
    findings: PathBuf,
    /// A file of counts to continue from and add to; without it, runs are numbered from 0.
    #[arg(long)]
    totals: Option<PathBuf>,
    #[command(flatten)]
    bounds: Bounds,
}

#[derive(Args)]
struct Bounds {
    /// A folder of additional sound files.
    #[arg(long)]
    models: Option<PathBuf>,
    /// Memory that a run may allocate.
    #[arg(long, default_value = "512M")]
    memory: Bytes,
    /// Seconds of processor time that a run may take; thirty times as many in wall-clock time.
    #[arg(long, default_value_t = 10)]
    patience: u64,
}

#[derive(Args)]
struct WorkerArgs {
    /// The target; without it, one case is read from stdin.
    #[arg(long, requires_all = ["seed", "from", "to"])]
    target: Option<Target>,
    #[arg(long)]
    seed: Option<u64>,
    #[arg(long)]
    from: Option<u64>,
    #[arg(long)]
    to: Option<u64>,
    #[arg(long)]
    models: Option<PathBuf>,
    #[arg(long)]
    memory: usize,
}

fn main() -> ExitCode {
    match work(Cli::parse().task) {
        Ok(is_clean) => ExitCode::from(u8::from(!is_clean)),
        Err(error) => {
            // It is not an error if nobody is listening.
            let _ = writeln!(io::stderr().lock(), "taotie-fuzz: error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Runs the task; returns `true` if nothing failed.
fn work(task: Task) -> Result<bool> {
    match task {
        Task::Run(args) => run(&args),
        Task::Replay { findings, bounds } => replay(&findings, &bounds.runner()),
        Task::Rebuild { finding, output, models } => {
            let bytes = case::read_finding(&finding)?.case.bytes(&corpus::seeds(models.as_deref())?)?;
            std::fs::write(&output, bytes).with_context(|| output.display().to_string())?;
            Ok(true)
        }
        Task::Table { totals } => {
            io::stdout().lock().write_all(Totals::read(&totals)?.table().as_bytes())?;
            Ok(true)
        }
        Task::Worker(args) => serve(&args).map(|()| true),
    }
}

impl Bounds {
    fn runner(&self) -> Runner {
        let patience = Patience::of(Duration::from_secs(self.patience));
        Runner { models: self.models.clone(), memory: self.memory, patience }
    }
}

/// Runs campaigns until the end, keeps their findings, and updates the counts.
fn run(args: &RunArgs) -> Result<bool> {
    let seeds = corpus::seeds(args.bounds.models.as_deref())?;
    let mut totals = args.totals.as_deref().map(Totals::read).transpose()?.unwrap_or_default();
    let until = args.time.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let mut known = Vec::new();
    loop {
        let campaign = campaign(args, &totals, Session { seeds: &seeds, known: &known, until });
        let harvest =
            campaign.run(args.jobs.unwrap_or_else(|| available_parallelism().map_or(1, NonZero::get)))?;
        report(&harvest, &args.findings)?;
        harvest.totals.targets.iter().for_each(|(target, count)| totals.add(*target, *count));
        if let Some(path) = &args.totals {
            totals.write(path)?;
        }
        known.extend(harvest.findings);
        if until.is_none_or(|until| Instant::now() >= until) {
            return Ok(known.is_empty());
        }
    }
}

/// The state of a session.
#[derive(Clone, Copy)]
struct Session<'a> {
    seeds: &'a [Seed],
    known: &'a [Finding],
    /// When the session ends; `None` if it is limited by runs.
    until: Option<Instant>,
}

/// Returns the next campaign of a session.
fn campaign<'a>(args: &RunArgs, totals: &Totals, session: Session<'a>) -> Campaign<'a> {
    let targets =
        if args.targets.is_empty() { Target::value_variants().to_vec() } else { args.targets.clone() };
    let runs = End::Runs(args.runs.unwrap_or_default());
    Campaign {
        runner: args.bounds.runner(),
        seeds: session.seeds,
        known: session.known,
        first: targets.iter().map(|target| (*target, totals.of(*target).runs)).collect(),
        targets,
        seed: args.seed,
        end: session.until.map_or(runs, |until| End::At(until.min(Instant::now() + ROUND))),
    }
}

/// Prints the results of a campaign, and keeps its findings.
fn report(harvest: &Harvest, folder: &Path) -> Result<()> {
    let mut stdout = io::stdout().lock();
    for (target, count) in &harvest.totals.targets {
        let (name, rate) = (target.name(), count.rate());
        writeln!(
            stdout,
            "{name:12} {:9} runs {rate:8.0} per second {:3} findings",
            count.runs, count.findings
        )?;
    }
    for finding in &harvest.findings {
        let path = finding.keep(folder)?;
        writeln!(stdout, "{}: {}: {}", path.display(), finding.failure.kind_name(), finding.failure.message)?;
    }
    Ok(())
}

/// Runs the kept findings again.
fn replay(folder: &Path, runner: &Runner) -> Result<bool> {
    let mut is_clean = true;
    for (path, finding) in case::kept_findings(folder)? {
        let failure = runner.case(&finding.case).with_context(|| path.display().to_string())?;
        is_clean &= failure.is_none();
        let said = failure.map_or_else(
            || "passes".to_owned(),
            |failure| format!("{}: {}", failure.kind_name(), failure.message),
        );
        writeln!(io::stdout().lock(), "{}: {said}", path.display())?;
    }
    Ok(is_clean)
}

/// Runs a child process.
fn serve(args: &WorkerArgs) -> Result<()> {
    let seeds = corpus::seeds(args.models.as_deref())?;
    let mut worker = Worker::new(&seeds, args.memory)?;
    if let (Some(target), Some(seed), Some(from), Some(to)) = (args.target, args.seed, args.from, args.to) {
        return worker.runs(target, seed, from..to);
    }
    let mut text = String::new();
    io::stdin().lock().read_to_string(&mut text)?;
    let case: Case = serde_json::from_str(&text).context("stdin is not a valid case")?;
    worker.run_one(&case)
}
