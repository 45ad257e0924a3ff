//! The messages between the driver and the process of an asset: one line of JSON each.

use crate::input::InputFile;
use crate::record::{Part, ShortFigures, Stage, State};
use crate::settings::Settings;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use taotie::asset::{Limits, RequirementOutcome, Warning};

/// The work of one process: one whole asset.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// The asset.
    pub id: String,
    /// The scan's file.
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
        /// Triangles of the scan.
        triangles: u64,
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
    /// The measured figures.
    pub figures: Option<ShortFigures>,
    /// How each requirement was met.
    pub required: Vec<RequirementOutcome>,
    /// Faults that were fixed.
    pub warnings: Vec<Warning>,
    /// The parts that were made.
    pub parts: Vec<Part>,
    /// The peak memory of the process, if the system reports it.
    pub peak_bytes: Option<u64>,
}
