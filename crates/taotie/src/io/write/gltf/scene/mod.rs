//! Writes a whole scene as glTF 2.0: meshes with their placement, materials, textures, lights and cameras.

mod layers;
mod lights;
mod materials;
mod meshes;
mod textures;
mod uses;
mod writer;

use super::{Container, GltfFormat};
use crate::error::{Error, Result, Warnings};
use crate::io::write::{FileBytes, FileSet};
use crate::progress::Progress;
use crate::scene::Scene;
use serde_json::Value;
use std::path::{Path, PathBuf};
use writer::Writer;

/// The files of a written scene, and notes on the content they lack.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct WrittenScene {
    /// The files; [`write_scene`]'s `path` is first.
    pub files: Vec<PathBuf>,
    /// Notes on content that glTF cannot express and that was dropped or changed.
    pub warnings: Warnings,
}

/// Writes a scene, so that [`load_model`](crate::io::load_model) reads the same one: a GLB if `path` ends in `.glb`;
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
/// use taotie::io::{self, GltfFormat};
/// let loaded = io::load_model(Path::new("jug.obj"))?;
/// let written = io::write_scene(Path::new("jug.glb"), &loaded.scene, &GltfFormat::default())?;
/// for (what, count) in written.warnings.iter() {
///     println!("{what}: {count}");
/// }
/// # Ok::<(), taotie::Error>(())
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
        Container::Gltf => draft.into_files(path, textures::separate(images, path))?,
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
    images: Vec<textures::Image>,
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
