//! The mesh that a caller brings, as its file says.

use super::options::MeshSource;
use super::scan::{all_files, check_extent};
use crate::error::{Result, Warnings};
use crate::io::{self, Limits};
use crate::mesh::Mesh;
use crate::scene::{Material, Scene};
use std::path::PathBuf;

/// The content of a file with a mesh.
pub(super) struct Read {
    pub scene: Scene,
    /// The way in which it moves, where it does.
    pub moving: Option<&'static str>,
    /// `true` for glTF, which an asset can keep.
    pub is_gltf: bool,
    /// `true` where it has XMP metadata.
    pub has_xmp: bool,
    /// The names of its meshes; may be fewer.
    pub names: Vec<String>,
    /// The limits within which it was read.
    pub limits: Limits,
    /// All files that it was read from, its own first; none in memory.
    pub files: Vec<PathBuf>,
}

/// Reads a mesh that is given.
pub(super) fn read(source: &MeshSource, limits: &Limits, warnings: &mut Warnings) -> Result<Read> {
    let limits = *limits;
    match source {
        MeshSource::Mesh(mesh) => {
            let scene = Scene::of_mesh(Mesh::clone(mesh), Material::default())?;
            check_extent(&scene, "the low-poly mesh")?;
            let (names, files) = (Vec::new(), Vec::new());
            Ok(Read { scene, moving: None, is_gltf: false, has_xmp: false, names, limits, files })
        }
        MeshSource::File(path) => {
            let mut loaded = io::load_model_within(path, &limits)?;
            warnings.absorb(loaded.warnings);
            check_extent(&loaded.scene, &path.display().to_string())?;
            let is_gltf = ["glTF", "GLB"].contains(&loaded.format);
            let (moving, has_xmp) = (loaded.moving, !loaded.xmp.is_empty());
            let (names, files) = (loaded.mesh_names, all_files(path, &mut loaded.files));
            Ok(Read { scene: loaded.scene, moving, is_gltf, has_xmp, names, limits, files })
        }
    }
}
