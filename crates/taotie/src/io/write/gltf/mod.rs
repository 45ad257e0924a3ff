//! glTF 2.0, `.glb` and `.gltf`: one object with one material, in one or more levels of detail.

mod container;
mod draft;
mod format;
mod graft;
mod images;
mod ktx;
mod layers;
mod material;
mod mesh;
mod number;
mod packed;
mod samplers;
mod scene;

pub use draft::GltfDraft;
pub use format::{GltfFormat, GltfImages};
pub use graft::{GltfGraft, GraftedMaterial, encode_graft};
pub use images::GltfImage;
pub use material::GltfMaterial;
pub use scene::{WrittenScene, encode_scene, write_scene};

use super::{FileBytes, write_files};
use crate::error::{Error, Result};
use crate::image::{Sampler, Wrap};
use crate::io::json::Json;
use crate::io::xmp;
use crate::math::Vec2;
use crate::mesh::Mesh;
use crate::progress::Progress;
use images::{Encoded, ImageStorage};
use packed::Grid;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The extension of levels of detail.
const LEVELS: &str = "MSFT_lod";

/// A model to be written as glTF. Every level has the same material and stands in the same place.
#[derive(Debug, Clone, Copy, Default)]
pub struct GltfAsset<'a> {
    /// The name of the node, the mesh and, in a `.gltf`, nothing else; may be empty.
    pub name: &'a str,
    /// The mesh at each level of detail, the finest first; at least one.
    pub levels: &'a [GltfLevel<'a>],
    /// The material of all levels.
    pub material: GltfMaterial<'a>,
    /// The rights notice.
    pub copyright: Option<&'a str>,
    /// An XMP packet as JSON-LD, such as [`Provenance::extend`](crate::io::Provenance::extend) makes.
    pub xmp: Option<&'a Json>,
    /// Further data for programs that know of it; goes into `asset.extras`.
    pub extras: Option<&'a Json>,
}

/// A mesh and the least size on screen at which it is drawn.
#[derive(Debug, Clone, Copy)]
pub struct GltfLevel<'a> {
    /// The mesh; its uv origin is top left, as in glTF.
    pub mesh: &'a Mesh,
    /// The least part of the screen that the object covers while this level is shown, [0, 1]. Written where every
    /// level has one and there are several.
    pub coverage: Option<f32>,
}

/// Writes a model: a GLB where `path` ends in `.glb`; for `.gltf` the JSON, with the numbers in `NAME.bin` and the
/// textures in files such as `NAME_color.png` beside it. Either all files are written or none, the JSON last. The
/// same model gives the same bytes. Returns the files written, `path` first.
///
/// # Errors
/// As [`encode_gltf`]; [`Error::Io`] where a file cannot be written.
pub fn write_gltf(path: &Path, asset: &GltfAsset, format: &GltfFormat) -> Result<Vec<PathBuf>> {
    let files = encode_gltf(path, asset, format)?;
    write_files(&files, Progress::SILENT)?;
    Ok(files.into_iter().map(|file| file.path).collect())
}

/// Returns the files that [`write_gltf`] would write, `path` first.
///
/// # Errors
/// [`Error::Unsupported`] for another extension and for float textures, [`Error::Invalid`] for a model that glTF cannot
/// express: no level, a level without triangles, textures on a mesh without uvs, factors or a quality out of range; [`Error::Limit`]
/// for a GLB of 4 GiB or more.
pub fn encode_gltf(path: &Path, asset: &GltfAsset, format: &GltfFormat) -> Result<Vec<FileBytes>> {
    match Container::of(path)? {
        Container::Glb => Ok(vec![FileBytes { path: path.to_path_buf(), bytes: encode_glb(asset, format)? }]),
        Container::Gltf => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let encoded = images::encode(&asset.material, format)?;
            let draft = draft(asset, format, (&encoded, &ImageStorage::Beside(&stem)))?;
            draft.into_files(path, encoded.into_iter().filter_map(|image| image.into_file(path)).collect())
        }
    }
}

/// The kinds of glTF files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Container {
    /// One binary file.
    Glb,
    /// JSON with files beside it.
    Gltf,
}

impl Container {
    fn of(path: &Path) -> Result<Self> {
        let extension =
            path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "glb" => Ok(Self::Glb),
            "gltf" => Ok(Self::Gltf),
            _ => Err(Error::unsupported(
                format!("{}: the extension '{extension}'", path.display()),
                "glTF is written as .glb and .gltf",
            )),
        }
    }
}

/// Returns the bytes of the GLB that [`write_gltf`] would write.
///
/// # Errors
/// As [`encode_gltf`].
pub fn encode_glb(asset: &GltfAsset, format: &GltfFormat) -> Result<Vec<u8>> {
    GltfDraft::new(asset, format)?.encode_glb()
}

impl GltfDraft {
    /// Makes a GLB draft of the model, to which the caller may add content that a [`GltfAsset`] lacks, such as skins
    /// and animations. Node 0, mesh 0 and material 0 are those of the finest level.
    ///
    /// # Errors
    /// As [`encode_glb`].
    pub fn new(asset: &GltfAsset, format: &GltfFormat) -> Result<Self> {
        draft(asset, format, (&images::encode(&asset.material, format)?, &ImageStorage::Inside))
    }
}

fn draft(
    asset: &GltfAsset,
    format: &GltfFormat,
    (images, storage): (&[Encoded], &ImageStorage),
) -> Result<GltfDraft> {
    check(asset)?;
    let mut draft = GltfDraft::default();
    let grid = format.meshopt.then(|| Grid::around(asset.levels.iter().map(|level| level.mesh)));
    let mut meshes = Vec::new();
    for level in asset.levels {
        let primitive = match &grid {
            Some(grid) => packed::add(&mut draft, level.mesh, grid)?,
            None => mesh::add(&mut draft, level.mesh),
        };
        meshes.push(named(asset, json!({ "primitives": [primitive] })));
    }
    draft.json = json!({
        "asset": { "version": "2.0", "generator": concat!("taotie ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes(asset, grid.as_ref()),
        "meshes": meshes,
        "materials": [material::json(&asset.material, images)],
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
    material::extensions(&asset.material).into_iter().for_each(|(name, _)| draft.uses(name));
    images::add(&mut draft, images, storage, &sampler(asset));
    Ok(draft)
}

/// Returns the sampler of all textures: trilinear, repeated where uvs leave [0, 1].
fn sampler(asset: &GltfAsset) -> Sampler {
    let is_inside = |uv: &Vec2| (0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y);
    let mut sets = asset.levels.iter().filter_map(|level| level.mesh.uvs().first());
    let wrap = if sets.all(|uvs| uvs.iter().all(is_inside)) { Wrap::Clamp } else { Wrap::Repeat };
    Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() }
}

fn named(asset: &GltfAsset, mut json: Value) -> Value {
    if !asset.name.is_empty() {
        json["name"] = asset.name.into();
    }
    json
}

/// Makes a node for each level, all in the same place. The first, which alone is in the scene, names the others and
/// says how large each must be seen. Source: MSFT_lod.
fn nodes(asset: &GltfAsset, grid: Option<&Grid>) -> Vec<Value> {
    let place = |mesh| {
        let mut node = named(asset, json!({ "mesh": mesh }));
        if let Some(grid) = grid {
            grid.place(&mut node);
        }
        node
    };
    let mut nodes: Vec<Value> = (0..asset.levels.len()).map(place).collect();
    if nodes.len() > 1 {
        nodes[0]["extensions"] = json!({ LEVELS: { "ids": (1..nodes.len()).collect::<Vec<_>>() } });
        let coverages: Option<Vec<f32>> = asset.levels.iter().map(|level| level.coverage).collect();
        if let Some(coverages) = coverages {
            let short: Vec<f64> = coverages.into_iter().map(number::short).collect();
            nodes[0]["extras"] = json!({ "MSFT_screencoverage": short });
        }
    }
    nodes
}

fn check(asset: &GltfAsset) -> Result<()> {
    if asset.xmp.is_some_and(|packet| !packet.0.is_object()) {
        return Err(Error::invalid("the XMP metadata", "it must be an object of JSON"));
    }
    if asset.levels.is_empty() {
        return Err(Error::invalid("the model to write", "it has no mesh; give at least one level"));
    }
    for (i, level) in asset.levels.iter().enumerate() {
        if level.mesh.triangles().is_empty() {
            return Err(Error::invalid(format!("level {i}"), "glTF has no empty meshes; leave it out"));
        }
        if level.coverage.is_some_and(|c| !(0.0..=1.0).contains(&c)) {
            return Err(Error::invalid(format!("level {i}"), "its screen coverage is not in [0, 1]"));
        }
        if asset.material.has_maps() && level.mesh.uvs().is_empty() {
            let why = "it has no uvs, but its material has textures; unwrap it or leave them out";
            return Err(Error::invalid(format!("level {i}"), why));
        }
    }
    asset.material.check()
}
