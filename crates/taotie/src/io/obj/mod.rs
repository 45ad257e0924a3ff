//! OBJ with MTL: polygons, materials and external images.
//!
//! The format is read here rather than through a crate, because real-world files need features that crates lack:
//! errors with line numbers, concave polygons, continued lines, UTF-16 and Latin-1, faces with and without uvs in one
//! object, and the options of texture statements.

mod blocks;
mod build;
mod content;
mod corner;
mod material;
mod mtl;
mod objects;
mod parse;
mod statements;
mod textures;

pub(super) use material::neutral;

use super::loaded::{Loaded, checked};
use super::locate;
use super::reading::Reading;
use super::text::{self, quote};
use crate::error::{Result, Warnings};
use crate::math::Mat4;
use crate::mesh::Mesh;
use crate::scene::{Instance, Material, Scene, SceneData};
use content::Obj;
use mtl::Mtl;
use std::collections::HashMap;
use textures::Textures;

/// Maximum number of missing libraries or materials that are named individually.
const NAMED: usize = 64;

/// Reads an OBJ file, its MTL files and their textures.
///
/// The scene has one mesh for each material in use (two or more if only some of its faces have uvs or normals);
/// objects and groups are not kept apart, but name the meshes that hold their faces. Normals are absent if the file
/// has none. The uv origin is converted from bottom left to top left; vertex colours are taken as sRGB-encoded,
/// material colours as linear.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, [`crate::Error::Parse`] with the line of unusable content.
/// Missing libraries, materials and textures are noted in the warnings.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let mut warnings = Warnings::default();
    let obj = parse::parse(path, &text::read_text(path)?, &mut warnings)?;
    let parts = build::build(&obj, &mut warnings)?;
    let mut loaded = Loaded::new(Scene::default(), warnings, "OBJ");
    let scene = assemble(reading, &obj, parts, &mut loaded);
    loaded.scene = checked(path, scene)?;
    Ok(loaded)
}

fn assemble(reading: &Reading, obj: &Obj, parts: Vec<build::Part>, loaded: &mut Loaded) -> SceneData {
    let library = library(reading, obj, loaded);
    let Loaded { warnings, mesh_names, .. } = loaded;
    let mut scene = SceneData::default();
    let mut textures = Textures::new(reading);
    let mut material_of_name: HashMap<Option<usize>, usize> = HashMap::new();
    let mut unknown = 0;
    for build::Part { material, name, mesh } in parts {
        let material = *material_of_name.entry(material).or_insert_with(|| {
            let name = material.map_or("", |i| obj.material_names[i].as_str());
            scene.materials.push(match library.get(name) {
                Some(mtl) => material::material(mtl, &mut textures, warnings),
                None => {
                    note_unknown(name, &mut unknown, warnings);
                    let white = Material { base_color: [1.0; 4], ..neutral(name) };
                    if obj.colors.is_empty() { neutral(name) } else { white }
                }
            });
            scene.materials.len() - 1
        });
        if !obj.marks.chosen().is_empty() {
            let number = scene.meshes.len();
            mesh_names.push(if name.is_empty() { format!("mesh {number}") } else { name });
        }
        place(&mut scene, mesh, material);
    }
    scene.textures = textures.list;
    loaded.texture_names = textures.names;
    loaded.files.append(&mut textures.files);
    loaded.missing_files.append(&mut textures.missing_files);
    scene
}

fn place(scene: &mut SceneData, mesh: Mesh, material: usize) {
    scene.meshes.push(mesh);
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance { mesh, material, world_from_object: Mat4::IDENTITY });
}

fn note_unknown(name: &str, unknown: &mut usize, warnings: &mut Warnings) {
    *unknown += usize::from(!name.is_empty());
    if *unknown > NAMED {
        warnings.note("further materials not found in any library; using grey", 1);
    } else if !name.is_empty() {
        warnings.note(format!("material {} not found in any library; using grey", quote(name)), 1);
    }
}

/// Returns the materials of all libraries by name; of equal names, the last.
fn library(reading: &Reading, obj: &Obj, loaded: &mut Loaded) -> HashMap<String, Mtl> {
    /// Total bytes needed per byte of a library.
    const UNPACKED: u64 = 4;
    let Loaded { warnings, missing_files, files, .. } = loaded;
    let mut materials = HashMap::new();
    for names in obj.libraries.iter().take(NAMED) {
        for name in library_files(names, reading) {
            let found = match locate::find(&name, &[reading.folder()], reading) {
                Ok(Some(path)) => Ok(path),
                Ok(None) => Err("is missing".to_owned()),
                Err(why) => Err(format!("skipped: {why}")),
            };
            let text = match found {
                Err(why) => {
                    warnings.note(format!("material library {} {why}", quote(&name)), 1);
                    missing_files.push(name);
                    continue;
                }
                Ok(path) => {
                    files.push(path.clone());
                    let counted = reading.count_file(&path, UNPACKED);
                    counted.and_then(|()| text::read_text(&path)).map(|text| (path, text))
                }
            };
            match text {
                Ok((path, text)) => {
                    let found = mtl::parse(&path, &text, warnings);
                    materials.extend(found.into_iter().map(|m| (m.name.clone(), m)));
                }
                Err(error) => warnings.note(error.to_string(), 1),
            }
        }
    }
    let more = obj.libraries.len().saturating_sub(NAMED);
    warnings.note(format!("ignored material libraries beyond the first {NAMED}"), more);
    materials
}

/// Returns the files of one `mtllib`: a single name with spaces if such a file exists, else one per word, with a
/// backslash escaping a space.
fn library_files(names: &str, reading: &Reading) -> Vec<String> {
    let whole = names.trim().trim_matches('"');
    if !whole.contains(char::is_whitespace) || locate::find(whole, &[reading.folder()], reading) != Ok(None) {
        return vec![whole.to_owned()];
    }
    let kept = whole.replace("\\ ", "\0");
    kept.split_whitespace().take(NAMED).map(|word| word.replace('\0', " ")).collect()
}
