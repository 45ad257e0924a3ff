//! The storage of a collection's files: objects under their content addresses, and readable links to them.
//!
//! A content address is the SHA-256 of everything that files depend on. The description stored with an object
//! contains nothing that depends on the machine or on when it was made.

use crate::record::{ASSET, EstimateFigures, FileEntry, InputFile, PHOTOGRAPHS, Part, SCHEMA, ShortFigures};
use crate::settings::Task;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};
use taotie::Warning;
use taotie::asset::{Figures, Requirement, RequirementOutcome};
use taotie_engine::{Error, Result};
use taotie_io::{FileSet, read_bytes};

/// The file that marks an object as complete: it is written last.
const RESULT: &str = "object.json";

/// The part of an object's description that lists its files.
#[derive(Deserialize)]
struct Listed {
    files: Vec<FileEntry>,
}

/// The folder of a collection's files.
#[derive(Debug, Clone)]
pub struct Store {
    root: PathBuf,
}

impl Store {
    /// Creates a store in a folder, which need not exist yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// Returns the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Creates the folders that all objects share.
    ///
    /// # Errors
    /// [`Error::Io`] if the system refuses.
    pub fn make(&self) -> Result<()> {
        let folder = self.root.join("objects");
        fs::create_dir_all(&folder).map_err(|e| Error::io(folder, e))
    }

    /// Returns the folder of an object, relative to the root.
    pub fn folder(address: &str) -> String {
        format!("objects/{}/{address}", &address[..2.min(address.len())])
    }

    /// Returns the folder of an object.
    pub fn path(&self, address: &str) -> PathBuf {
        self.root.join(Self::folder(address))
    }

    /// Returns an object's description; `None` if it is missing, incomplete, or has another version's figures.
    pub fn object<T: Object>(&self, address: &str) -> Option<T> {
        let found: T = self.description(address)?;
        (found.is_current() && are_there(&self.path(address), found.files())).then_some(found)
    }

    /// Returns an object's description, whether or not its files exist.
    pub fn description<T: DeserializeOwned>(&self, address: &str) -> Option<T> {
        serde_json::from_slice(&read_bytes(&self.path(address).join(RESULT)).ok()?).ok()
    }

    /// Returns true if all files of a part exist with the right lengths, and the object lists them too.
    pub fn holds(&self, part: &Part) -> bool {
        let listed = |found: Listed| found.files == part.files;
        self.description(&part.address).is_some_and(listed)
            && are_there(&self.path(&part.address), &part.files)
    }

    /// Claims the folder of an object in a set of files; returns the folder.
    ///
    /// # Errors
    /// The errors of [`FileSet::claim_folder`].
    pub fn claim(&self, address: &str, files: &FileSet) -> Result<PathBuf> {
        let folder = self.path(address);
        if let Some(shared) = folder.parent() {
            fs::create_dir_all(shared).map_err(|e| Error::io(shared, e))?;
        }
        files.claim_folder(&folder)?;
        Ok(folder)
    }

    /// Marks an object as complete, once all its files are in place: an object without this mark is made again.
    /// `files` is a separate set, which signals can stop.
    ///
    /// # Errors
    /// Write errors.
    pub fn complete(&self, address: &str, object: &impl Object, files: &FileSet) -> Result<()> {
        let text = serde_json::to_string(object).expect("all keys are text");
        files.write_text(&self.path(address).join(RESULT), &text)?;
        files.commit()
    }

    /// Removes the remains of an object whose process was killed.
    pub fn sweep(&self, address: &str) {
        let folder = self.path(address);
        if folder.is_dir() {
            let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
            let inner = entries.map(|entry| entry.path()).filter(|path| path.is_dir());
            for folder in inner.chain([folder.clone()]) {
                let files = FileSet::new();
                let _ = files.claim_folder(&folder);
                drop(files);
                // A folder that is not empty stays.
                let _ = fs::remove_dir(&folder);
            }
        }
    }

    /// Creates `assets/ID/NAME` for each file: a link to the file in its object. Removes the links of other files, which
    /// earlier bakes made.
    ///
    /// # Errors
    /// [`Error::Io`] if the system refuses.
    pub fn link(&self, id: &str, parts: &[Part]) -> Result<()> {
        let folder = self.root.join("assets").join(id);
        fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
        // The way from assets/ID back to the root.
        let up = "../".repeat(1 + id.split('/').count());
        let files = parts.iter().flat_map(|part| part.files.iter().map(move |file| (part, file)));
        let mut names = Vec::new();
        for (part, file) in files.filter(|(_, file)| !file.name.contains('/')) {
            let target = format!("{up}{}/{}", Self::folder(&part.address), file.name);
            link(&target, &folder.join(&file.name)).map_err(|e| Error::io(folder.join(&file.name), e))?;
            names.push(file.name.as_str());
        }
        let objects = format!("{up}objects");
        remove_links(&folder, Path::new(&objects), &names).map_err(|e| Error::io(&folder, e))
    }
}

fn are_there(folder: &Path, files: &[FileEntry]) -> bool {
    files
        .iter()
        .all(|file| fs::metadata(folder.join(&file.name)).is_ok_and(|about| about.len() == file.bytes))
}

/// Creates a link atomically, replacing an earlier one.
#[cfg(unix)]
fn link(target: &str, path: &Path) -> std::io::Result<()> {
    if fs::read_link(path).is_ok_and(|there| there.as_os_str() == target) {
        return Ok(());
    }
    let temporary = path.with_file_name(format!(".taotie-link-{}", std::process::id()));
    let _ = fs::remove_file(&temporary);
    std::os::unix::fs::symlink(target, &temporary)?;
    fs::rename(&temporary, path)
}

/// Elsewhere, links need special rights; the page and the manifest name the objects themselves.
#[cfg(not(unix))]
fn link(_: &str, _: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Removes the links in a folder that [`Store::link`] created, except for those with these names: links to files of
/// their own name below `objects`.
fn remove_links(folder: &Path, objects: &Path, except: &[&str]) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let is_own = |target: PathBuf| target.starts_with(objects) && target.file_name() == Some(&*name);
        if !except.iter().any(|kept| name == *kept) && fs::read_link(entry.path()).is_ok_and(is_own) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// The description stored with an object.
pub trait Object: Serialize + DeserializeOwned {
    /// Returns its files, excluding the description itself.
    fn files(&self) -> &[FileEntry];
    /// Returns the kind of its files.
    fn kind(&self) -> &str;

    /// Returns `true` if its figures are those of this version.
    fn is_current(&self) -> bool {
        true
    }

    /// Converts it to a part of an asset.
    fn into_part(self, address: String, reused: bool) -> Part {
        Part { kind: self.kind().into(), address, files: self.files().to_vec(), reused }
    }
}

/// An asset with its proof.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AssetObject {
    /// `asset`.
    pub kind: String,
    /// The version of its figures, [`SCHEMA`].
    #[serde(default)]
    pub schema: u32,
    /// The version of the program.
    pub version: String,
    /// Triangles of the scan.
    pub triangles_in: usize,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// Texels across and down.
    pub size: [u32; 2],
    /// The measured figures.
    pub figures: Figures,
    /// Faults that were fixed.
    pub warnings: Vec<Warning>,
    /// Its files, the model first.
    pub files: Vec<FileEntry>,
}

/// Normals from photographs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EstimateObject {
    /// `photographs`.
    pub kind: String,
    /// The version of its figures, [`SCHEMA`].
    pub schema: u32,
    /// The version of the program.
    pub version: String,
    /// The figures.
    pub estimated: EstimateFigures,
    /// Doubts and corrections.
    pub warnings: Vec<Warning>,
    /// Its files.
    pub files: Vec<FileEntry>,
}

/// The result of a task: an asset, or an estimate.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(untagged)]
pub enum MainObject {
    /// A baked scan.
    Asset(Box<AssetObject>),
    /// Normals from photographs.
    Estimate(Box<EstimateObject>),
}

/// A file derived from an asset's own files.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DerivedObject {
    /// Its kind.
    pub kind: String,
    /// The version of the program.
    pub version: String,
    /// Its files.
    pub files: Vec<FileEntry>,
}

impl Object for AssetObject {
    fn files(&self) -> &[FileEntry] {
        &self.files
    }

    fn kind(&self) -> &str {
        &self.kind
    }

    fn is_current(&self) -> bool {
        self.schema == SCHEMA
    }
}

impl Object for EstimateObject {
    fn files(&self) -> &[FileEntry] {
        &self.files
    }

    fn kind(&self) -> &str {
        &self.kind
    }

    fn is_current(&self) -> bool {
        self.schema == SCHEMA
    }
}

impl Object for MainObject {
    fn files(&self) -> &[FileEntry] {
        match self {
            Self::Asset(asset) => asset.files(),
            Self::Estimate(estimate) => estimate.files(),
        }
    }

    fn kind(&self) -> &str {
        match self {
            Self::Asset(asset) => asset.kind(),
            Self::Estimate(estimate) => estimate.kind(),
        }
    }

    fn is_current(&self) -> bool {
        match self {
            Self::Asset(asset) => asset.is_current(),
            Self::Estimate(estimate) => estimate.is_current(),
        }
    }
}

impl Object for DerivedObject {
    fn files(&self) -> &[FileEntry] {
        &self.files
    }

    fn kind(&self) -> &str {
        &self.kind
    }
}

impl AssetObject {
    /// Returns the figures shown in lists.
    pub fn short(&self) -> ShortFigures {
        ShortFigures {
            triangles_in: self.triangles_in,
            triangles: self.triangles.clone(),
            size: self.size,
            ..ShortFigures::of(&self.figures)
        }
    }
}

impl MainObject {
    /// Returns the figures of a bake that lists show.
    pub fn figures(&self) -> Option<ShortFigures> {
        match self {
            Self::Asset(asset) => Some(asset.short()),
            Self::Estimate(_) => None,
        }
    }

    /// Returns the figures of an estimate.
    pub fn estimated(&self) -> Option<EstimateFigures> {
        match self {
            Self::Asset(_) => None,
            Self::Estimate(estimate) => Some(estimate.estimated.clone()),
        }
    }

    /// Returns problems and corrections.
    pub fn warnings(&self) -> &[Warning] {
        match self {
            Self::Asset(asset) => &asset.warnings,
            Self::Estimate(estimate) => &estimate.warnings,
        }
    }

    /// Checks that requirements can be judged.
    ///
    /// # Errors
    /// As [`Requirement::check_unit`].
    pub fn check_unit(&self, require: &[Requirement]) -> Result<()> {
        match self {
            Self::Asset(asset) => Requirement::check_unit(require, asset.figures.unit),
            Self::Estimate(_) => Ok(()),
        }
    }

    /// Returns how requirements are met; estimates have none.
    pub fn evaluate(&self, require: &[Requirement]) -> Vec<RequirementOutcome> {
        match self {
            Self::Asset(asset) => asset.figures.evaluate(require),
            Self::Estimate(_) => Vec::new(),
        }
    }
}

impl EstimateObject {
    /// Describes an estimate whose files have been written; their lengths are added to its figures.
    pub fn of(mut estimated: EstimateFigures, warnings: Vec<Warning>, files: Vec<FileEntry>) -> Self {
        estimated.bytes_out = files.iter().map(|file| file.bytes).sum();
        Self { kind: PHOTOGRAPHS.into(), schema: SCHEMA, version: VERSION.into(), estimated, warnings, files }
    }
}

impl DerivedObject {
    /// Describes files that have been written, given as names and paths.
    ///
    /// # Errors
    /// Read errors.
    pub fn of(kind: &str, files: Vec<(String, PathBuf)>) -> Result<Self> {
        let files = entries(&files)?;
        Ok(Self { kind: kind.into(), version: VERSION.into(), files })
    }
}

/// Describes files that have been written, given as names and paths.
///
/// # Errors
/// Read errors.
pub fn entries(files: &[(String, PathBuf)]) -> Result<Vec<FileEntry>> {
    files.iter().map(|(name, path)| FileEntry::of(name, path)).collect()
}

/// The version of the program; files depend on it too.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Returns the address of a task's files: the hash of its input, its settings and the version.
pub fn address_of(task: &Task, input: &[InputFile]) -> String {
    let input: Vec<_> = input.iter().map(|file| [&file.name, &file.sha256]).collect();
    match task.with_names() {
        Task::Bake(settings) => hash_of(&(ASSET, VERSION, settings, input)),
        Task::Photometric(settings) => hash_of(&(PHOTOGRAPHS, VERSION, settings, input)),
    }
}

/// Returns the address of files derived from the asset with the address `asset`.
pub fn address_of_derived(kind: &str, settings: &impl Serialize, asset: &str) -> String {
    hash_of(&(kind, VERSION, settings, asset))
}

/// Returns the SHA-256 of a value as JSON, hexadecimal. Struct fields are hashed in declaration order.
pub fn hash_of(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value).expect("all keys are text");
    taotie_io::sha256_of(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::AssetSettings;
    use taotie::asset::{BakeOptions, MeshSource};

    fn file(name: &str, sha256: &str) -> InputFile {
        InputFile { name: name.into(), sha256: sha256.into(), bytes: 1, ..InputFile::default() }
    }

    #[test]
    fn an_address_depends_on_content_names_and_options_and_on_no_folder() {
        let settings = |path: &str| AssetSettings {
            bake: BakeOptions { low: Some(MeshSource::File(path.into())), ..BakeOptions::default() },
            ..AssetSettings::default()
        };
        let low = |path: &str| Task::Bake(Box::new(settings(path)));
        let reported = Task::Bake(Box::new(AssetSettings { report: true, ..settings("a/low.glb") }));
        let address = address_of(&low("a/low.glb"), &[file("x.ply", "1")]);
        assert_eq!(address.len(), 64);
        assert_eq!(address, address_of(&low("b/low.glb"), &[file("x.ply", "1")]));
        let others = [
            address_of(&low("a/other.glb"), &[file("x.ply", "1")]),
            address_of(&low("a/low.glb"), &[file("y.ply", "1")]),
            address_of(&low("a/low.glb"), &[file("x.ply", "2")]),
            address_of(&low("a/low.glb"), &[file("x.ply", "1"), file("x.png", "1")]),
            address_of(&reported, &[file("x.ply", "1")]),
        ];
        assert!(others.iter().all(|other| *other != address));
        assert_ne!(
            address_of_derived("thumbnail", &1, &address),
            address_of_derived("turntable", &1, &address)
        );
    }
}
