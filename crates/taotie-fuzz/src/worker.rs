//! The child process: runs cases one after another and reports how each ended. What a run may allocate is limited.

use crate::case::{Case, Failure, FailureKind, Number};
use crate::corpus::Seed;
use crate::target::{Subject, Target};
use anyhow::{Context, Result};
use cap::Cap;
use serde::{Deserialize, Serialize};
use std::alloc::System;
use std::collections::HashMap;
use std::io::{self, Write};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use tempfile::TempDir;

/// The news that a child reports, one line of JSON each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum News {
    /// A run has started.
    Run(u64),
    /// The current run failed, and the process continues.
    Failed(Failure),
    /// All runs are done.
    Done,
}

/// The state of a child process.
pub struct Worker<'a> {
    seeds: &'a [Seed],
    /// Bytes that a run may allocate.
    memory: usize,
    /// The folders of seeds, each with the files that the seed references.
    folders: HashMap<String, TempDir>,
}

/// The location of the last panic.
static PLACE: Mutex<String> = Mutex::new(String::new());

impl<'a> Worker<'a> {
    /// Creates a worker and limits the process.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn new(seeds: &'a [Seed], memory: usize) -> Result<Self> {
        bound_process(memory as u64).context("could not limit the memory of the process")?;
        std::panic::set_hook(Box::new(|info| {
            let place = info.location().map(|at| format!("{}:{}", at.file(), at.line())).unwrap_or_default();
            *PLACE.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = place;
        }));
        Ok(Self { seeds, memory, folders: HashMap::new() })
    }

    /// Runs the cases of these numbers.
    ///
    /// # Errors
    /// If files cannot be written, or nobody is listening.
    pub fn runs(&mut self, target: Target, seed: u64, runs: Range<u64>) -> Result<()> {
        for run in runs {
            let case = Case::of(target, Number { seed, run }, self.seeds)?;
            self.run(&case, run)?;
        }
        send(&News::Done)
    }

    /// Runs one case.
    ///
    /// # Errors
    /// As [`Self::runs`].
    pub fn run_one(&mut self, case: &Case) -> Result<()> {
        self.run(case, 0)?;
        send(&News::Done)
    }

    fn run(&mut self, case: &Case, run: u64) -> Result<()> {
        let sound = case.sound(self.seeds)?;
        let bytes = case.bytes(self.seeds)?;
        let folder = self.folder(sound)?;
        let path = folder.join(sound.file_name());
        std::fs::write(&path, &bytes).with_context(|| path.display().to_string())?;
        send(&News::Run(run))?;
        allow_memory(self.memory);
        let subject = Subject { path: &path, bytes: &bytes, variant: case.variant };
        let held = catch_unwind(AssertUnwindSafe(|| case.target.run(&subject)));
        allow_memory(usize::MAX);
        let failure = match held {
            Ok(Ok(())) => return Ok(()),
            Ok(Err(promise)) => Failure { kind: FailureKind::Promise, message: promise },
            Err(panic) => Failure { kind: FailureKind::Panic, message: message(&*panic) },
        };
        let here = folder.display().to_string();
        send(&News::Failed(Failure { message: failure.message.replace(&here, ""), ..failure }))
    }

    /// Returns the folder of a seed, with the files that it references and an empty folder for output.
    fn folder(&mut self, seed: &Seed) -> Result<std::path::PathBuf> {
        if let Some(folder) = self.folders.get(&seed.name) {
            return Ok(folder.path().to_path_buf());
        }
        let folder = tempfile::tempdir()?;
        for file in &seed.companions {
            std::fs::write(folder.path().join(&file.name), &file.bytes)?;
        }
        std::fs::create_dir(folder.path().join("out"))?;
        let path = folder.path().to_path_buf();
        self.folders.insert(seed.name.clone(), folder);
        Ok(path)
    }
}

/// Returns the text and location of a panic.
fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message");
    let place = PLACE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    format!("{text} at {place}")
}

/// Sends news to the parent.
fn send(news: &News) -> Result<()> {
    let mut line = serde_json::to_string(news)?;
    line.push('\n');
    Ok(io::stdout().lock().write_all(line.as_bytes())?)
}

/// Counts the allocations of Rust code; beyond the limit they fail, as on a machine without more memory.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// The address space of the process beyond twice the limit: the allocator does not count C++ code and thread stacks,
/// and the system's own allocator keeps reserves for each thread.
#[cfg(target_os = "linux")]
const RESERVE: u64 = 8 << 30;

/// Allows allocating up to `bytes` more than is allocated now; `usize::MAX` means no limit.
fn allow_memory(bytes: usize) {
    // Fails only if the limit is below the current allocation.
    let _ = ALLOCATOR.set_limit(ALLOCATOR.allocated().saturating_add(bytes));
}

/// Limits the process as a whole, if the system supports it.
///
/// # Errors
/// If the system refuses.
#[cfg(target_os = "linux")]
fn bound_process(bytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let most = Some(bytes.saturating_mul(2).saturating_add(RESERVE));
    Ok(setrlimit(Resource::As, Rlimit { current: most, maximum: most })?)
}

/// Limits the process as a whole, if the system supports it.
///
/// # Errors
/// Never fails here.
#[cfg(not(target_os = "linux"))]
fn bound_process(_bytes: u64) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other tests allocate at the same time, so the limit is far above what they take.
    #[test]
    fn beyond_the_limit_there_is_no_memory() {
        allow_memory(256 << 20);
        assert!(Vec::<u8>::new().try_reserve_exact(512 << 20).is_err());
        let _ = ALLOCATOR.set_limit(usize::MAX);
        assert!(Vec::<u8>::new().try_reserve_exact(512 << 20).is_ok());
    }
}
