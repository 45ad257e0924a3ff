//! glTF 2.0, `.gltf` and `.glb`: the scene in its rest pose, and its animations.
//!
//! The `gltf` crate provides the JSON types; every index, range and number in it is checked here, so that a file with
//! one defect is drawn without the defective part, or rejected with a one-line error.

mod accessor;
mod content;
mod document;
#[cfg(feature = "draco")]
mod draco;
mod geometry;
mod materials;
mod meshes;
mod meshopt;
mod nodes;
mod primitives;
mod raw;
mod resources;
mod statistics;
mod textures;

pub(super) use content::{Content, POLYGONS, StoredAttribute, StoredTrack, StoredVertices, missing_tangents};
pub(super) use geometry::compact;
pub use raw::GLTF_EXTENSIONS;
pub use raw::{GltfSource, StoredImage, StoredParts};
pub(super) use raw::{INSTANCING, OF_TEXTURES, is_known};
pub(super) use raw::{RawGltf, image_bytes, uses};
pub use statistics::{ContentSize, GltfSizes, ImageSize};

use super::json::Json;
use super::limits::Limits;
use super::loaded::{Loaded, Mapping, Objects, Variants, checked};
use super::reading::Reading;
use super::xmp;
use document::Document;
use meshes::Meshes;
use nodes::Nodes;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::error::{Result, Warnings};
use taotie_engine::math::Vec2;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::animation::{Deformed, Rig, RigData};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};
use textures::{Decoded, Textures};

/// Reads a `.gltf` or `.glb` file and everything it refers to, at its finest level of detail.
pub(super) fn read(reading: &Arc<Reading>) -> Result<Loaded> {
    let mut warnings = Warnings::default();
    let document = Document::open(reading, &mut warnings)?;
    finest(&document, warnings)
}

/// Reads a file like [`read`], and its bytes by content.
pub(super) fn read_with_sizes(reading: &Arc<Reading>) -> Result<(Loaded, GltfSizes)> {
    let mut warnings = Warnings::default();
    let document = Document::open(reading, &mut warnings)?;
    Ok((finest(&document, warnings)?, statistics::sizes_of(&document)))
}

/// Reads the bytes of a GLB that refers to no files, at its finest level of detail.
pub(super) fn read_glb(reading: &Arc<Reading>, content: Vec<u8>) -> Result<Loaded> {
    let mut warnings = Warnings::default();
    let document = Document::of(reading, content, &mut warnings)?;
    finest(&document, warnings)
}

fn finest(document: &Document, mut warnings: Warnings) -> Result<Loaded> {
    let shapes = Shapes::read(document, 0, &mut warnings)?;
    let looks = Looks::read(document, &mut warnings)?;
    shapes.loaded(document, looks, warnings)
}

/// Reads the XMP packets of a file, that of the whole asset first.
pub(super) fn read_xmp(path: &Path, limits: &Limits) -> Result<Vec<Value>> {
    let source = GltfSource::File(path);
    RawGltf::read(source, limits).map(|raw| xmp::packets(&raw.json))
}

/// Maximum number of levels of detail read together: each has its own meshes, and a short list may have many levels.
const MOST_LEVELS: usize = 64;

/// Reads a file at all its levels of detail, the finest first. Notes on the file as a whole are attached to the
/// finest level.
pub(super) fn read_levels(reading: &Arc<Reading>) -> Result<Vec<Loaded>> {
    let mut warnings = Warnings::default();
    let document = Document::open(reading, &mut warnings)?;
    let shapes = Shapes::read(&document, 0, &mut warnings)?;
    let count = shapes.nodes.levels;
    if count > MOST_LEVELS {
        let why = format!("{count} levels; the maximum is {MOST_LEVELS}");
        return Err(document.error("levels of detail", why));
    }
    let looks = Looks::read(&document, &mut warnings)?;
    let finest = shapes.loaded(&document, looks.clone(), warnings);
    let coarser = |level| {
        let mut warnings = Warnings::default();
        Shapes::read(&document, level, &mut warnings)?.loaded(&document, looks.clone(), warnings)
    };
    std::iter::once(finest).chain((1..count).map(coarser)).collect()
}

/// The nodes and meshes of one level of detail.
struct Shapes {
    nodes: Nodes,
    shown: Meshes,
}

/// The materials and textures of a file, shared by all its levels.
#[derive(Clone)]
struct Looks {
    /// The default material is last.
    materials: Vec<Material>,
    decoded: Decoded,
}

impl Looks {
    fn read(document: &Document, warnings: &mut Warnings) -> Result<Self> {
        /// Bytes per material in addition to those for parsing its text: as rendered, and as listed.
        const MATERIAL: u64 = 2048;
        if !document.reading.take(document.root.materials.len() as u64 * MATERIAL) {
            document.reading.check()?;
        }
        let mut textures = Textures::new(document);
        let mut materials = materials::read(document, &mut textures, warnings);
        let decoded = textures.decode(&mut materials, warnings)?;
        Ok(Self { materials, decoded })
    }
}

impl Shapes {
    fn read(document: &Document, level: usize, warnings: &mut Warnings) -> Result<Self> {
        let nodes = Nodes::resolve(document, level, warnings)?;
        let shown = meshes::build(document, &nodes, warnings)?;
        Ok(Self { nodes, shown })
    }

    /// Returns the level in its public form.
    fn loaded(self, document: &Document, looks: Looks, mut warnings: Warnings) -> Result<Loaded> {
        let Self { nodes, mut shown } = self;
        let (levels, coverage) = (nodes.levels, nodes.coverage);
        let Looks { mut materials, decoded } = looks;
        let Decoded { textures, names: texture_names, missing: missing_files } = decoded;
        let (meshes, mut instances) =
            (std::mem::take(&mut shown.meshes), std::mem::take(&mut shown.instances));
        let (mesh_names, variants) = (std::mem::take(&mut shown.names), std::mem::take(&mut shown.variants));
        drop_unused_default(&mut materials, &mut instances);
        let (light_nodes, lights) = nodes::lights(document, &nodes, &mut warnings).into_iter().unzip();
        let (camera_nodes, cameras) = nodes::cameras(document, &nodes, &mut warnings).into_iter().unzip();
        let mut scene = SceneData { meshes, materials, textures, instances, lights, cameras };
        add_missing_uvs(&mut scene, &variants, &mut shown.deformed, &mut warnings)?;
        let structure = statistics::structure(document, &nodes);
        let placed =
            shown.shown_by.iter().zip(scene.instances.iter().map(|instance| &mesh_names[instance.mesh]));
        let named = nodes.named_for_baking(document);
        let of_node = |node: usize| {
            let named = *named.get(node)?;
            document.root.nodes[named.unwrap_or(node)].name.clone()
        };
        let object = |(i, (node, mesh)): (usize, (&Option<usize>, &String))| {
            // Instances without a node are separate objects.
            (node.ok_or(i), node.and_then(of_node).unwrap_or_else(|| mesh.clone()))
        };
        let objects = Objects::joined(placed.enumerate().map(object));
        let hung = Hung { shown, cameras: camera_nodes, lights: light_nodes };
        let rig = hung.rig(document, nodes, &mut warnings)?;
        Ok(Loaded {
            mesh_names,
            objects,
            texture_names,
            missing_files,
            rig,
            variants,
            levels,
            coverage,
            structure: Some(structure),
            ..about(document, checked(&document.path, scene)?, warnings)
        })
    }
}

/// Returns a scene with the document's metadata.
fn about(document: &Document, scene: Scene, warnings: Warnings) -> Loaded {
    let root = &document.root;
    Loaded {
        generator: root.asset.generator.clone(),
        copyright: root.asset.copyright.clone(),
        xmp: document.xmp.iter().cloned().map(Json).collect(),
        extensions_used: root.extensions_used.clone(),
        extensions_required: root.extensions_required.clone(),
        files: files(document),
        moving: moving(document),
        ..Loaded::new(scene, warnings, document.format)
    }
}

/// Returns the existing files that the document refers to.
fn files(document: &Document) -> Vec<PathBuf> {
    let buffers = document.root.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let images = document.root.images.iter().filter_map(|image| image.uri.as_deref());
    buffers.chain(images).filter_map(|uri| resources::file(uri, &document.reading)).collect()
}

/// Returns how the model moves: by a skin, by morph targets, or only by animations.
fn moving(document: &Document) -> Option<&'static str> {
    let root = &document.root;
    let mut primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    if root.nodes.iter().any(|node| node.skin.is_some()) {
        return Some("a skin");
    }
    if primitives.any(|primitive| primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty())) {
        return Some("morph targets");
    }
    (!document.animations.is_empty()).then_some("animations")
}

/// The meshes, cameras and lights of nodes.
struct Hung {
    shown: Meshes,
    cameras: Vec<usize>,
    lights: Vec<usize>,
}

impl Hung {
    /// Returns the rig; `None` if nothing moves.
    fn rig(self, document: &Document, nodes: Nodes, warnings: &mut Warnings) -> Result<Option<Rig>> {
        if document.animations.is_empty() {
            return Ok(None);
        }
        let Meshes { nodes: instances, deformed, skins, weights, .. } = self.shown;
        let mut nodes = nodes.nodes;
        weights.into_iter().for_each(|(node, weights)| nodes[node].weights = weights);
        let animations = nodes::animations(document, &nodes, warnings);
        let (cameras, lights) = (self.cameras, self.lights);
        Rig::new(RigData { nodes, skins, deformed, instances, cameras, lights, animations }).map(Some)
    }
}

/// Removes the default material, which is last, if no primitive needs it.
fn drop_unused_default(materials: &mut Vec<Material>, instances: &mut [Instance]) {
    let default = materials.len() - 1;
    if instances.iter().all(|i| i.material != default) {
        materials.pop();
    }
}

/// Gives each mesh every uv set that its materials use in any variant, since a file may promise more than it holds.
fn add_missing_uvs(
    scene: &mut SceneData,
    variants: &Variants,
    deformed: &mut [Deformed],
    warnings: &mut Warnings,
) -> Result<()> {
    let needed: Vec<usize> = scene.materials.iter().map(uv_sets_of).collect();
    let authored = scene.instances.iter().map(|instance| (instance.mesh, instance.material));
    // Of all materials that a mesh may get, the one with the most uv sets.
    let neediest = |mapping: &Mapping| mapping.iter().map(|(_, m)| *m).max_by_key(|m| needed[*m]);
    let neediest: Vec<Option<usize>> = variants.mappings.iter().map(neediest).collect();
    let offered = variants.mapping_of_mesh.iter().enumerate();
    let offered = offered.filter_map(|(mesh, mapping)| Some((mesh, neediest[(*mapping)?]?)));
    for (index, material) in authored.chain(offered) {
        let (material, needed) = (&scene.materials[material], needed[material]);
        let mesh = &mut scene.meshes[index];
        if needed <= mesh.uvs().len() {
            continue;
        }
        warnings.note(format!("'{}' uses uv sets that its mesh lacks; set to 0", material.name), 1);
        let mut data = std::mem::take(mesh).into_data();
        let zeros = vec![Vec2::default(); data.positions.len()];
        data.uvs.resize(needed, zeros);
        *mesh = Mesh::new(data)?;
        for Deformed { shape, .. } in deformed.iter_mut().filter(|d| d.mesh == index) {
            shape.base.uvs.resize(needed, vec![Vec2::default(); shape.base.positions.len()]);
        }
    }
    Ok(())
}

/// Returns one more than the highest uv set that a material uses.
fn uv_sets_of(material: &Material) -> usize {
    material.textures().into_iter().map(|texture| texture.uv_set + 1).max().unwrap_or(0)
}
