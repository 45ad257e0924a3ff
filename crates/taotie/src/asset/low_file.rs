//! The mesh provided by the caller, as stored in its file.

use super::options::MeshSource;
use super::scan::{Scan, all_files, check_extent, is_gltf};
use super::space;
use crate::error::{Result, Warnings};
use crate::io::{self, Limits};
use crate::mesh::Mesh;
use crate::scene::{Material, Scene};
use std::path::PathBuf;

/// The contents of a mesh file.
pub(super) struct Read {
    pub scene: Scene,
    /// How it moves, if it does.
    pub moving: Option<&'static str>,
    /// `true` for glTF, which an asset can keep.
    pub is_gltf: bool,
    /// `true` if it is in metres, and was converted to the space of a scan in another unit.
    pub is_in_metres: bool,
    /// `true` if it has XMP metadata.
    pub has_xmp: bool,
    /// The names of its meshes; possibly fewer than meshes.
    pub names: Vec<String>,
    /// The limits within which it was read.
    pub limits: Limits,
    /// All files that it was read from, the mesh file first; empty in memory.
    pub files: Vec<PathBuf>,
}

/// Reads a given mesh into the scan's space. glTF is in metres unless its size shows that it is in the scan's unit,
/// which is noted.
pub(super) fn read(source: &MeshSource, scan: &Scan, warnings: &mut Warnings) -> Result<Read> {
    let mut read = as_it_is(source, scan.limits, warnings)?;
    if !read.is_gltf {
        return Ok(read);
    }
    match space::is_in_scan_unit(&read.scene, scan) {
        Some(unit) => {
            let name = source.name().unwrap_or_default();
            let what = format!(
                "{name}: glTF is in metres, but its size shows that it is in {unit} like the scan; read as such"
            );
            warnings.note(what, 1);
        }
        None => {
            space::from_metres(&mut read.scene, scan.unit())?;
            read.is_in_metres = space::root_scale(scan.unit()).is_some();
        }
    }
    Ok(read)
}

fn as_it_is(source: &MeshSource, limits: Limits, warnings: &mut Warnings) -> Result<Read> {
    match source {
        MeshSource::Mesh(mesh) => {
            let scene = Scene::of_mesh(Mesh::clone(mesh), Material::default())?;
            check_extent(&scene, "the low-poly mesh")?;
            let (names, files) = (Vec::new(), Vec::new());
            let (is_gltf, is_in_metres, has_xmp) = (false, false, false);
            Ok(Read { scene, moving: None, is_gltf, is_in_metres, has_xmp, names, limits, files })
        }
        MeshSource::File(path) => {
            let mut loaded = io::load_model_within(path, &limits)?;
            warnings.absorb(loaded.warnings);
            check_extent(&loaded.scene, &path.display().to_string())?;
            let is_gltf = is_gltf(loaded.format);
            let (moving, has_xmp) = (loaded.moving, !loaded.xmp.is_empty());
            let (names, files) = (loaded.mesh_names, all_files(path, &mut loaded.files));
            Ok(Read {
                scene: loaded.scene,
                moving,
                is_gltf,
                is_in_metres: false,
                has_xmp,
                names,
                limits,
                files,
            })
        }
    }
}
