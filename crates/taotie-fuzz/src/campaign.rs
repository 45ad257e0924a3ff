//! A campaign: many runs over all targets, on several cores, for a given time or number of runs; and the counts of
//! all sessions, kept in a file, with the table made from them.

use crate::case::{Case, Finding, Number};
use crate::corpus::Seed;
use crate::runner::{FailedRun, Runner, Slice};
use crate::target::Target;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

/// The target duration of one worker's runs.
const SLICE: Duration = Duration::from_secs(2);
/// The number of runs of a target's first worker, and the maximum for any worker.
const FIRST: u64 = 20;
const MOST: u64 = 20_000;
/// Runs of a reader per run of a path behind the readers.
const PATHS: u64 = 50;

/// When a campaign ends.
#[derive(Debug, Clone, Copy)]
pub enum End {
    /// At this time.
    At(Instant),
    /// After this many runs of each reader, and a fiftieth of it for each path behind the readers.
    Runs(u64),
}

/// A campaign.
pub struct Campaign<'a> {
    /// Starts workers.
    pub runner: Runner,
    /// The sound files, the same as those of the workers.
    pub seeds: &'a [Seed],
    /// The targets.
    pub targets: Vec<Target>,
    /// The seed for all random numbers.
    pub seed: u64,
    /// When it ends.
    pub end: End,
    /// Known faults, which are not reported again.
    pub known: &'a [Finding],
    /// The number of each target's first run.
    pub first: BTreeMap<Target, u64>,
}

/// The results of a campaign.
#[derive(Debug, Default)]
pub struct Harvest {
    /// The counts.
    pub totals: Totals,
    /// The faults, without duplicates.
    pub findings: Vec<Finding>,
}

/// The state shared between threads.
#[derive(Default)]
struct State {
    harvest: Harvest,
    /// The number of runs of each target that have been handed out.
    given: BTreeMap<Target, u64>,
}

impl Campaign<'_> {
    /// Runs on `threads` threads, each with one worker at a time.
    ///
    /// # Errors
    /// The first error of any thread: a worker cannot be started, or no file fits a target.
    pub fn run(&self, threads: usize) -> Result<Harvest> {
        let state = Mutex::new(State::default());
        let results: Vec<Result<()>> = thread::scope(|scope| {
            let all: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(|| self.work(&state))).collect();
            let joined = all
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            joined.collect()
        });
        results.into_iter().collect::<Result<()>>()?;
        Ok(state.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()).harvest)
    }

    /// Takes slices until the end.
    fn work(&self, state: &Mutex<State>) -> Result<()> {
        while let Some(slice) = self.take(state) {
            self.finish(slice, state)?;
        }
        Ok(())
    }

    /// Runs a slice; if a run ends the worker, a new one continues after that run.
    fn finish(&self, mut slice: Slice, state: &Mutex<State>) -> Result<()> {
        while !slice.runs.is_empty() && !self.is_over() {
            let begin = Instant::now();
            let seen = self.runner.slice(&slice)?;
            let seconds = begin.elapsed().as_secs_f64();
            let count = Count { runs: seen.runs, since_finding: seen.runs, findings: 0, seconds };
            locked(state).harvest.totals.add(slice.target, count);
            slice.runs.start = seen.last.map_or(slice.runs.end, |last| last + 1);
            for failed in &seen.failures {
                self.judge(slice.target, failed, state)?;
            }
        }
        Ok(())
    }

    /// Returns `true` if the time is up.
    fn is_over(&self) -> bool {
        matches!(self.end, End::At(end) if Instant::now() >= end)
    }

    fn take(&self, state: &Mutex<State>) -> Option<Slice> {
        self.next(&mut locked(state))
    }

    /// Picks the target with the least weighted time, and hands out its next runs; `None` at the end.
    fn next(&self, state: &mut State) -> Option<Slice> {
        let open: Vec<Target> =
            self.targets.iter().copied().filter(|target| self.left(*target, state) > 0).collect();
        let spent = |target: &Target| state.harvest.totals.of(*target).seconds / weight(*target);
        let given = |target: &Target| state.given.get(target).copied().unwrap_or_default();
        let order = |a: &Target, b: &Target| spent(a).total_cmp(&spent(b)).then(given(a).cmp(&given(b)));
        let target = open.into_iter().min_by(order)?;
        let count = state.harvest.totals.of(target);
        let fitting = if count.runs == 0 { FIRST } else { (count.rate() * SLICE.as_secs_f64()) as u64 };
        let runs = fitting.clamp(1, MOST).min(self.left(target, state));
        let given = state.given.entry(target).or_default();
        let begin = self.first.get(&target).copied().unwrap_or_default() + *given;
        *given += runs;
        Some(Slice { target, seed: self.seed, runs: begin..begin + runs })
    }

    /// Returns the number of runs of a target still to be handed out.
    fn left(&self, target: Target, state: &State) -> u64 {
        match self.end {
            End::At(_) if self.is_over() => 0,
            End::At(_) => u64::MAX,
            End::Runs(runs) => {
                let wanted = if target.is_path() { runs.div_ceil(PATHS) } else { runs };
                wanted.saturating_sub(state.given.get(&target).copied().unwrap_or_default())
            }
        }
    }

    /// Turns a failure into a finding, unless it is known.
    fn judge(&self, target: Target, failed: &FailedRun, state: &Mutex<State>) -> Result<()> {
        let known =
            |finding: &Finding| finding.case.target == target && finding.failure.is_like(&failed.failure);
        if self.known.iter().chain(&locked(state).harvest.findings).any(known) {
            return Ok(());
        }
        let case = Case::of(target, Number { seed: self.seed, run: failed.run }, self.seeds)?;
        let finding = Finding { case, failure: failed.failure.clone() };
        let finding = finding.minimised(|case| self.runner.case(case))?;
        let mut state = locked(state);
        state.harvest.totals.add(target, Count { findings: 1, ..Count::default() });
        state.harvest.findings.push(finding);
        Ok(())
    }
}

/// Returns a target's share of the time: a bake exercises all the others.
fn weight(target: Target) -> f64 {
    match target {
        Target::Bake => 6.0,
        Target::Render | Target::Gltf | Target::Picture => 2.0,
        _ => 1.0,
    }
}

fn locked(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The counts of all targets.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    /// Counts by target.
    pub targets: BTreeMap<Target, Count>,
}

/// The counts of one target.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// Runs.
    pub runs: u64,
    /// Runs since the last finding.
    pub since_finding: u64,
    /// Distinct faults found.
    pub findings: u64,
    /// Seconds of processor time of one core.
    pub seconds: f64,
}

impl Totals {
    /// Reads the counts in a file; zero if the file does not exist.
    ///
    /// # Errors
    /// If the file exists but is not a valid file of counts.
    pub fn read(path: &Path) -> Result<Self> {
        if !path.exists() {
            return Ok(Self::default());
        }
        let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    /// Writes the counts.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        fs::write(path, text).with_context(|| path.display().to_string())
    }

    /// Returns the counts of a target.
    pub fn of(&self, target: Target) -> Count {
        self.targets.get(&target).copied().unwrap_or_default()
    }

    /// Adds to the counts of a target.
    pub fn add(&mut self, target: Target, more: Count) {
        self.targets.entry(target).or_default().add(more);
    }

    /// Returns a Markdown table: a row for each target, and one for all readers.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| target | runs | runs a second and core | findings | runs since the last |\n|---|---:|---:|---:|---:|\n",
        );
        let mut readers = Count::default();
        for (target, count) in &self.targets {
            line(&mut text, &target.name(), *count);
            if !target.is_path() {
                readers.add(*count);
            }
        }
        line(&mut text, "all readers", readers);
        text
    }
}

impl Count {
    /// Adds later counts.
    fn add(&mut self, later: Self) {
        let since = if later.findings > 0 { 0 } else { self.since_finding };
        *self = Self {
            runs: self.runs + later.runs,
            since_finding: since + later.since_finding,
            findings: self.findings + later.findings,
            seconds: self.seconds + later.seconds,
        };
    }

    /// Returns the runs per second of one core.
    pub fn rate(&self) -> f64 {
        if self.seconds > 0.0 { self.runs as f64 / self.seconds } else { 0.0 }
    }
}

fn line(text: &mut String, name: &str, count: Count) {
    let (runs, since) = (grouped(count.runs), grouped(count.since_finding));
    let _ = writeln!(text, "| {name} | {runs} | {:.0} | {} | {since} |", count.rate(), count.findings);
}

/// Formats a number with commas between thousands.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let parts: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|part| str::from_utf8(part).ok()).collect();
    parts.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_add_up_and_are_kept() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("totals.json");
        let mut totals = Totals::read(&path).unwrap();
        let count = |findings, since_finding| Count { runs: 1000, since_finding, findings, seconds: 0.5 };
        totals.add(Target::Obj, count(0, 1000));
        totals.add(Target::Obj, count(1, 300));
        totals.add(Target::Obj, count(0, 1000));
        totals.add(Target::Bake, count(0, 1000));
        assert_eq!(
            totals.of(Target::Obj),
            Count { runs: 3000, since_finding: 1300, findings: 1, seconds: 1.5 }
        );
        totals.write(&path).unwrap();
        assert_eq!(Totals::read(&path).unwrap(), totals);
        let table = totals.table();
        assert!(table.contains("| obj | 3,000 | 2000 | 1 | 1,300 |\n"), "{table}");
        assert!(
            table.ends_with("| all readers | 3,000 | 2000 | 1 | 1,300 |\n"),
            "bakes are not counted as readers: {table}"
        );
    }

    #[test]
    fn thousands_are_parted() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }
}
