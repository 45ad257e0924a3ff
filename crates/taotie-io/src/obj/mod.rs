//! OBJ with MTL: polygons, materials and external images.
//!
//! The format is read here rather than through a crate, because real-world files need features that crates lack:
//! errors with line numbers, concave polygons, continued lines, UTF-16 and Latin-1, faces with and without uvs in one
//! object, and the options of texture statements.

mod content;
mod materials;
mod mtl;
mod parse;
mod statements;

#[cfg(all(feature = "fbx", not(target_family = "wasm")))]
pub(super) use materials::material;
pub(super) use materials::{Textures, neutral};
#[cfg(all(feature = "fbx", not(target_family = "wasm")))]
pub(super) use mtl::Map;
pub(super) use mtl::Mtl;

use super::loaded::{Loaded, Objects, checked};
use super::polygon::{Cutter, Outline};
use super::reading::{Reading, find};
use super::text::{quote, read_text};
use content::{Corner, Face, Mark, NONE, Obj, Walk, joined};
use std::collections::HashMap;
use taotie_engine::error::{Result, Warnings};
use taotie_engine::math::srgb::linear_from_srgb;
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};

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
/// [`taotie_engine::Error::Io`] if the file cannot be read, [`taotie_engine::Error::Parse`] with the line of unusable
/// content. Missing libraries, materials and textures are noted in the warnings.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let mut warnings = Warnings::default();
    let obj = parse::parse(path, &read_text(path)?, &mut warnings)?;
    let parts = build(&obj, &mut warnings)?;
    let mut loaded = Loaded::new(Scene::default(), warnings, "OBJ");
    let scene = assemble(reading, &obj, parts, &mut loaded);
    loaded.scene = checked(path, scene)?;
    Ok(loaded)
}

fn assemble(reading: &Reading, obj: &Obj, parts: Vec<Part>, loaded: &mut Loaded) -> SceneData {
    let library = library(reading, obj, loaded);
    let Loaded { warnings, mesh_names, .. } = loaded;
    let mut scene = SceneData::default();
    let mut textures = Textures::new(reading);
    let mut material_of_name: HashMap<Option<usize>, usize> = HashMap::new();
    let mut unknown = 0;
    for Part { material, name, mesh } in parts {
        let material = *material_of_name.entry(material).or_insert_with(|| {
            let name = material.map_or("", |i| obj.material_names[i].as_str());
            scene.materials.push(match library.get(name) {
                Some(mtl) => materials::material(mtl, &mut textures, warnings),
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
    loaded.objects = Objects::joined(mesh_names.iter().map(|name| (name.clone(), name.clone())));
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
            let found = match find(&name, &[reading.folder()], reading) {
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
                    counted.and_then(|()| read_text(&path)).map(|text| (path, text))
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
    if !whole.contains(char::is_whitespace) || find(whole, &[reading.folder()], reading) != Ok(None) {
        return vec![whole.to_owned()];
    }
    let kept = whole.replace("\\ ", "\0");
    kept.split_whitespace().take(NAMED).map(|word| word.replace('\0', " ")).collect()
}

/// A mesh of the faces of one material.
struct Part {
    /// Index into [`Obj::material_names`], or `None`.
    material: Option<usize>,
    /// The objects or groups of its faces; empty if the file has none.
    name: String,
    /// The triangles.
    mesh: Mesh,
}

/// Converts the faces of `obj` to meshes, one for each material and each combination of attributes: triangulates them
/// and welds corners with equal position, uv and normal index.
///
/// A mesh has uvs only if all its faces have them at every corner, and likewise normals; so one material can have up
/// to four meshes. Objects that are named for baking are separate meshes. In memory the uv origin is top left.
fn build(obj: &Obj, warnings: &mut Warnings) -> Result<Vec<Part>> {
    let mut parts: Vec<PartBuilder> = Vec::new();
    let mut part_of_kind: HashMap<Kind, usize> = HashMap::new();
    let mut current: Option<(Kind, usize)> = None;
    let mut scratch = Scratch::default();
    let colors = linear_colors(obj, warnings);
    let mut firsts = vec![(NONE, NONE); obj.positions.len()];
    let mut walk = Walk::new(obj.marks.chosen());
    let apart = obj.marks.kept_apart();
    for (i, face) in obj.faces.iter().enumerate() {
        let mark = walk.at(i);
        let object = mark.checked_sub(1).and_then(|mark| apart.get(mark)).copied().unwrap_or_default();
        let (uvs, normals) = scratch.take(obj, face, warnings);
        let kind = Kind { material: face.material, object, uvs, normals };
        let part = match current {
            Some((same, part)) if same == kind => part,
            _ => *part_of_kind.entry(kind).or_insert_with(|| {
                parts.push(PartBuilder::new(parts.len() as u32, kind));
                parts.len() - 1
            }),
        };
        current = Some((kind, part));
        scratch.cut(warnings);
        parts[part].add(obj, &colors, &scratch, &mut firsts);
        parts[part].mark(mark);
    }
    if parts.iter().any(|part| !part.kind.normals) {
        warnings.note("smoothing groups are merged, since faces lack normals", obj.smoothing_changes);
    }
    parts.into_iter().map(|part| part.finish(obj.marks.chosen(), warnings)).collect()
}

/// The properties that the faces of a mesh share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Kind {
    material: u32,
    /// The number of the object; 0 if objects are not kept apart.
    object: u32,
    uvs: bool,
    normals: bool,
}

/// The current face.
#[derive(Default)]
struct Scratch {
    corners: Vec<Corner>,
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    cutter: Cutter,
}

impl Scratch {
    /// Takes the corners of `face`, without unusable uvs or normals; returns whether there are any.
    fn take(&mut self, obj: &Obj, face: &Face, warnings: &mut Warnings) -> (bool, bool) {
        self.corners.clear();
        self.corners.extend_from_slice(&obj.corners[face.first as usize..][..face.count as usize]);
        self.points.clear();
        self.points.extend(self.corners.iter().map(|c| obj.positions[c[0] as usize]));
        let bad_uv = |i: u32| i != NONE && !is_finite(obj.uvs[i as usize]);
        let bad_normal = |i: u32| i != NONE && !is_direction(obj.normals[i as usize]);
        let uvs =
            self.keep(1, bad_uv, "faces with unusable uvs (infinite, NaN or not at every corner)", warnings);
        let normals = self.keep(
            2,
            bad_normal,
            "faces with unusable normals (zero, NaN or not at every corner)",
            warnings,
        );
        (uvs, normals)
    }

    /// Returns `true` if every corner has a usable index in `slot`; otherwise removes it from all corners.
    fn keep(&mut self, slot: usize, bad: impl Fn(u32) -> bool, name: &str, warnings: &mut Warnings) -> bool {
        let all = self.corners.iter().all(|c| c[slot] != NONE && !bad(c[slot]));
        if !all {
            let some = self.corners.iter().any(|c| c[slot] != NONE);
            warnings.note(name, usize::from(some));
            self.corners.iter_mut().for_each(|c| c[slot] = NONE);
        }
        all
    }

    fn cut(&mut self, warnings: &mut Warnings) {
        self.triangles.clear();
        if self.points.len() == 3 {
            self.triangles.push([0, 1, 2]);
        } else if self.cutter.cut(&self.points, &mut self.triangles) == Outline::Crossing {
            warnings.note("self-intersecting polygons, triangulated approximately", 1);
        }
    }
}

/// For each position, the part that used it first, and the vertex there.
type Firsts = [(u32, u32)];

struct PartBuilder {
    number: u32,
    kind: Kind,
    data: MeshData,
    /// The indices of the marks of its faces, in order.
    marks: Vec<usize>,
    /// The source corner of each vertex.
    corners: Vec<Corner>,
    /// The vertices of corners, except for those in [`Firsts`]: most positions have one corner in one part.
    welded: HashMap<Corner, u32>,
}

impl PartBuilder {
    fn new(number: u32, kind: Kind) -> Self {
        let uvs = if kind.uvs { vec![Vec::new()] } else { Vec::new() };
        let data = MeshData { uvs, ..MeshData::default() };
        Self { number, kind, data, marks: Vec::new(), corners: Vec::new(), welded: HashMap::new() }
    }

    fn add(&mut self, obj: &Obj, colors: &[[f32; 4]], face: &Scratch, firsts: &mut Firsts) {
        for [a, b, c] in &face.triangles {
            let mut vertex = |i: u32| {
                let corner = face.corners[i as usize];
                let index = self.index(corner, &mut firsts[corner[0] as usize]);
                if index as usize == self.data.positions.len() {
                    self.push(obj, colors, corner);
                }
                index
            };
            let triangle = [vertex(*a), vertex(*b), vertex(*c)];
            self.data.triangles.push(triangle);
        }
    }

    /// Records the mark of the face just added.
    fn mark(&mut self, number: usize) {
        if self.marks.last() != Some(&number) {
            self.marks.push(number);
        }
    }

    /// Returns the vertex of a corner, whose position was first used by `first`.
    fn index(&mut self, corner: Corner, first: &mut (u32, u32)) -> u32 {
        let next = self.corners.len() as u32;
        match *first {
            (NONE, _) => {
                *first = (self.number, next);
                next
            }
            (part, index) if part == self.number && self.corners[index as usize] == corner => index,
            _ => *self.welded.entry(corner).or_insert(next),
        }
    }

    fn push(&mut self, obj: &Obj, colors: &[[f32; 4]], corner: Corner) {
        self.corners.push(corner);
        let [position, uv, normal] = corner.map(|i| i as usize);
        self.data.positions.push(obj.positions[position]);
        if let Some(uvs) = self.data.uvs.first_mut() {
            uvs.push(Vec2::new(obj.uvs[uv].x, 1.0 - obj.uvs[uv].y));
        }
        if self.kind.normals {
            self.data.normals.push(obj.normals[normal].to_f64().normalize().to_f32());
        }
        if let Some(color) = colors.get(position) {
            self.data.colors.push(*color);
        }
    }

    fn finish(self, marks: &[Mark], warnings: &mut Warnings) -> Result<Part> {
        let mesh = Mesh::new(self.data)?;
        warnings.note("triangles without area", mesh.degenerate_triangles());
        let material = (self.kind.material != NONE).then_some(self.kind.material as usize);
        Ok(Part { material, name: joined(marks, &self.marks), mesh })
    }
}

fn is_finite(uv: Vec2) -> bool {
    uv.x.is_finite() && uv.y.is_finite()
}

fn is_direction(normal: Vec3) -> bool {
    let length = normal.to_f64().length();
    length > 1e-20 && length.is_finite()
}

/// Returns vertex colours; the format does not define them, and tools write them sRGB-encoded in [0, 1] or [0, 255].
fn linear_colors(obj: &Obj, warnings: &mut Warnings) -> Vec<[f32; 4]> {
    let usable = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
    let largest = obj.colors.iter().flatten().fold(0.0, |a: f32, v| a.max(usable(*v)));
    let scale = if largest > 1.5 { 1.0 / 255.0 } else { 1.0 };
    warnings.note("vertex colours above 1; reading all as 0 to 255", usize::from(scale < 1.0));
    let decode = |v: f32| linear_from_srgb((f64::from(usable(v)) * scale).min(1.0)) as f32;
    obj.colors.iter().map(|[r, g, b]| [decode(*r), decode(*g), decode(*b), 1.0]).collect()
}
