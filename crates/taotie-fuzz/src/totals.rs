//! Counts over all sessions, kept in a file, and the table made from them.

use crate::target::Target;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

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
