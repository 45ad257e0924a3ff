//! The process of an asset, as known to itself and to the driver: their messages, one line of JSON each, and its
//! memory.

use crate::record::{EstimateFigures, InputFile, Part, ShortFigures, Stage, State};
use crate::settings::Settings;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use taotie::asset::RequirementOutcome;
use taotie::{Bytes, Limits, Warning};

/// The work of one process: one whole asset.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// The asset.
    pub id: String,
    /// The scan's file, or the folder or file of photographs.
    pub scan: PathBuf,
    /// The folder for the collection's files.
    pub output: PathBuf,
    /// The settings of the asset.
    pub settings: Settings,
    /// The limits on memory and on which files may be read.
    pub limits: Limits,
    /// The most threads that it will get; its memory is estimated for that number.
    pub threads: usize,
    /// `false` to make existing files again.
    pub reuse: bool,
}

/// The driver's permission to begin baking, once the memory is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Go {
    /// Threads.
    pub threads: usize,
}

/// A message from a process to the driver.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "kebab-case")]
pub enum Message {
    /// The address of what will be made.
    Address {
        /// The address.
        address: String,
    },
    /// The memory that the work will need; the process waits for [`Go`].
    Forecast {
        /// The memory.
        bytes: u64,
        /// Triangles of the scan, or samples of the photographs.
        size: u64,
    },
    /// A stage has begun.
    Stage {
        /// Its name.
        stage: String,
    },
    /// The job has ended.
    Ended(Box<Outcome>),
}

/// The outcome of a job.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// The final state.
    pub state: State,
    /// Why it was not made.
    pub error: Option<String>,
    /// The files that it is made from.
    pub input: Vec<InputFile>,
    /// The time of each stage.
    pub stages: Vec<Stage>,
    /// The measured figures of a bake.
    pub figures: Option<ShortFigures>,
    /// The figures of normals from photographs.
    #[serde(default)]
    pub estimated: Option<EstimateFigures>,
    /// How each requirement was met.
    pub required: Vec<RequirementOutcome>,
    /// Faults that were fixed.
    pub warnings: Vec<Warning>,
    /// The parts that were made.
    pub parts: Vec<Part>,
    /// The peak memory of the process, if the system reports it.
    pub peak_bytes: Option<u64>,
}

impl Outcome {
    /// Returns the outcome of a job that did not finish.
    pub fn failed(error: impl Into<String>) -> Self {
        Self {
            state: State::Failed,
            error: Some(error.into()),
            input: Vec::new(),
            stages: Vec::new(),
            figures: None,
            estimated: None,
            required: Vec::new(),
            warnings: Vec::new(),
            parts: Vec::new(),
            peak_bytes: None,
        }
    }
}

/// Bytes that a process may use beyond twice its estimate: its program, the stacks of its threads, and the reserves
/// that the system's allocator keeps for each.
const RESERVE: u64 = 512 << 20;

/// Limits the memory of this process to twice its estimate plus [`RESERVE`], so that a far too low estimate ends the
/// process rather than the machine. On systems other than Linux there is no limit.
///
/// # Errors
/// System errors.
#[cfg(target_os = "linux")]
pub fn bound_process(forecast: Bytes) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let wanted = forecast.0.saturating_mul(2).saturating_add(RESERVE);
    // A limit that was already set still applies.
    let hard = getrlimit(Resource::Data).maximum;
    let most = Some(hard.map_or(wanted, |hard| hard.min(wanted)));
    Ok(setrlimit(Resource::Data, Rlimit { current: most, maximum: hard })?)
}

/// Limits the memory of this process, if the system supports it.
///
/// # Errors
/// Never fails here.
#[cfg(not(target_os = "linux"))]
pub fn bound_process(_: Bytes) -> std::io::Result<()> {
    let _ = RESERVE;
    Ok(())
}

/// Returns the peak memory of a process so far; `None` if the system does not report it.
pub fn peak_of(process: u32) -> Option<u64> {
    peak_in(&std::fs::read_to_string(format!("/proc/{process}/status")).ok()?)
}

/// Returns the peak memory of this process so far; `None` if the system does not report it.
pub fn own_peak() -> Option<u64> {
    peak_of(std::process::id())
}

fn peak_in(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kilobytes << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_of_what_the_system_says() {
        assert_eq!(peak_in("Name:\tx\nVmHWM:\t    2048 kB\nVmRSS:\t 1 kB\n"), Some(2 << 20));
        assert_eq!(peak_in("Name:\tx\n"), None);
        if cfg!(target_os = "linux") {
            assert!(own_peak().is_some_and(|bytes| bytes > 1 << 20));
        }
    }
}
