//! What the driver and the process of an asset tell one another: a line of JSON each.

use crate::input::InputFile;
use crate::record::{Part, ShortFigures, Stage, State};
use crate::settings::Settings;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use taotie::asset::{Limits, Met, Warning};

/// The work of one process: an asset, as a whole.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// The asset.
    pub id: String,
    /// The scan's file.
    pub scan: PathBuf,
    /// The folder of the collection's files.
    pub output: PathBuf,
    /// What is made of it.
    pub settings: Settings,
    /// What reading may take and reach.
    pub limits: Limits,
    /// The most threads that it will get, by which its memory is foreseen.
    pub threads: usize,
    /// `false` where what is there already is made anew.
    pub reuse: bool,
}

/// The driver's word that a process may begin its work, once its memory is foreseen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Go {
    /// Threads.
    pub threads: usize,
}

/// What a process tells the driver.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "tell", rename_all = "kebab-case")]
pub enum Message {
    /// The address of what will be made.
    Address {
        /// The address.
        address: String,
    },
    /// The memory that the work will take; the process waits for [`Go`].
    Forecast {
        /// The memory.
        bytes: u64,
        /// Triangles of the scan.
        triangles: u64,
    },
    /// A stage begins.
    Stage {
        /// Its name.
        stage: String,
    },
    /// The end.
    Ended(Box<Outcome>),
}

/// What became of a job.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// How it ended.
    pub state: State,
    /// Why it was not made.
    pub error: Option<String>,
    /// The files that it is made of.
    pub input: Vec<InputFile>,
    /// The time of each stage.
    pub stages: Vec<Stage>,
    /// What was measured.
    pub figures: Option<ShortFigures>,
    /// What was demanded.
    pub required: Vec<Met>,
    /// What was wrong and put right.
    pub warnings: Vec<Warning>,
    /// What was made.
    pub parts: Vec<Part>,
    /// The most memory that the process took, where the system tells.
    pub peak_bytes: Option<u64>,
}
