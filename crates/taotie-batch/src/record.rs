//! Manifest records: one line per attempt at an asset, with the files that it is made from.

use crate::settings::{AssetSettings, PhotometricSettings};
use serde::{Deserialize, Serialize};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use taotie::asset::{Figures, Requirement, RequirementOutcome};
use taotie::{Limits, Warning};
use taotie_engine::{Error, Result};
use taotie_io::{file_size, load_model_within, sha256};
use taotie_photometric::input_files;

/// The version of records and of the figures they are judged by. Assets whose record or figures have a different
/// version are judged again.
pub const SCHEMA: u32 = 6;

/// The kind of an asset with its proof.
pub const ASSET: &str = "asset";

/// The kind of an estimate from photographs.
pub const PHOTOGRAPHS: &str = "photographs";

/// The message for a record with a different schema.
pub const OUTDATED: &str = "judged by another version's figures; run `taotie batch` to judge it again";

/// The outcome of an attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// All files exist, and all requirements are met.
    Done,
    /// All files exist, but a figure does not meet its requirement.
    RequiredNotMet,
    /// It exceeds the memory limit or another limit.
    Refused,
    /// It could not be made: a broken file, a crash, a time limit.
    Failed,
}

/// The most points of a proof: with them it needs about 50 MB more than the memory estimate, which is for the default.
const MOST_POINTS: usize = 500_000;

/// Returns the number of points that is likely to decide the undecided requirements of a proof with `points`; `None`
/// if none is undecided, or no number would decide them.
pub fn points_to_decide(required: &[RequirementOutcome], points: usize) -> Option<usize> {
    /// The safety factor, since intervals are estimates.
    const MARGIN: f64 = 1.5;
    let times = required.iter().map(RequirementOutcome::samples_to_decide).fold(1.0, f64::max);
    let (wanted, most) = (points as f64 * times * MARGIN, MOST_POINTS as f64);
    let can_decide = times > 1.0 && points < MOST_POINTS && wanted <= 4.0 * most;
    can_decide.then_some(wanted.min(most) as usize)
}

/// An attempt at an asset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The version of this layout.
    pub schema: u32,
    /// The asset.
    pub id: String,
    /// The attempt's number, from 1.
    pub attempt: u32,
    /// When the attempt ended, in seconds since 1970.
    pub ended: u64,
    /// The version of the program.
    pub version: String,
    /// The SHA-256 of the settings, except for requirements.
    pub settings: String,
    /// The outcome.
    pub state: State,
    /// Why it was not made, as a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Its title, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The folder or file of photographs, relative to the folder of the collection's file; missing for a scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub photographs: Option<PathBuf>,
    /// The files that it is made from, the scan's own first.
    pub input: Vec<InputFile>,
    /// The total time, in seconds.
    pub seconds: f64,
    /// The time of each stage.
    pub stages: Vec<Stage>,
    /// The peak memory of its process.
    pub peak_bytes: Option<u64>,
    /// The memory estimated beforehand.
    pub forecast_bytes: Option<u64>,
    /// The measured figures of a bake, in short.
    pub figures: Option<ShortFigures>,
    /// The figures of normals from photographs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated: Option<EstimateFigures>,
    /// Points of the proof, if the requirements needed more than the settings state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<usize>,
    /// The requirements.
    pub require: Vec<Requirement>,
    /// How each requirement was met, level by level.
    pub required: Vec<RequirementOutcome>,
    /// Faults that were fixed.
    pub warnings: Vec<Warning>,
    /// The parts that were made.
    pub parts: Vec<Part>,
}

/// A stage of the work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its name.
    pub stage: String,
    /// Its duration.
    pub milliseconds: f64,
}

/// Files of one kind that were made together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// `asset`, `photographs`, `thumbnail`, `turntable` or `viewer`.
    pub kind: String,
    /// Their content address.
    pub address: String,
    /// The files.
    pub files: Vec<FileEntry>,
    /// `true` if they already existed.
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

impl FileEntry {
    /// Describes a file that has been written.
    ///
    /// # Errors
    /// Read errors.
    pub fn of(name: &str, path: &Path) -> Result<Self> {
        Ok(Self { name: name.into(), bytes: file_size(path)?, sha256: sha256(path)? })
    }
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
    /// Mean colour difference as seen, CIEDE2000.
    pub mean_color: Option<f64>,
    /// The largest distance between the visible surfaces as a fraction of the diagonal: an upper bound.
    pub hausdorff: f64,
    /// The fraction of the visible surface where the other model shows nothing; the worse of scan and asset.
    pub missed: f64,
}

/// The figures of normals from photographs that a list of objects shows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct EstimateFigures {
    /// Photographs.
    pub photographs: usize,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Pixels with a normal.
    pub pixels: usize,
    /// The source of the lights: `lp`, `diligent`, `balls` or `relightable`.
    pub layout: String,
    /// Median of the degrees within which 68 % of the true normals are expected.
    pub sigma_median: Option<f64>,
    /// Their mean.
    pub sigma_mean: Option<f64>,
    /// Their 95th percentile.
    pub sigma_p95: Option<f64>,
    /// The largest root mean square residual of a photograph, relative to the albedo.
    pub worst_residual: Option<f64>,
    /// Bytes of the photographs and of the files of lights.
    pub bytes_in: u64,
    /// Bytes of all written files.
    pub bytes_out: u64,
}

impl ShortFigures {
    /// Summarises the figures.
    pub fn of(figures: &Figures) -> Self {
        let finest = figures.finest();
        let angles = finest.and_then(|finest| finest.overview.angles);
        let angle = |of: fn(&taotie_engine::compare::Summary) -> f64| {
            angles.as_ref().map(|angles| of(&angles.summary))
        };
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

    /// Returns the state of an asset that was made.
    pub fn of(required: &[RequirementOutcome]) -> Self {
        if required.iter().all(|met| met.met) { Self::Done } else { Self::RequiredNotMet }
    }

    /// Returns true if the asset was made.
    pub fn is_made(self) -> bool {
        matches!(self, Self::Done | Self::RequiredNotMet)
    }
}

impl Record {
    /// Returns the part of a given kind.
    pub fn part(&self, kind: &str) -> Option<&Part> {
        self.parts.iter().find(|part| part.kind == kind)
    }

    /// Returns the part with the result itself, which all others are made from.
    pub fn main(&self) -> Option<&Part> {
        self.part(ASSET).or_else(|| self.part(PHOTOGRAPHS))
    }

    /// Returns the path of the object: of its scan, or its folder or file of photographs.
    pub fn source(&self) -> Option<&Path> {
        self.photographs.as_deref().or_else(|| Some(self.input.first()?.path.as_path()))
    }

    /// Returns `true` if it was judged by the figures of this version.
    pub fn is_current(&self) -> bool {
        self.schema == SCHEMA
    }

    /// Returns true if the files that it was made from are unchanged, judging by size and modification time. Their
    /// paths are relative to `folder`.
    pub fn has_same_input(&self, folder: &Path) -> bool {
        !self.input.is_empty() && self.input.iter().all(|file| file.is_unchanged(folder))
    }
}

/// A file that an asset is made from.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its name, relative to the folder of the file that references it.
    pub name: String,
    /// Its path, relative to the folder of the collection's file.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// The time of its last change, nanoseconds since 1970.
    pub modified: u64,
    /// The SHA-256 of its bytes, hexadecimal; empty if it has not been read yet.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sha256: String,
    /// `true` if there is no such file, though the scan names it, such as a texture.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_missing: bool,
}

impl InputFile {
    /// Queries a file's metadata, without reading it.
    ///
    /// # Errors
    /// [`Error::Io`] if it does not exist.
    pub fn stat(path: &Path) -> Result<Self> {
        let about = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
        let since = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let modified = since.map_or(0, |since| since.as_nanos() as u64);
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, path: path.to_path_buf(), bytes: about.len(), modified, ..Self::default() })
    }

    /// Reads a file to hash it; its name is relative to `folder` if it is inside it.
    fn read(path: &Path, folder: &Path) -> Result<Self> {
        let known = Self::stat(path)?;
        let name = path.strip_prefix(folder).map_or(known.name, slashed);
        Ok(Self { name, sha256: sha256(path)?, ..known })
    }

    /// Describes a file that does not exist.
    pub fn missing(path: &Path) -> Self {
        Self { name: slashed(path), path: path.to_path_buf(), is_missing: true, ..Self::default() }
    }

    /// Returns true if the file is unchanged, judging by its size and modification time, or if it is still missing.
    pub fn is_unchanged(&self, folder: &Path) -> bool {
        match Self::stat(&folder.join(&self.path)) {
            Ok(now) => !self.is_missing && (now.bytes, now.modified) == (self.bytes, self.modified),
            Err(_) => self.is_missing,
        }
    }
}

/// Reads all files that an asset is made from: those of the scan, in order, then all that its settings name.
///
/// # Errors
/// Read errors.
pub fn read_input(scan: &[PathBuf], settings: &AssetSettings, limits: &Limits) -> Result<Vec<InputFile>> {
    let mut files = of_model(scan)?;
    for mesh in settings.meshes() {
        let mut others = load_model_within(mesh, limits)?.files;
        others.retain(|other| other != mesh);
        others.sort();
        others.dedup();
        files.extend(of_model(&[vec![mesh.to_path_buf()], others].concat())?);
    }
    for path in settings.bake.skew_mask.iter().chain(&settings.packing.provenance) {
        files.extend(of_model(std::slice::from_ref(path))?);
    }
    Ok(files)
}

/// Reads all files that an estimate is made from: those next to the photographs, then all that its settings name. Names of
/// files in a folder of photographs start with that folder's `name`, which the report shows.
///
/// # Errors
/// Read errors.
pub fn read_photographs(path: &Path, name: &str, settings: &PhotometricSettings) -> Result<Vec<InputFile>> {
    let mut files = of_model(&input_files(path)?)?;
    if path.is_dir() {
        files.iter_mut().for_each(|file| file.name = format!("{name}/{}", file.name));
    }
    for path in settings.options.files()? {
        files.extend(of_model(std::slice::from_ref(&path))?);
    }
    Ok(files)
}

fn of_model(files: &[PathBuf]) -> Result<Vec<InputFile>> {
    let folder = files.first().and_then(|file| file.parent()).unwrap_or(Path::new(""));
    files.iter().map(|file| InputFile::read(file, folder)).collect()
}

/// Returns a relative path with `/` as the separator, on every system; bytes that are not UTF-8 are percent-encoded.
pub fn slashed(path: &Path) -> String {
    path.components().map(|part| readable(part.as_os_str())).collect::<Vec<_>>().join("/")
}

fn readable(name: &OsStr) -> String {
    let chunks = name.as_encoded_bytes().utf8_chunks();
    let encoded = |bytes: &[u8]| bytes.iter().map(|byte| format!("%{byte:02X}")).collect::<String>();
    chunks.map(|chunk| format!("{}{}", chunk.valid(), encoded(chunk.invalid()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn names_that_are_not_utf_8_stay_distinct() {
        use std::os::unix::ffi::OsStrExt;
        let slashed = |bytes: &[u8]| slashed(Path::new(OsStr::from_bytes(bytes)));
        assert_eq!(slashed(b"r/\xe9\xc3.obj"), "r/%E9%C3.obj");
        assert_eq!(slashed("r/é.obj".as_bytes()), "r/é.obj");
    }

    #[test]
    fn all_files_of_a_model_are_read_and_a_change_is_seen() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        std::fs::create_dir(path("maps")).unwrap();
        std::fs::write(path("a.obj"), "v").unwrap();
        std::fs::write(path("maps/a.png"), "p").unwrap();
        let files = [path("a.obj"), path("maps/a.png")];
        let read = read_input(&files, &AssetSettings::default(), &Limits::default()).unwrap();
        let names: Vec<_> = read.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["a.obj", "maps/a.png"]);
        assert!(read.iter().all(|file| file.sha256.len() == 64 && file.is_unchanged(Path::new(""))));
        std::fs::write(path("a.obj"), "vv").unwrap();
        assert!(!read[0].is_unchanged(Path::new("")) && read[1].is_unchanged(Path::new("")));
        std::fs::remove_file(path("maps/a.png")).unwrap();
        assert!(!read[1].is_unchanged(Path::new("")));
    }
}
