//! Starts workers for ranges of runs and for single cases.

use crate::case::Case;
use crate::failure::Failure;
use crate::patience::Patience;
use crate::target::Target;
use crate::watch::{Seen, watch};
use anyhow::Result;
use std::ops::Range;
use std::path::PathBuf;
use std::process::Command;
use taotie::asset::Bytes;

/// Starts workers and limits them.
#[derive(Debug, Clone)]
pub struct Runner {
    /// A folder of additional sound files.
    pub models: Option<PathBuf>,
    /// The memory that a run may allocate.
    pub memory: Bytes,
    /// The time that a run may take.
    pub patience: Patience,
}

/// Runs of one target.
#[derive(Debug, Clone)]
pub struct Slice {
    /// The target.
    pub target: Target,
    /// The seed for all random numbers.
    pub seed: u64,
    /// The run numbers.
    pub runs: Range<u64>,
}

impl Runner {
    /// Runs a slice in one worker, which may end before all runs are done.
    ///
    /// # Errors
    /// If no worker can be started.
    pub fn slice(&self, slice: &Slice) -> Result<Seen> {
        let mut command = self.worker()?;
        command.args(["--target", &slice.target.name()]);
        let numbers = [slice.seed, slice.runs.start, slice.runs.end].map(|number| number.to_string());
        let [seed, from, to] = &numbers;
        command.args(["--seed", seed, "--from", from, "--to", to]);
        watch(command, "", self.patience)
    }

    /// Runs one case in a separate worker; `None` if nothing fails.
    ///
    /// # Errors
    /// If no worker can be started, or the case names a file that does not exist.
    pub fn case(&self, case: &Case) -> Result<Option<Failure>> {
        let seen = watch(self.worker()?, &serde_json::to_string(case)?, self.patience)?;
        Ok(seen.failures.into_iter().next().map(|failed| failed.failure))
    }

    /// Returns a command that starts this program as a worker. It uses one thread, since many workers run
    /// concurrently.
    fn worker(&self) -> Result<Command> {
        let mut command = Command::new(std::env::current_exe()?);
        command.args(["worker", "--memory", &self.memory.0.to_string()]);
        if let Some(models) = &self.models {
            command.arg("--models").arg(models);
        }
        command.env("RAYON_NUM_THREADS", "1").env_remove("RUST_BACKTRACE");
        Ok(command)
    }
}
