//! The settings of an object: its task, and the files made from its result.

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use taotie::asset::{BakeOptions, MeshSource, Packing, RayDistance, Requirement, ScanOptions, VerifyOptions};
use taotie_engine::{Error, Result};
use taotie_photometric::PhotometricOptions;

/// The files to make from an object, and the requirements on them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Settings {
    /// The work itself.
    pub task: Task,
    /// The thumbnail; `None` for none.
    pub thumbnail: Option<Thumbnail>,
    /// The turntable animation; `None` for none.
    pub turntable: Option<Turntable>,
    /// The page that shows it in a browser; `None` for none.
    pub viewer: Option<ViewerPage>,
    /// Requirements on its figures. No file depends on them.
    pub require: Vec<Requirement>,
}

/// The work on an object, with everything that its files depend on in addition to its input.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// A scan is baked.
    Bake(Box<AssetSettings>),
    /// Normals are estimated from photographs.
    Photometric(PhotometricSettings),
}

/// Everything that the files of an estimate depend on in addition to the photographs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhotometricSettings {
    /// The options of the estimate.
    pub options: PhotometricOptions,
    /// `true` to write the figures as a page too.
    pub report: bool,
}

/// Everything that the files of an asset depend on in addition to its input.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct AssetSettings {
    /// How to read the scan.
    pub scan: ScanOptions,
    /// How to bake.
    pub bake: BakeOptions,
    /// How to pack it into files.
    pub packing: Packing,
    /// How to measure.
    pub verify: VerifyOptions,
    /// `true` to write the figures as a page too.
    pub report: bool,
}

/// A picture of an asset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Thumbnail {
    /// Pixels along a side, 16 to 2048.
    pub size: u32,
}

/// An animation of an asset that turns once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Turntable {
    /// Pixels along a side, 16 to 2048.
    pub size: u32,
    /// Frames per turn, 2 to 360.
    pub frames: u32,
}

/// A page that shows an asset in a browser.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViewerPage {}

impl Default for Thumbnail {
    fn default() -> Self {
        Self { size: 256 }
    }
}

impl Default for Turntable {
    fn default() -> Self {
        Self { size: 256, frames: 36 }
    }
}

impl Settings {
    /// Checks the settings, before any work begins.
    ///
    /// # Errors
    /// [`Error::Invalid`], and errors of the file that [`Packing::provenance`] names.
    pub fn check(&self) -> Result<()> {
        match &self.task {
            Task::Bake(asset) => {
                asset.scan.check()?;
                asset.bake.check()?;
                asset.packing.check()?;
            }
            Task::Photometric(settings) => settings.options.check()?,
        }
        let of_picture = self.thumbnail.map(|picture| ("thumbnail", picture.size));
        let of_turn = self.turntable.map(|turn| ("turntable", turn.size));
        let mut sizes = of_picture.into_iter().chain(of_turn);
        if let Some((what, size)) = sizes.find(|(_, size)| !(16..=2048).contains(size)) {
            return Err(Error::invalid(format!("{what}: a size of {size}"), "use 16 to 2048 pixels"));
        }
        match self.turntable {
            Some(Turntable { frames, .. }) if !(2..=360).contains(&frames) => {
                Err(Error::invalid(format!("turntable: {frames} frames"), "use 2 to 360"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the same settings with paths relative to `folder`.
    #[must_use]
    pub fn in_folder(mut self, folder: &Path) -> Self {
        self.task.paths_mut().into_iter().for_each(|path| *path = folder.join(&path));
        self
    }
}

impl Task {
    /// Returns all paths in the settings.
    fn paths_mut(&mut self) -> Vec<&mut PathBuf> {
        match self {
            Self::Bake(asset) => asset.paths_mut(),
            Self::Photometric(settings) => settings.options.paths_mut().collect(),
        }
    }

    /// Returns the same settings with file names in place of paths: the location of a collection must not affect the
    /// content addresses.
    #[must_use]
    pub fn with_names(&self) -> Self {
        let mut named = self.clone();
        for path in named.paths_mut() {
            *path = path.file_name().unwrap_or_default().into();
        }
        named
    }

    /// Sets the points of the proof of a bake, if given.
    pub fn take_points(&mut self, points: Option<usize>) {
        if let (Self::Bake(asset), Some(points)) = (self, points) {
            asset.verify.points = points;
        }
    }
}

impl AssetSettings {
    /// Returns the model files named in addition to the scan.
    pub fn meshes(&self) -> Vec<&Path> {
        let cage = match &self.bake.ray_distance {
            RayDistance::Cage(source) => Some(source),
            _ => None,
        };
        let files = self.bake.low.iter().chain(cage).filter_map(|source| match source {
            MeshSource::File(path) => Some(path.as_path()),
            MeshSource::Mesh(_) => None,
        });
        files.collect()
    }

    /// Returns all paths in the settings.
    fn paths_mut(&mut self) -> Vec<&mut PathBuf> {
        let BakeOptions { low, ray_distance, skew_mask, .. } = &mut self.bake;
        let cage = match ray_distance {
            RayDistance::Cage(source) => Some(source),
            _ => None,
        };
        let meshes = low.iter_mut().chain(cage).filter_map(|source| match source {
            MeshSource::File(path) => Some(path),
            MeshSource::Mesh(_) => None,
        });
        meshes.chain(skew_mask).chain(&mut self.packing.provenance).collect()
    }
}
