//! PLY: polygons with arbitrary properties, ASCII or binary.
//!
//! Headers are read by `ply-rs-bw`. Its payloads are one object per row, which is too much for a scan with millions
//! of rows, and its ASCII is stricter than real exporters; so payloads are read here, in blocks and, if rows allow
//! it, in parallel.

mod ascii;
mod elements;
mod header;
mod payload;

use super::bitmap::{read_map, texture};
use super::file;
use super::gltf::compact;
use super::loaded::{Loaded, checked};
use super::obj::neutral;
use super::reading::{Reading, find};
use super::text::quote;
use ascii::Tokens;
use elements::{Block, Decoder, FaceElement, Splitter, Vertices, Wanted, upright};
use header::{Attributes, Role, read_header, role};
use payload::Element;
use ply_rs_bw::ply::{ElementDef, Encoding as PayloadEncoding, Header, PropertyDef};
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::groups::Groups;
use taotie_engine::image::{Encoding, Sampler, Texture};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::{Mesh, MeshData, first};
use taotie_engine::parallel;
use taotie_engine::scene::{Instance, Material, Scene, SceneData, TextureRef, UvTransform};

/// Reads a PLY file into one mesh, or one for each texture.
///
/// Colours stored as integers are taken as sRGB-encoded, colours stored as floats as linear. Uvs come from vertices
/// (`s t`, `u v`, `texture_u texture_v`) or from a `texcoord` list per face, with the origin bottom left. Each `comment
/// TextureFile` specifies a base colour texture, and `texnumber` that of a face; without it, the first is used. Normals
/// are absent if the file has none, or if some are invalid.
///
/// # Errors
/// [`taotie_engine::Error::Io`] if the file cannot be read, [`taotie_engine::Error::Parse`] if its header or payload
/// is invalid, and for point clouds, which cannot be drawn.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let mut warnings = Warnings::default();
    let mut bytes = file::read(path)?;
    let (header, start, line) = read_header(path, &mut bytes)?;
    let elements = locate(path, &header, &bytes[start..], line)?;
    note_ignored(&header, &mut warnings);
    let names = texture_names(&header, path);
    if !elements.attributes.face_textures {
        let more = names.len().saturating_sub(1);
        warnings.note("ignored texture files beyond the first, since faces lack texnumber", more);
    }
    let parts = build(path, &elements, names.len(), &mut warnings)?;
    let mut loaded = Loaded::new(Scene::default(), warnings, "PLY");
    let mut scene = SceneData::default();
    let is_divided = parts.len() > 1;
    for Part { texture, mesh } in parts {
        let name = texture.and_then(|number| names.get(number)).filter(|_| !mesh.uvs().is_empty());
        let mut material = match name {
            Some(name) => textured(reading, name, &mut scene, &mut loaded),
            None => neutral(""),
        };
        if !is_divided {
            material.name.clear();
        }
        if !mesh.colors().is_empty() {
            material.base_color = [1.0; 4];
        }
        let number = scene.meshes.len();
        scene.instances.push(Instance { mesh: number, material: number, world_from_object: Mat4::IDENTITY });
        scene.materials.push(material);
        scene.meshes.push(mesh);
    }
    loaded.scene = checked(path, scene)?;
    Ok(loaded)
}

/// The faces with the same texture.
struct Part {
    /// The number of the texture in the header; `None` for faces without one.
    texture: Option<usize>,
    mesh: Mesh,
}

/// The drawable elements.
#[derive(Default)]
struct Elements<'a> {
    /// The attributes of the elements.
    attributes: Attributes,
    /// The vertices, if any.
    vertices: Option<Element<'a>>,
    /// Polygons and strips.
    faces: Vec<FaceElement<'a>>,
}

/// Notes the properties and elements that are not read.
fn note_ignored(header: &Header, warnings: &mut Warnings) {
    let is_read = |element: &&ElementDef| ["vertex", "face", "tristrips"].contains(&element.name.as_str());
    for element in header.elements.values().filter(is_read) {
        let is_ignored = |(name, property): &(&String, &PropertyDef)| {
            role(&element.name, name, &property.data_type) == Ok(Role::Ignored)
        };
        let ignored: Vec<_> = element.properties.iter().filter(is_ignored).collect();
        let first = ignored.first().map_or("", |(name, _)| name.as_str());
        let what = format!("ignored properties of element '{}', such as {}", element.name, quote(first));
        warnings.note(what, ignored.len());
    }
    let others = || header.elements.values().filter(|element| !is_read(element) && element.count > 0);
    let first = others().next().map_or("", |element| element.name.as_str());
    warnings.note(format!("ignored elements, such as {}", quote(first)), others().count());
    let Attributes { colors, face_colors, .. } = Attributes::of(header);
    let are_both = colors.and(face_colors).is_some();
    warnings.note("ignored colours of faces, since vertices have colours", usize::from(are_both));
}

/// Locates the drawable elements; the others are skipped.
fn locate<'a>(path: &Path, header: &Header, payload: &'a [u8], line: usize) -> Result<Elements<'a>> {
    let mut elements = Elements { attributes: Attributes::of(header), ..Elements::default() };
    let mut tokens = Tokens::new(path, payload, line);
    let mut rest = payload;
    for (_, definition) in header.elements.iter().filter(|(_, e)| !e.properties.is_empty()) {
        let rows = if header.encoding == PayloadEncoding::Ascii {
            Element::ascii(path, definition, &mut tokens)?
        } else {
            let big_endian = header.encoding == PayloadEncoding::BinaryBigEndian;
            let (rows, length) = Element::binary(path, definition, rest, big_endian)?;
            rest = &rest[length..];
            rows
        };
        match definition.name.as_str() {
            "vertex" => elements.vertices = Some(rows),
            "face" => elements.faces.push(FaceElement { rows, strips: false }),
            "tristrips" => elements.faces.push(FaceElement { rows, strips: true }),
            _ => {}
        }
    }
    Ok(elements)
}

/// Builds a mesh for each of the header's `textures` in use. Vertices are split if faces give them different uvs or
/// colours.
fn build(path: &Path, elements: &Elements, textures: usize, warnings: &mut Warnings) -> Result<Vec<Part>> {
    let vertices = read_vertices(path, elements)?;
    let attributes = &elements.attributes;
    let with_uvs: usize = elements.faces.iter().filter(|f| !f.strips).map(|f| f.rows.with_uvs).sum();
    let lack_normals = vertices.lack_normals();
    let wanted = Wanted {
        positions: &vertices.positions,
        lack_normals: &lack_normals,
        uvs: with_uvs > 0,
        colors: attributes.colors.is_none() && attributes.face_colors.is_some(),
        textures: if attributes.face_textures { textures } else { 0 },
    };
    let divided_by = wanted.textures;
    let mut gathered = Gathered::new(path, &wanted);
    for element in &elements.faces {
        if let Some(block) = element.triangles(&wanted) {
            gathered.take(block)?;
            continue;
        }
        gathered.triangles.reserve(element.rows.corners.saturating_sub(2 * element.rows.count));
        element
            .rows
            .blocks(|rows| Block::read(rows, element.strips, &wanted), |block| gathered.take(block))?;
    }
    gathered.finish(with_uvs, vertices.positions.len(), warnings)?;
    let Gathered { triangles, textures: numbers, splitter, without_normal, .. } = gathered;
    let mut data = match splitter {
        Some(splitter) => split(vertices, splitter, attributes),
        None => plain(vertices),
    };
    if without_normal > 0 {
        data.normals.clear();
    }
    data.triangles = triangles;
    let parts = match divided_by {
        0 => vec![(Some(0), data)],
        count => by_texture(data, &numbers, count),
    };
    let mut built = Vec::new();
    for (texture, data) in parts {
        let mesh = Mesh::new(data)?;
        warnings.note("triangles without area", mesh.degenerate_triangles());
        built.push(Part { texture, mesh });
    }
    Ok(built)
}

/// Divides a mesh by the textures of its triangles, in the order of the header; triangles without a texture are last.
fn by_texture(data: MeshData, numbers: &[u32], count: usize) -> Vec<(Option<usize>, MeshData)> {
    let entries =
        || numbers.iter().map(|number| (*number as usize).min(count)).zip(data.triangles.iter().copied());
    let groups = Groups::new(count + 1, entries);
    let texture = |group: usize| (group < count).then_some(group);
    let used: Vec<usize> = (0..groups.count()).filter(|group| !groups.of(*group).is_empty()).collect();
    if let [only] = used[..] {
        return vec![(texture(only), data)];
    }
    let part = |group: usize| {
        let (vertices, triangles) = compact(groups.of(group).to_vec(), data.positions.len());
        let vertices: Vec<usize> = vertices.iter().map(|vertex| *vertex as usize).collect();
        (texture(group), MeshData { triangles, ..data.gathered(&vertices) })
    };
    used.into_iter().map(part).collect()
}

fn read_vertices(path: &Path, elements: &Elements) -> Result<Vertices> {
    let whole = |what: &str| Err(Error::parse(path, "whole file", what));
    let Some(rows) = elements.vertices.as_ref().filter(|rows| rows.count > 0) else {
        return whole("no vertices; re-export the mesh");
    };
    if !elements.attributes.positions {
        return whole("the vertices lack x, y or z; re-export the mesh");
    }
    if elements.faces.iter().all(|faces| faces.rows.count == 0) {
        return Err(cloud(path, rows.count));
    }
    let vertices = Vertices::read(rows, &elements.attributes)?;
    match first(&vertices.positions, |p| !p.is_finite()) {
        Some(i) => {
            Err(Error::parse(path, format!("vertex {i}"), "the position is infinite or NaN; fix the file"))
        }
        None => Ok(vertices),
    }
}

fn cloud(path: &Path, points: usize) -> Error {
    let what =
        format!("point cloud ({points} points, no faces); reconstruct its surface first, e.g. in MeshLab");
    Error::parse(path, "whole file", what)
}

/// The combined content of the blocks of faces.
struct Gathered<'a> {
    path: &'a Path,
    triangles: Vec<[u32; 3]>,
    /// The number of the texture of each triangle, if wanted.
    textures: Vec<u32>,
    splitter: Option<Splitter>,
    faces: usize,
    too_few: usize,
    crossing: usize,
    without_normal: usize,
}

impl<'a> Gathered<'a> {
    fn new(path: &'a Path, wanted: &Wanted) -> Self {
        Self {
            path,
            triangles: Vec::new(),
            textures: Vec::new(),
            splitter: wanted.splits().then(|| Splitter::new(wanted)),
            faces: 0,
            too_few: 0,
            crossing: 0,
            without_normal: 0,
        }
    }

    fn take(&mut self, mut block: Block) -> Result<()> {
        if let Some((face, what)) = block.error {
            return Err(Error::parse(self.path, format!("face {}", self.faces + face), what));
        }
        match &mut self.splitter {
            None if self.triangles.capacity() == 0 => self.triangles = block.triangles,
            None => self.triangles.append(&mut block.triangles),
            Some(splitter) => {
                let triangles = block.triangles.iter();
                self.triangles.extend(triangles.map(|t| t.map(|i| splitter.index(&block, i as usize))));
            }
        }
        self.textures.append(&mut block.textures);
        self.faces += block.faces;
        self.too_few += block.too_few;
        self.crossing += block.crossing;
        self.without_normal += block.without_normal;
        Ok(())
    }

    fn finish(&self, with_uvs: usize, points: usize, warnings: &mut Warnings) -> Result<()> {
        if self.faces == 0 {
            return Err(cloud(self.path, points));
        }
        let lacking = if with_uvs > 0 { self.faces - with_uvs } else { 0 };
        warnings.note("faces without uvs among faces with uvs", lacking);
        let normals = "corners with zero or NaN normals; dropped all normals";
        warnings.note(normals, self.without_normal);
        warnings.note("skipped faces with fewer than three corners", self.too_few);
        warnings.note("self-intersecting polygons, triangulated approximately", self.crossing);
        if self.triangles.is_empty() {
            let what = "no faces with three or more corners; export triangles";
            return Err(Error::parse(self.path, "whole file", what));
        }
        Ok(())
    }
}

/// Returns the vertices unsplit, with unit normals.
fn plain(vertices: Vertices) -> MeshData {
    let Vertices { positions, mut normals, uvs, colors } = vertices;
    parallel::change(&mut normals, |_, n| *n = unit(*n));
    let uvs = if uvs.is_empty() { Vec::new() } else { vec![uvs] };
    MeshData { positions, normals, uvs, colors, ..MeshData::default() }
}

/// Returns the vertices as split by faces.
fn split(vertices: Vertices, splitter: Splitter, attributes: &Attributes) -> MeshData {
    let sources: Vec<usize> = splitter.vertices().collect();
    let mut data = plain(vertices).gathered(&sources);
    if splitter.uvs {
        data.uvs = vec![splitter.own_uvs().map(|[u, v]| upright(u, v)).collect()];
    }
    if let Some(code) = attributes.face_colors.filter(|_| splitter.colors) {
        let decoder = Decoder::new(code);
        data.colors = splitter.own_colors().map(|color| decoder.linear(color)).collect();
    }
    data
}

fn unit(normal: Vec3) -> Vec3 {
    normal.to_f64().normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_f32()
}

/// Returns the texture files specified by comments in the header. MeshLab's `<this>` is the name of the model without
/// its extension, so that `<this>_A.png` in `vase.ply` is `vase_A.png`.
fn texture_names(header: &Header, path: &Path) -> Vec<String> {
    const THIS: &str = "<this>";
    let names = header.comments.iter().filter_map(|comment| comment.trim().strip_prefix("TextureFile"));
    let file = |name: &str| match name.to_ascii_lowercase().find(THIS) {
        Some(at) => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            [&name[..at], &stem, &name[at + THIS.len()..]].concat()
        }
        None => name.to_owned(),
    };
    names.map(|name| file(name.trim())).collect()
}

/// Returns a material of the name and with the texture of the file `name` next to the model; failures are noted.
fn textured(reading: &Reading, name: &str, scene: &mut SceneData, loaded: &mut Loaded) -> Material {
    let mut material = neutral(name);
    if let Some(texture) = load_texture(reading, name, loaded) {
        let (sampler, transform) = (Sampler::default(), UvTransform::default());
        scene.textures.push(texture);
        let texture = scene.textures.len() - 1;
        material.base_color = [1.0; 4];
        material.base_color_texture = Some(TextureRef { texture, uv_set: 0, sampler, transform });
    }
    material
}

/// Reads the file `name` next to the model; failures are noted.
fn load_texture(reading: &Reading, name: &str, loaded: &mut Loaded) -> Option<Texture> {
    let file = find(name, &[reading.folder()], reading);
    let file = file.and_then(|file| file.ok_or_else(|| "file not found".to_owned()));
    let file = match file {
        Ok(file) => file,
        Err(why) => {
            loaded.warnings.note(format!("skipped texture '{name}': {why}"), 1);
            loaded.missing_files.push(name.to_owned());
            return None;
        }
    };
    loaded.files.push(file.clone());
    match read_map(&file, reading) {
        Ok(bitmap) => {
            loaded.texture_names.push(name.to_owned());
            texture(reading, bitmap, Encoding::Srgb)
        }
        Err(error) => {
            loaded.warnings.note(format!("skipped texture '{name}': {error}"), 1);
            None
        }
    }
}
