//! What the manifest says of an asset: a line for each attempt.

use crate::input::InputFile;
use serde::{Deserialize, Serialize};
use std::path::Path;
use taotie::asset::{Figures, Met, Requirement, Warning};

/// The version of records and of the figures they are judged by. Assets whose record or figures have another one are judged
/// again.
pub const SCHEMA: u32 = 2;

/// What is said of a record with another schema.
pub const OUTDATED: &str = "judged by the figures of another version; run `taotie batch` to judge it again";

/// The end of an attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// All files are there, and all requirements are met.
    Done,
    /// All files are there; a figure is worse than is demanded.
    RequiredNotMet,
    /// It is too large for the memory or the limits that it may have.
    Refused,
    /// It could not be made: a broken file, a crash, a time limit.
    Failed,
}

/// An attempt at an asset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The version of this layout.
    pub schema: u32,
    /// The asset.
    pub id: String,
    /// How often it has been attempted, from 1.
    pub attempt: u32,
    /// The end of the attempt, seconds since 1970.
    pub ended: u64,
    /// The version of the program.
    pub version: String,
    /// The SHA-256 of the settings, but for requirements.
    pub settings: String,
    /// How it ended.
    pub state: State,
    /// Why it was not made, a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What people call it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The files that it is made of, the scan's own first.
    pub input: Vec<InputFile>,
    /// The whole time, seconds.
    pub seconds: f64,
    /// The time of each stage.
    pub stages: Vec<Stage>,
    /// The most memory that its process took.
    pub peak_bytes: Option<u64>,
    /// The memory that was foreseen.
    pub forecast_bytes: Option<u64>,
    /// What was measured, in short.
    pub figures: Option<ShortFigures>,
    /// What was demanded.
    pub require: Vec<Requirement>,
    /// How that was met, level by level.
    pub required: Vec<Met>,
    /// What was wrong and put right.
    pub warnings: Vec<Warning>,
    /// What was made.
    pub parts: Vec<Part>,
}

/// A stage of the work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its name.
    pub stage: String,
    /// Its time.
    pub milliseconds: f64,
}

/// Files of one kind that were made together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// `asset`, `thumbnail`, `turntable` or `viewer`.
    pub kind: String,
    /// Their content address.
    pub address: String,
    /// The files.
    pub files: Vec<FileEntry>,
    /// `true` where they were there already.
    #[serde(default)]
    pub reused: bool,
}

/// A file that was made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Its name in its object's folder.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// The SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// The figures of a proof that a list of assets shows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ShortFigures {
    /// Triangles of the scan.
    pub triangles_in: usize,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// Texels across and down.
    pub size: [u32; 2],
    /// Bytes of the scan's files.
    pub bytes_in: u64,
    /// Bytes of the asset's files.
    pub bytes_out: u64,
    /// Mean angle between the normals as seen, degrees.
    pub mean_angle: Option<f64>,
    /// Its 95th percentile.
    pub p95_angle: Option<f64>,
    /// The largest one.
    pub max_angle: Option<f64>,
    /// Mean difference of base colours as seen, CIEDE2000.
    pub mean_color: Option<f64>,
    /// The largest distance between the visible surfaces as a part of the diagonal, its upper bound.
    pub hausdorff: f64,
    /// The share of the visible surface where the other shows nothing, the worse of scan and asset.
    pub missed: f64,
}

impl ShortFigures {
    /// Shortens what was measured.
    pub fn of(figures: &Figures) -> Self {
        let finest = figures.finest();
        let angles = finest.and_then(|finest| finest.overview.angles);
        let angle =
            |of: fn(&taotie::compare::Summary) -> f64| angles.as_ref().map(|angles| of(&angles.summary));
        Self {
            bytes_in: figures.bytes_in,
            bytes_out: figures.bytes_out,
            mean_angle: angle(|summary| summary.mean),
            p95_angle: angle(|summary| summary.p95),
            max_angle: angle(|summary| summary.max),
            mean_color: finest.and_then(|finest| Some(finest.overview.color?.summary.mean)),
            hausdorff: finest.map_or(0.0, |finest| finest.hausdorff_of_diagonal.upper),
            missed: finest.map_or(0.0, |finest| finest.coverage.missed()),
            ..Self::default()
        }
    }
}

impl State {
    /// All states, the best first.
    pub const ALL: [Self; 4] = [Self::Done, Self::RequiredNotMet, Self::Refused, Self::Failed];

    /// Returns the state's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::RequiredNotMet => "required-not-met",
            Self::Refused => "refused",
            Self::Failed => "failed",
        }
    }

    /// Returns the state of an asset that is there.
    pub fn of(required: &[Met]) -> Self {
        if required.iter().all(|met| met.met) { Self::Done } else { Self::RequiredNotMet }
    }

    /// Says whether the asset is there.
    pub fn is_made(self) -> bool {
        matches!(self, Self::Done | Self::RequiredNotMet)
    }
}

impl Record {
    /// Returns the part of a kind.
    pub fn part(&self, kind: &str) -> Option<&Part> {
        self.parts.iter().find(|part| part.kind == kind)
    }

    /// Returns `true` if it was judged by the figures of this version.
    pub fn is_current(&self) -> bool {
        self.schema == SCHEMA
    }

    /// Says whether the files that it was made of are as they were, as far as the system tells without reading them. Their paths
    /// are relative to `folder`.
    pub fn has_same_input(&self, folder: &Path) -> bool {
        !self.input.is_empty() && self.input.iter().all(|file| file.is_unchanged(folder))
    }
}
