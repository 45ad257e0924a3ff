//! Writes a whole scene as glTF 2.0: meshes with their placement, materials, textures, lights and cameras.

mod materials;
mod nodes;
mod textures;

use super::codec::ImageCodec;
use super::container::Container;
use super::draft::GltfDraft;
use super::edit::short;
use super::format::GltfFormat;
use crate::write::{FileBytes, FileSet};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Sampler;
use taotie_engine::math::Mat4;
use taotie_engine::progress::Progress;
use taotie_engine::scene::Scene;

/// The files of a written scene, and notes on the content they lack.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct WrittenScene {
    /// The files; [`write_scene`]'s `path` is first.
    pub files: Vec<PathBuf>,
    /// Notes on content that glTF cannot express and that was dropped or changed.
    pub warnings: Warnings,
}

/// Writes a scene, so that [`load_model`](crate::load_model) reads the same one: a GLB if `path` ends in `.glb`;
/// for `.gltf` the JSON, with the data in `NAME.bin` and the textures in files such as `NAME_0.png` next to it.
/// Either all files are written or none, the JSON last. The same scene gives the same bytes.
///
/// Numbers are stored as 32-bit floats: transforms are rounded to them, and light, emission and rotated uvs may
/// differ by one rounding when read. A mesh shown with several materials is read as several meshes. Content that glTF
/// cannot express is dropped with a warning: reflectances (f0, f82), the classic models' parameters, height maps,
/// object-space normal maps, sheared uvs, meshes that are not shown; changed with a warning: lights without distance
/// falloff, float textures.
///
/// ```no_run
/// use std::path::Path;
/// use taotie_io::{self, GltfFormat};
/// let loaded = io::load_model(Path::new("jug.obj"))?;
/// let written = io::write_scene(Path::new("jug.glb"), &loaded.scene, &GltfFormat::default())?;
/// for (what, count) in written.warnings.iter() {
///     println!("{what}: {count}");
/// }
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Unsupported`] for another extension, [`Error::Invalid`] for a scene without triangles and for numbers
/// that do not fit 32-bit floats, [`Error::Limit`] for a GLB of 4 GiB or more, [`Error::Io`] if a file cannot be
/// written.
pub fn write_scene(path: &Path, scene: &Scene, format: &GltfFormat) -> Result<WrittenScene> {
    let container = Container::of(path)?;
    let Begun { mut writer, materials, images } = Begun::of(scene, format)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    writer.add_textures(&images, (container == Container::Gltf).then_some(&*stem));
    let (draft, warnings) = writer.finish(materials);
    let files = match container {
        Container::Glb => vec![FileBytes { path: path.to_path_buf(), bytes: draft.encode_glb()? }],
        Container::Gltf => draft.into_files(path, separate_files(images, path))?,
    };
    FileSet::one(|set| set.write_files(&files, Progress::SILENT))?;
    Ok(WrittenScene { files: files.into_iter().map(|file| file.path).collect(), warnings })
}

/// Returns the GLB that [`write_scene`] would write, with uncompressed geometry and PNG textures. Meshes and the
/// nodes that show them are named after `names`, one per mesh of the scene; missing names are empty. Adds notes on
/// content that glTF cannot express to `warnings`.
///
/// # Errors
/// As [`write_scene`].
pub fn encode_scene(scene: &Scene, names: &[String], warnings: &mut Warnings) -> Result<Vec<u8>> {
    encode_scene_as(scene, names, &GltfFormat::default(), warnings)
}

/// Like [`encode_scene`], but packed according to `format`.
///
/// # Errors
/// As [`write_scene`]; [`Error::Invalid`] for a number of the format that is out of range.
pub fn encode_scene_as(
    scene: &Scene,
    names: &[String],
    format: &GltfFormat,
    warnings: &mut Warnings,
) -> Result<Vec<u8>> {
    let Begun { mut writer, materials, images } = Begun::of(scene, format)?;
    writer.name_meshes(names);
    writer.add_textures(&images, None);
    let (draft, notes) = writer.finish(materials);
    warnings.absorb(notes);
    draft.encode_glb()
}

/// A scene that is written except for its textures.
struct Begun<'a> {
    writer: Writer<'a>,
    materials: Vec<Value>,
    images: Vec<Image>,
}

impl<'a> Begun<'a> {
    fn of(scene: &'a Scene, format: &GltfFormat) -> Result<Self> {
        if scene.triangle_count() == 0 {
            return Err(Error::invalid("scene to write", "it shows no triangles"));
        }
        let mut writer = Writer::new(scene, *format);
        writer.meshes()?;
        writer.lights()?;
        writer.cameras()?;
        let materials = scene.materials().iter().map(|material| writer.material(material)).collect();
        let images = writer.encoded_images()?;
        Ok(Self { writer, materials, images })
    }
}

/// A scene being written: its document, and the warnings about content that glTF lacks.
struct Writer<'a> {
    scene: &'a Scene,
    format: GltfFormat,
    draft: GltfDraft,
    textures: Textures,
    warnings: Warnings,
    nodes: Vec<Value>,
    /// The nodes listed by the scene.
    shown: Vec<usize>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene, format: GltfFormat) -> Self {
        let generator = concat!("taotie ", env!("CARGO_PKG_VERSION"));
        let json = json!({ "asset": { "version": "2.0", "generator": generator }, "scene": 0 });
        Self {
            scene,
            format,
            draft: GltfDraft::begun(json, format.codecs),
            textures: Textures::default(),
            warnings: Warnings::default(),
            nodes: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Notes that `count` parts differ from the scene in some way.
    fn note(&mut self, what: &str, count: usize) {
        self.warnings.note(what, count);
    }

    /// Adds a node to the scene.
    fn show(&mut self, node: Value) {
        self.shown.push(self.nodes.len());
        self.nodes.push(node);
    }

    fn finish(mut self, materials: Vec<Value>) -> (GltfDraft, Warnings) {
        self.draft.json["scenes"] = json!([{ "nodes": self.shown }]);
        self.draft.json["nodes"] = self.nodes.into();
        if !materials.is_empty() {
            self.draft.json["materials"] = materials.into();
        }
        (self.draft, self.warnings)
    }
}

/// An image to be written: a texture of the scene, with its green channel flipped if it points down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ImageUse {
    texture: usize,
    turned: bool,
}

/// The images requested by materials, in the order of the requests.
#[derive(Debug, Clone, Default)]
struct Textures {
    images: Vec<ImageUse>,
    samplers: Vec<Sampler>,
    /// The sampler and the image of each texture.
    textures: Vec<[usize; 2]>,
}

/// An image as encoded.
struct Image {
    bytes: Vec<u8>,
    codec: ImageCodec,
    /// `true` if floats were rounded.
    rounded: bool,
    /// `true` if another format was requested but not supported.
    refused: bool,
}

/// Returns the images as files next to the model `path`.
fn separate_files(images: Vec<Image>, path: &Path) -> Vec<FileBytes> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let file = |(i, image): (usize, Image)| {
        let path = path.with_file_name(file_name(&stem, i, &image));
        FileBytes { path, bytes: image.bytes }
    };
    images.into_iter().enumerate().map(file).collect()
}

fn file_name(stem: &str, index: usize, image: &Image) -> String {
    format!("{stem}_{index}.{}", image.codec.kind().file_extension())
}

/// Returns a node with a transform; the identity has no matrix.
///
/// # Errors
/// [`Error::Invalid`] if the matrix does not fit 32-bit floats.
fn placed(mut node: Value, world: &Mat4) -> Result<Value> {
    let rounded = world.columns.as_flattened().iter().map(|v| *v as f32);
    let rounded: Vec<f32> = rounded.collect();
    if !rounded.iter().all(|v| v.is_finite()) {
        return Err(Error::invalid("transform in the scene to write", "it does not fit 32-bit floats"));
    }
    if *world != Mat4::IDENTITY {
        node["matrix"] = rounded.into_iter().map(short).collect::<Vec<_>>().into();
    }
    Ok(node)
}
