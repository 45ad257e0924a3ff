//! A run as data: its file, its changes, its options. A failed run is a finding, which is minimised, and kept as a
//! description that rebuilds its file.

use crate::corpus::Seed;
use crate::mutation::{self, Mutation};
use crate::target::Target;
use anyhow::{Context, Result};
use fastrand::Rng;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// A reproducible run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The reader, or a path that starts with one.
    pub target: Target,
    /// The name of the sound file.
    pub seed: String,
    /// The seed for the options of later steps.
    pub variant: u64,
    /// Its changes, in order.
    pub mutations: Vec<Mutation>,
}

/// The numbers that determine a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    /// Chosen by the caller; the same for all runs.
    pub seed: u64,
    /// The run's number.
    pub run: u64,
}

impl Case {
    /// Returns the case with a given number; deterministic for the same seeds.
    ///
    /// # Errors
    /// If no seed fits the target.
    pub fn of(target: Target, number: Number, seeds: &[Seed]) -> Result<Self> {
        let fitting: Vec<&Seed> = seeds.iter().filter(|seed| target.takes(seed)).collect();
        let mut rng = Rng::with_seed(mixed(mixed(number.seed ^ target as u64) ^ number.run));
        let seed = rng.choice(fitting).with_context(|| format!("no file for {}", target.name()))?;
        let variant = rng.u64(..1 << 32);
        Ok(Self {
            target,
            seed: seed.name.clone(),
            variant,
            mutations: mutation::choose(&mut rng, &seed.bytes),
        })
    }

    /// Returns the sound file.
    ///
    /// # Errors
    /// If it is not among `seeds`.
    pub fn sound<'a>(&self, seeds: &'a [Seed]) -> Result<&'a Seed> {
        let found = seeds.iter().find(|seed| seed.name == self.seed);
        found.with_context(|| format!("unknown seed {}; name its folder with --models", self.seed))
    }

    /// Returns the damaged file.
    ///
    /// # Errors
    /// As [`Self::sound`].
    pub fn bytes(&self, seeds: &[Seed]) -> Result<Vec<u8>> {
        Ok(mutation::changed(&self.sound(seeds)?.bytes, &self.mutations))
    }
}

/// Mixes the bits of a number (SplitMix64's finaliser), so that neighbouring numbers are uncorrelated.
fn mixed(number: u64) -> u64 {
    let number = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ (number >> 31)
}

/// The failure of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// How it failed.
    pub kind: FailureKind,
    /// The panic's message and location, the broken promise, or the last output of the process.
    pub message: String,
}

/// The ways a run can fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureKind {
    /// A panic reached the caller.
    Panic,
    /// An allocation would have exceeded the limit.
    Memory,
    /// The run did not end in time.
    Time,
    /// The process died.
    Abort,
    /// The library broke a promise.
    Promise,
}

impl Failure {
    /// Returns `true` if both are the same fault, judging by kind and message; digits in the message are ignored.
    pub fn is_like(&self, other: &Self) -> bool {
        let words = |failure: &Self| failure.message.replace(|c: char| c.is_ascii_digit(), "");
        self.kind == other.kind && (self.kind == FailureKind::Time || words(self) == words(other))
    }

    /// Returns the kind as a word.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            FailureKind::Panic => "panic",
            FailureKind::Memory => "memory",
            FailureKind::Time => "time",
            FailureKind::Abort => "abort",
            FailureKind::Promise => "promise",
        }
    }
}

/// A case that failed, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The case that reproduces it.
    #[serde(flatten)]
    pub case: Case,
    /// The failure at the time it was found.
    pub failure: Failure,
}

impl Finding {
    /// Removes changes as long as `fails` reports the same fault.
    ///
    /// # Errors
    /// The errors of `fails`.
    pub fn minimised(mut self, fails: impl Fn(&Case) -> Result<Option<Failure>>) -> Result<Self> {
        let mut at = self.case.mutations.len();
        while at > 0 {
            at -= 1;
            let mut smaller = self.case.clone();
            smaller.mutations.remove(at);
            if fails(&smaller)?.is_some_and(|failure| failure.is_like(&self.failure)) {
                self.case = smaller;
            }
        }
        Ok(self)
    }

    /// Writes the finding into a folder and returns its path.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn keep(&self, folder: &Path) -> Result<PathBuf> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        let sum = crc32fast::hash(text.as_bytes());
        let name = format!("{}-{}-{sum:08x}.json", self.case.target.name(), self.failure.kind_name());
        let path = folder.join(name);
        fs::create_dir_all(folder)?;
        fs::write(&path, text).with_context(|| path.display().to_string())?;
        Ok(path)
    }
}

/// Reads the findings in a folder, sorted by name; none if the folder does not exist.
///
/// # Errors
/// If a file cannot be read.
pub fn kept_findings(folder: &Path) -> Result<Vec<(PathBuf, Finding)>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<PathBuf>>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    paths.sort();
    paths.into_iter().map(|path| read_finding(&path).map(|finding| (path, finding))).collect()
}

/// Reads a finding.
///
/// # Errors
/// If the file cannot be read, or is not a finding.
pub fn read_finding(path: &Path) -> Result<Finding> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::seeds;
    use clap::ValueEnum;
    use std::collections::HashSet;

    #[test]
    fn a_number_gives_one_case_and_numbers_give_many() {
        let seeds = seeds(None).unwrap();
        for target in Target::value_variants() {
            let case = |run| Case::of(*target, Number { seed: 1, run }, &seeds).unwrap();
            assert_eq!(case(7), case(7));
            let files: HashSet<Vec<u8>> = (0..50).map(|run| case(run).bytes(&seeds).unwrap()).collect();
            assert!(files.len() > 20, "{target:?}: {}", files.len());
        }
    }

    #[test]
    fn numbers_do_not_make_a_fault_another() {
        let failure = |kind, message: &str| Failure { kind, message: message.into() };
        let panic = failure(FailureKind::Panic, "index 7 of 3 at a.rs:1");
        assert!(panic.is_like(&failure(FailureKind::Panic, "index 9 of 0 at a.rs:12")));
        assert!(!panic.is_like(&failure(FailureKind::Panic, "index 7 of 3 at b.rs:1")));
        assert!(!panic.is_like(&failure(FailureKind::Abort, "index 7 of 3 at a.rs:1")));
    }

    fn finding() -> Finding {
        let mutations = serde_json::from_str(
            r#"[{"lines":{"remove":{"line":1}}},"mend",{"bytes":{"truncate":{"at":9}}}]"#,
        );
        let case =
            Case { target: Target::Obj, seed: "ball.obj".into(), variant: 3, mutations: mutations.unwrap() };
        Finding { case, failure: Failure { kind: FailureKind::Panic, message: "index 3".into() } }
    }

    #[test]
    fn findings_are_kept_and_read() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("findings");
        assert!(kept_findings(&folder).unwrap().is_empty());
        let path = finding().keep(&folder).unwrap();
        assert_eq!(kept_findings(&folder).unwrap(), [(path, finding())]);
        fs::write(folder.join("wrong.json"), "{}").unwrap();
        assert!(kept_findings(&folder).is_err());
    }

    #[test]
    fn changes_that_do_not_matter_are_struck() {
        let guilty = finding().case.mutations[2].clone();
        let fails = |case: &Case| {
            let failure = Failure { kind: FailureKind::Panic, message: "index 12".into() };
            Ok(case.mutations.contains(&guilty).then_some(failure))
        };
        assert_eq!(finding().minimised(fails).unwrap().case.mutations, std::slice::from_ref(&guilty));
        let other = |_: &Case| Ok(Some(Failure { kind: FailureKind::Time, message: String::new() }));
        assert_eq!(finding().minimised(other).unwrap(), finding());
    }
}
