//! The content of a model file.

use super::json::Json;
use super::structure::GltfStructure;
use super::variants::Variants;
use crate::error::{Error, Result, Warnings};
use crate::scene::animation::Rig;
use crate::scene::{Scene, SceneData};
use std::path::{Path, PathBuf};

/// The content of a model file: the scene, notes on what was put right, and facts for a report about the file.
#[derive(Debug, Clone, Default)]
pub struct Loaded {
    /// The scene to draw.
    pub scene: Scene,
    /// Notes on content that was wrong or ignored, but could be drawn without.
    pub warnings: Warnings,
    /// The format read: `glTF`, `GLB`, `OBJ`, `PLY` or `STL`.
    pub format: &'static str,
    /// The program that wrote the file, where the file says so.
    pub generator: Option<String>,
    /// The rights notice in the file.
    pub copyright: Option<String>,
    /// XMP packets in the file as JSON-LD, that of the whole asset first; see [`super::Provenance`].
    pub xmp: Vec<Json>,
    /// glTF extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// glTF extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// Names of `scene.meshes`, in the same order; shorter where the file has no names. A mesh of an OBJ file has those of
    /// the objects, else groups, whose faces it holds.
    pub mesh_names: Vec<String>,
    /// Files or names of `scene.textures`, in the same order.
    pub texture_names: Vec<String>,
    /// Files that the model was read from beside its own, also those that could not be understood.
    pub files: Vec<PathBuf>,
    /// The size of the file and of `files` together, bytes; `None` for a model that was not read from a file.
    pub bytes: Option<u64>,
    /// The contents of the glTF document, drawn or not; `None` for other formats.
    pub structure: Option<GltfStructure>,
    /// Files that the model names and that are not there.
    pub missing_files: Vec<String>,
    /// The rig that moves the scene, where the file has animations; the scene itself is at rest.
    pub rig: Option<Rig>,
    /// The way in which the file's model moves: `a skin`, `morph targets` or `animations`; the scene itself is at rest.
    pub moving: Option<&'static str>,
    /// The sets of materials that the file offers; the scene itself has none of them applied.
    pub variants: Variants,
    /// How many levels of detail the file has; [`super::load_levels`] reads all. 1 where the format knows of none.
    pub levels: usize,
    /// The part of the screen that the object covers where this level of detail is first shown, as the file says; `None` of the
    /// finest.
    pub coverage: Option<f32>,
}

impl Loaded {
    /// Makes a loaded scene with nothing more to report.
    pub fn new(scene: Scene, warnings: Warnings, format: &'static str) -> Self {
        Self { scene, warnings, format, levels: 1, ..Self::default() }
    }
}

/// Checks the parts of the scene that the file `path` holds.
pub(super) fn checked(path: &Path, parts: SceneData) -> Result<Scene> {
    Scene::new(parts).map_err(|error| match error {
        Error::Invalid { what, why } => Error::parse(path, what, why),
        other => other,
    })
}
