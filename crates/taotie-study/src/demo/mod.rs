//! The demo's files: the vessel as models, its pictures by every surface method and shading model, the methods
//! measured against its relief as geometry, and the figures for pouring.
//!
//! ```no_run
//! use std::path::Path;
//! use taotie_io::FileSet;
//! use taotie_study::demo::{Output, Vessel, export, gallery};
//!
//! let (vessel, files) = (Vessel::new(2048), FileSet::new());
//! let output = Output { files: &files, folder: Path::new("."), side: 360 };
//! export::write(&output, &vessel)?;
//! let (sheet, pictures) = gallery::write_sheet(&vessel, &output, &|_done| ())?;
//! assert_eq!(pictures.len(), 16);
//! files.commit()?;
//! # Ok::<(), taotie_engine::Error>(())
//! ```

pub mod export;
pub mod gallery;
pub mod glb;
pub mod moving;
pub mod stage;
pub mod truth;

use crate::jue;
use std::path::Path;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::Scene;
use taotie_io::FileSet;

/// The jue with its relief as a tangent-space map, and the same with an object-space map.
pub struct Vessel {
    mesh: Mesh,
    scene: Scene,
    object_scene: Scene,
}

impl Vessel {
    /// Creates the vessel with maps of `size` × `size` texels; see [`jue::height_map`] for the range.
    pub fn new(size: u32) -> Self {
        let scene = jue::scene(size);
        Self { mesh: jue::low_mesh(), object_scene: jue::with_object_map(&scene, size), scene }
    }

    /// Returns the low mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the scene made by [`jue::scene`].
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the scene with its relief as an object-space map.
    pub fn object_scene(&self) -> &Scene {
        &self.object_scene
    }
}

/// The location and size of pictures.
#[derive(Debug, Clone, Copy)]
pub struct Output<'a> {
    /// The file set that the files belong to.
    pub files: &'a FileSet,
    /// The folder, which must exist.
    pub folder: &'a Path,
    /// The side of each picture on a contact sheet, pixels.
    pub side: u32,
}
