//! glTF 2.0, `.glb` and `.gltf`: one object with one material, whose triangles may have several alpha modes, in one
//! or more levels of detail.

mod codec;
mod draft;
mod edit;
mod format;
mod graft;
mod image_encoding;
mod join;
mod ktx;
mod material;
mod mesh;
mod pack;
mod scene;
mod stream;
mod textures;

pub use codec::{CodecKind, ImageCodec, TextureCodecs};
pub use draft::GltfDraft;
pub use format::{CodecSet, GltfFormat, VertexBits};
pub use graft::{EncodedModel, GltfGraft, GraftedMaterial, encode_graft};
pub use image_encoding::{LossyTexture, encode_jpeg_bitmap, encode_webp_bitmap};
pub use join::join_levels;
pub use material::{GltfImage, GltfMaterial};
pub use pack::{GltfPacker, PackedGeometry, PackedImage};
pub use scene::{WrittenScene, encode_scene, encode_scene_as, write_scene};
pub use textures::{gltf_sampler, sampler_constants};

use super::{FileBytes, FileSet};
use crate::json::Json;
use crate::xmp;
use draft::Container;
use material::MaterialParts;
use mesh::{Grid, MeshPart, PackedMesh};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::scene::AlphaMode;
use textures::{Encoded, ImageStorage};

/// The extension of levels of detail.
const LEVELS: &str = "MSFT_lod";

/// A model to be written as glTF. Every level has the same material and the same placement.
#[derive(Debug, Clone, Copy, Default)]
pub struct GltfAsset<'a> {
    /// The name of the node and the mesh; may be empty.
    pub name: &'a str,
    /// The mesh at each level of detail, the finest first; at least one. The origin of uvs is top left, as in glTF.
    pub levels: &'a [&'a Mesh],
    /// The minimum screen coverage of the object at which each level is shown, [0, 1]; empty if unspecified. Written if
    /// there are several levels.
    pub coverages: &'a [f32],
    /// The size of the meshes' unit in metres, by which a root node above each level scales; `None` if they are in
    /// metres.
    pub root_scale: Option<f32>,
    /// The material of all levels.
    pub material: GltfMaterial<'a>,
    /// The alpha mode of each triangle of each level, replacing the material's: each mode becomes a primitive with
    /// its own material. Empty if all triangles have the material's mode. The material's mode still determines
    /// whether the alpha of the base colour texture is written.
    pub alpha_modes: &'a [Vec<AlphaMode>],
    /// The rights notice.
    pub copyright: Option<&'a str>,
    /// An XMP packet as JSON-LD, such as [`Provenance::extend`](crate::Provenance::extend) makes.
    pub xmp: Option<&'a Json>,
    /// Further data for programs that recognise it; written to `asset.extras`.
    pub extras: Option<&'a Json>,
}

/// Writes a model: a GLB if `path` ends in `.glb`; for `.gltf` the JSON, with the data in `NAME.bin` and the textures
/// in files such as `NAME_color.png` next to it. Either all files are written or none, the JSON last. The same model
/// gives the same bytes. Returns the files written, `path` first.
///
/// # Errors
/// As [`encode_gltf`]; [`Error::Io`] if a file cannot be written.
pub fn write_gltf(path: &Path, asset: &GltfAsset, format: &GltfFormat) -> Result<Vec<PathBuf>> {
    let files = encode_gltf(path, asset, format)?;
    FileSet::one(|set| set.write_files(&files, Progress::SILENT))?;
    Ok(files.into_iter().map(|file| file.path).collect())
}

/// Returns the files that [`write_gltf`] would write, `path` first.
///
/// # Errors
/// [`Error::Unsupported`] for another extension and for float textures, [`Error::Invalid`] for a model that glTF
/// cannot express: no levels, a level without triangles, textures on a mesh without uvs, factors or a quality out of
/// range; [`Error::Limit`] for a GLB of 4 GiB or more.
pub fn encode_gltf(path: &Path, asset: &GltfAsset, format: &GltfFormat) -> Result<Vec<FileBytes>> {
    match Container::of(path)? {
        Container::Glb => Ok(vec![FileBytes { path: path.to_path_buf(), bytes: encode_glb(asset, format)? }]),
        Container::Gltf => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let encoded = textures::encode(&asset.material, format)?;
            let draft = draft(asset, format, (&encoded, &ImageStorage::Separate(&stem)))?;
            draft.into_files(path, encoded.into_iter().filter_map(|image| image.into_file(path)).collect())
        }
    }
}

/// Returns every file that [`write_gltf`] and [`join_levels`] may write for a model, with any textures of these kinds
/// and `coarser` coarser levels of detail; `path` first.
pub fn gltf_files(path: &Path, images: &[CodecKind], coarser: usize) -> Vec<PathBuf> {
    let mut files = vec![path.to_path_buf()];
    if let Ok(Container::Gltf) = Container::of(path) {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        files.push(path.with_file_name(format!("{stem}.bin")));
        let names = textures::possible_names(&stem, (images, coarser)).into_iter();
        files.extend(names.map(|name| path.with_file_name(name)));
    }
    files
}

/// Returns the bytes of the GLB that [`write_gltf`] would write.
///
/// # Errors
/// As [`encode_gltf`].
pub fn encode_glb(asset: &GltfAsset, format: &GltfFormat) -> Result<Vec<u8>> {
    GltfDraft::new(asset, format)?.encode_glb()
}

impl GltfDraft {
    /// Creates a GLB draft of the model, to which the caller may add content that a [`GltfAsset`] lacks, such as
    /// skins and animations. Node 0, mesh 0 and material 0 are those of the finest level, unless its triangles have
    /// their own alpha modes: then there is one material per mode.
    ///
    /// # Errors
    /// As [`encode_glb`].
    pub fn new(asset: &GltfAsset, format: &GltfFormat) -> Result<Self> {
        draft(asset, format, (&textures::encode(&asset.material, format)?, &ImageStorage::Inside))
    }
}

fn draft(
    asset: &GltfAsset,
    format: &GltfFormat,
    (images, storage): (&[Encoded], &ImageStorage),
) -> Result<GltfDraft> {
    check(asset)?;
    let mut draft = GltfDraft::begun(Value::Null, format.codecs);
    let meshes = asset.levels.iter().copied();
    let grid = format.meshopt.then(|| Grid::around(meshes, format.bits.positions));
    let modes = mesh::distinct_modes(asset.alpha_modes, asset.material.alpha);
    let mut meshes = Vec::new();
    for (i, mesh) in asset.levels.iter().copied().enumerate() {
        let each = asset.alpha_modes.get(i).map_or(&[][..], Vec::as_slice);
        let parts = MeshPart::by_mode(mesh, each, &modes);
        let primitives = match &grid {
            Some(grid) => {
                mesh::add_packed(&mut draft, PackedMesh { mesh, parts: &parts, grid, bits: format.bits })?
            }
            None => mesh::add(&mut draft, mesh, &parts),
        };
        meshes.push(named(asset, json!({ "primitives": primitives })));
    }
    let uses = images.iter().enumerate().flat_map(|(i, image)| image.uses(i, &asset.material));
    let parts = asset.material.parts(uses.collect());
    let material =
        |alpha: &AlphaMode| MaterialParts { alpha: Some(*alpha), ..parts.clone() }.into_json(&mut draft);
    let materials: Vec<Value> = modes.iter().map(material).collect();
    draft.json = json!({
        "asset": { "version": "2.0", "generator": concat!("taotie ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes(asset, grid.as_ref()),
        "meshes": meshes,
        "materials": materials,
    });
    if let Some(packet) = asset.xmp {
        draft.uses(xmp::EXTENSION);
        draft.json["asset"]["extensions"] = json!({ xmp::EXTENSION: { "packet": 0 } });
        draft.json["extensions"] = json!({ xmp::EXTENSION: { "packets": [packet.0] } });
    }
    if let Some(copyright) = asset.copyright {
        draft.json["asset"]["copyright"] = copyright.into();
    }
    if let Some(extras) = asset.extras {
        draft.json["asset"]["extras"] = extras.0.clone();
    }
    if asset.levels.len() > 1 {
        draft.uses(LEVELS);
    }
    let sampler = gltf_sampler(asset.levels.iter().copied());
    textures::add(&mut draft, images, storage, &sampler);
    Ok(draft)
}

fn named(asset: &GltfAsset, mut json: Value) -> Value {
    if !asset.name.is_empty() {
        json["name"] = asset.name.into();
    }
    json
}

/// Makes a node for each level, all with the same placement. The first, the only one in the scene, lists the others
/// and the minimum screen coverage of each. If they are scaled, each level's mesh has a separate node below: viewers
/// replace one level by another together with its subtree, whatever they do with nodes above. Source: MSFT_lod.
fn nodes(asset: &GltfAsset, grid: Option<&Grid>) -> Vec<Value> {
    let place = |mesh| {
        let mut node = named(asset, json!({ "mesh": mesh }));
        if let Some(grid) = grid {
            grid.place(&mut node);
        }
        node
    };
    let count = asset.levels.len();
    let placed = (0..count).map(place);
    let mut nodes: Vec<Value> = match asset.root_scale {
        None => placed.collect(),
        Some(scale) => {
            let scales = [edit::short(scale); 3];
            let root = |level| named(asset, json!({ "scale": scales, "children": [count + level] }));
            (0..count).map(root).chain(placed).collect()
        }
    };
    if count > 1 {
        nodes[0]["extensions"] = json!({ LEVELS: { "ids": (1..count).collect::<Vec<_>>() } });
        if !asset.coverages.is_empty() {
            let short: Vec<f64> = asset.coverages.iter().copied().map(edit::short).collect();
            nodes[0]["extras"] = json!({ "MSFT_screencoverage": short });
        }
    }
    nodes
}

fn check(asset: &GltfAsset) -> Result<()> {
    if asset.xmp.is_some_and(|packet| !packet.0.is_object()) {
        return Err(Error::invalid("XMP metadata", "expected a JSON object"));
    }
    if asset.root_scale.is_some_and(|scale| !(scale.is_finite() && scale > 0.0)) {
        return Err(Error::invalid("scale of the model", "must be a finite number above 0"));
    }
    if asset.levels.is_empty() {
        return Err(Error::invalid("model to write", "no meshes; specify at least one level"));
    }
    if !(asset.coverages.is_empty() || asset.coverages.len() == asset.levels.len()) {
        return Err(Error::invalid("screen coverages", "specify one per level, or none"));
    }
    for (i, mesh) in asset.levels.iter().enumerate() {
        if mesh.triangles().is_empty() {
            return Err(Error::invalid(format!("level {i}"), "glTF has no empty meshes; omit the level"));
        }
        if asset.coverages.get(i).is_some_and(|c| !(0.0..=1.0).contains(c)) {
            return Err(Error::invalid(format!("level {i}"), "the screen coverage is not in [0, 1]"));
        }
        if asset.material.has_maps() && mesh.uvs().is_empty() {
            let why = "no uvs, but the material has textures; unwrap the mesh or omit the textures";
            return Err(Error::invalid(format!("level {i}"), why));
        }
    }
    check_modes(asset)?;
    asset.material.check()
}

/// Checks that there is one mode per triangle, or none at all.
fn check_modes(asset: &GltfAsset) -> Result<()> {
    let counts = asset.levels.iter().map(|mesh| mesh.triangles().len());
    if !asset.alpha_modes.is_empty() && !asset.alpha_modes.iter().map(Vec::len).eq(counts) {
        return Err(Error::invalid("alpha modes", "specify one per triangle of each level, or none"));
    }
    asset.alpha_modes.iter().flatten().try_for_each(|mode| material::check_alpha(*mode))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_glb_is_one_file_and_a_gltf_has_a_buffer() {
        let files = |name: &str| gltf_files(name.as_ref(), &[CodecKind::WebP], 0);
        assert_eq!(files("vase.glb").len(), 1);
        assert_eq!(files("vase.gltf")[1], Path::new("vase.bin"));
    }
}
