//! Every parameter and every figure of a bake, as data.

use super::low::Origin;
use super::map_note::MapNote;
use super::maps_alone;
use super::options::MeshSource;
use super::parameters::Parameters;
use super::plan::Left;
use super::proof::Figures;
use super::requirement::Met;
use super::search_course::Trial;
use super::write::Written;
use crate::error::{Result, Warnings};
use std::path::PathBuf;

/// The version of the report's layout.
const SCHEMA: u32 = 3;

/// All that is to be told of a bake. What the caller knows, figures and times, is filled in by it.
///
/// ```
/// use taotie::Result;
/// use taotie::asset::{Proof, Report, Requirement, Written};
///
/// /// Collects all that is known of an asset.
/// fn report(written: &Written, proof: &Proof, wanted: &[Requirement]) -> Result<Report> {
///     let mut report = Report::of(written)?;
///     report.proof = Some(proof.figures.clone());
///     report.required = proof.require(wanted);
///     Ok(report)
/// }
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// The version of this layout.
    pub schema: u32,
    /// The kind of this report.
    pub kind: &'static str,
    /// The version of the program.
    pub version: &'static str,
    /// The scan's file.
    pub high: String,
    /// The SHA-256 of its bytes.
    pub high_sha256: String,
    /// Its triangles.
    pub high_triangles: usize,
    /// The low-poly mesh's file, or `None` where it was made.
    pub low: Option<String>,
    /// The origin of the low-poly mesh.
    pub origin: Origin,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// Texels across and down.
    pub size: [u32; 2],
    /// All else that was asked for.
    pub parameters: Parameters,
    /// The files written.
    pub files: Vec<PathBuf>,
    /// The kind and the place of each map.
    pub maps: Vec<MapNote>,
    /// The properties of the scan's material that the asset has, in words.
    pub carried: Vec<String>,
    /// The properties that it does not have.
    pub left: Vec<Left>,
    /// The measured figures; `None` where nothing was measured.
    pub proof: Option<Figures>,
    /// The requirements and their outcomes.
    pub required: Vec<Met>,
    /// The trials of a search, where an error was wanted.
    pub trials: Vec<Trial>,
    /// The duration of each stage.
    pub stages: Vec<StageTime>,
    /// The things that are wrong or were put right.
    pub warnings: Vec<Warning>,
}

/// A stage that is done, and how long it took.
///
/// ```
/// use taotie::asset::StageTime;
///
/// let stages = [("bake", 1500.0), ("store", 250.0)];
/// let stages = stages.map(|(stage, milliseconds)| StageTime { stage, milliseconds });
/// assert_eq!(stages.iter().map(|stage| stage.milliseconds).sum::<f64>(), 1750.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StageTime {
    /// The stage's name.
    pub stage: &'static str,
    /// Its time.
    pub milliseconds: f64,
}

/// A kind of warning, and how often it was seen.
///
/// ```
/// use taotie::Warnings;
/// use taotie::asset::Warning;
///
/// let mut warnings = Warnings::default();
/// warnings.note("open edges", 3);
/// let listed = Warning::list(&warnings);
/// assert_eq!((listed[0].count, listed[0].what.as_str()), (3, "open edges"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Warning {
    /// The number of times.
    pub count: usize,
    /// The warning.
    pub what: String,
}

impl Warning {
    /// Lists warnings in order of first sight.
    pub fn list(warnings: &Warnings) -> Vec<Self> {
        warnings.iter().map(|(what, count)| Self { count, what: what.to_owned() }).collect()
    }
}

impl Report {
    /// Tells of an asset that was written, not proved yet.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) where the scan's file cannot be read any more for its hash.
    pub fn of(written: &Written) -> Result<Self> {
        let asset = written.asset();
        let made = &asset.made;
        let warnings = [&made.warnings, &written.warnings].map(Warning::list).concat();
        Ok(Self {
            schema: SCHEMA,
            kind: "taotie bake",
            version: env!("CARGO_PKG_VERSION"),
            high: made.about.path.display().to_string(),
            high_sha256: made.about.sha256()?,
            high_triangles: made.about.size.triangles as usize,
            low: made.options.low.as_ref().and_then(MeshSource::path),
            origin: asset.origin().clone(),
            triangles: asset.levels().map(|mesh| mesh.triangles().len()).collect(),
            size: made.size,
            parameters: Parameters::new(&made.options, &made.about.options, &written.packing),
            files: written.files.clone(),
            maps: written.maps(),
            carried: carried(written),
            left: made.left.clone(),
            proof: None,
            required: Vec::new(),
            trials: made.trials.clone(),
            stages: Vec::new(),
            warnings,
        })
    }

    /// Returns `true` where all that was required is met.
    pub fn is_met(&self) -> bool {
        self.required.iter().all(|met| met.met)
    }
}

/// Returns the properties of the scan's material that the files hold.
fn carried(written: &Written) -> Vec<String> {
    let made = &written.asset().made;
    let all: Vec<_> = match written.is_alone() {
        true => maps_alone::carried(made).collect(),
        false => made.carried.clone(),
    };
    all.iter().map(|property| property.name().to_owned()).collect()
}
