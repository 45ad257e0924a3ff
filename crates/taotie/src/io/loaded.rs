//! The content of a model file.

use super::json::Json;
use super::structure::GltfStructure;
use super::variants::Variants;
use crate::error::{Error, Result, Warnings};
use crate::scene::animation::Rig;
use crate::scene::{Scene, SceneData};
use std::path::{Path, PathBuf};

/// The content of a model file: the scene, notes on corrections, and facts for a report about the file.
#[derive(Debug, Clone, Default)]
pub struct Loaded {
    /// The scene to draw.
    pub scene: Scene,
    /// Notes on content that was invalid or ignored, but not essential for rendering.
    pub warnings: Warnings,
    /// The format read: `glTF`, `GLB`, `OBJ`, `PLY` or `STL`.
    pub format: &'static str,
    /// The program that wrote the file, if the file specifies it.
    pub generator: Option<String>,
    /// The rights notice in the file.
    pub copyright: Option<String>,
    /// XMP packets in the file as JSON-LD, the one for the whole asset first; see [`super::Provenance`].
    pub xmp: Vec<Json>,
    /// glTF extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// glTF extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// Names of `scene.meshes`, in the same order; shorter if the file has no names. A mesh of an OBJ file has the
    /// names of the objects, or else groups, of its faces.
    pub mesh_names: Vec<String>,
    /// Files or names of `scene.textures`, in the same order.
    pub texture_names: Vec<String>,
    /// Further files that the model was read from, including those that could not be parsed.
    pub files: Vec<PathBuf>,
    /// The total size of the file and of `files` in bytes; `None` for a model that was not read from a file.
    pub bytes: Option<u64>,
    /// The contents of the glTF document, drawn or not; `None` for other formats.
    pub structure: Option<GltfStructure>,
    /// Files that the model refers to and that do not exist.
    pub missing_files: Vec<String>,
    /// The rig that moves the scene, if the file has animations; the scene itself is at rest.
    pub rig: Option<Rig>,
    /// How the file's model moves: `a skin`, `morph targets` or `animations`; the scene itself is at rest.
    pub moving: Option<&'static str>,
    /// The sets of materials that the file offers; none of them is applied to the scene itself.
    pub variants: Variants,
    /// The number of levels of detail in the file; [`super::load_levels`] reads all. 1 for formats without levels.
    pub levels: usize,
    /// The screen coverage of the object at which this level of detail is first shown, as specified in the file;
    /// `None` for the finest.
    pub coverage: Option<f32>,
}

impl Loaded {
    /// Creates a loaded scene with nothing more to report.
    pub fn new(scene: Scene, warnings: Warnings, format: &'static str) -> Self {
        Self { scene, warnings, format, levels: 1, ..Self::default() }
    }
}

/// Checks the scene parts read from the file `path`.
pub(super) fn checked(path: &Path, parts: SceneData) -> Result<Scene> {
    Scene::new(parts).map_err(|error| match error {
        Error::Invalid { what, why } => Error::parse(path, what, why),
        other => other,
    })
}
