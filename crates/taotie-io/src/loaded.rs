//! The content of a model file: its scene, the notes and facts about it, and its sets of materials.

use super::json::Json;
use std::collections::HashMap;
use std::hash::Hash;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::Mat4;
use taotie_engine::scene::animation::Rig;
use taotie_engine::scene::{Scene, SceneData};

/// The content of a model file: the scene, notes on corrections, and facts for a report about the file.
#[derive(Debug, Clone, Default)]
pub struct Loaded {
    /// The scene to draw.
    pub scene: Scene,
    /// `true` if the scene was changed after reading, such as its materials, so that it is not as in the file. Set it
    /// after changes: a packed scan is made from the file otherwise.
    pub is_edited: bool,
    /// Notes on content that was invalid or ignored, but not essential for rendering.
    pub warnings: Warnings,
    /// The format read: `glTF`, `GLB`, `OBJ`, `PLY`, `STL` or `FBX`.
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
    /// The objects that `scene.instances` belong to; none if the file has no objects.
    pub objects: Objects,
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

/// The contents of a glTF document, whether or not its scene shows them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GltfStructure {
    /// Nodes.
    pub nodes: usize,
    /// Meshes.
    pub meshes: usize,
    /// Primitives of all meshes.
    pub primitives: usize,
    /// Triangles of all primitives; each mesh counts once, however often it is shown.
    pub triangles: usize,
    /// Materials.
    pub materials: usize,
    /// The root nodes of the scene that show a mesh, directly or through a descendant.
    pub roots: Vec<RootNode>,
}

/// A root node of a glTF scene.
#[derive(Debug, Clone, PartialEq)]
pub struct RootNode {
    /// Its name, or `node` and its index.
    pub name: String,
    /// Transforms from the node's space to the world.
    pub world_from_node: Mat4,
}

/// The sets of materials that a file offers for one model: KHR_materials_variants.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Variants {
    pub(super) names: Vec<String>,
    /// The lists of materials by variant.
    pub(super) mappings: Vec<Mapping>,
    /// The mapping of each mesh of the scene; meshes beyond the end have none.
    pub(super) mapping_of_mesh: Vec<Option<usize>>,
    /// The material of each instance of the scene if no variant is chosen.
    pub(super) authored: Vec<usize>,
}

/// Variant and material, by ascending variant.
pub(super) type Mapping = Vec<(usize, usize)>;

impl Variants {
    /// Returns the names, in file order; empty if there are no variants.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Gives every instance of `scene` its material in the variant `name`. Anything that the variant does not mention
    /// gets the material without variants, so the order of calls does not matter. `scene` is the one that was loaded
    /// with this.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no variant with this name; the text lists the existing ones; also if `scene` is
    /// a different one that lacks the material.
    pub fn apply(&self, name: &str, scene: &mut Scene) -> Result<()> {
        let variant = self.names.iter().position(|known| known == name);
        let variant = variant
            .ok_or_else(|| Error::invalid(format!("unknown variant '{name}'"), self.what_there_is()))?;
        let chosen: Vec<Option<usize>> = self.mappings.iter().map(|m| material_in(m, variant)).collect();
        scene.edit(|scene| {
            for (instance, authored) in scene.instances.iter_mut().zip(&self.authored) {
                let mapping = self.mapping_of_mesh.get(instance.mesh).copied().flatten();
                instance.material = mapping.and_then(|mapping| chosen[mapping]).unwrap_or(*authored);
            }
        })
    }

    fn what_there_is(&self) -> String {
        match self.names.is_empty() {
            true => "the file has no variants".into(),
            false => {
                format!("expected one of: {}", self.names.join(", "))
            }
        }
    }
}

fn material_in(mapping: &Mapping, variant: usize) -> Option<usize> {
    let place = mapping.binary_search_by_key(&variant, |(variant, _)| *variant).ok()?;
    Some(mapping[place].1)
}

/// The objects of a model: nodes of glTF and FBX files, and objects, else groups, of OBJ files.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Objects {
    /// The name of each object; it may be empty.
    pub names: Vec<String>,
    /// The object of each of a scene's instances.
    pub of_instances: Arc<[u32]>,
}

impl Objects {
    /// Joins instances with the same key, each with the name of its object, in their order.
    pub(crate) fn joined<K: Eq + Hash>(instances: impl IntoIterator<Item = (K, String)>) -> Self {
        let (mut names, mut numbers) = (Vec::new(), HashMap::new());
        let number = |(key, name)| {
            *numbers.entry(key).or_insert_with(|| {
                names.push(name);
                names.len() as u32 - 1
            })
        };
        let of_instances = instances.into_iter().map(number).collect();
        Self { names, of_instances }
    }

    /// Returns the objects of several scenes in one.
    pub fn of_all(parts: impl IntoIterator<Item = Self>) -> Self {
        let (mut names, mut of_instances) = (Vec::new(), Vec::new());
        for part in parts {
            let first = names.len() as u32;
            of_instances.extend(part.of_instances.iter().map(|object| first + object));
            names.extend(part.names);
        }
        Self { names, of_instances: of_instances.into() }
    }
}
