//! The geometry and images of a file as stored, for programs that edit it: vertices, triangles and images to repack,
//! and MikkTSpace tangents for primitives that have none.

use super::accessor::{Accessor, float};
use super::document::Document;
use super::geometry::{Vertices, attribute, compact, read_indices, triangulate};
use super::nodes::keyframes;
use super::primitives::{bytes_of, most_elements};
use super::raw::{DRACO, GltfSource, RawGltf, extension, is_known};
use super::resources::Supplied;
use super::textures::read_image;
use crate::reading::{Reading, Reason};
use gltf::json::accessor::ComponentType;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use serde_json::Value;
use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use taotie_engine::error::{Result, Warnings};
use taotie_engine::image::Bitmap;
use taotie_engine::mesh::{Mesh, repair};
use taotie_engine::scene::animation::Sampler;
use taotie_engine::surface::{TangentMethod, with_tangents};

/// An attribute of vertices, or of a morph target.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StoredAttribute {
    /// Its name in the file.
    pub name: String,
    pub elements: Supplied,
    /// `true` if integers represent numbers in [0, 1] or [−1, 1].
    pub is_normalized: bool,
}

/// Vertices shared by primitives.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StoredVertices {
    /// At least POSITION, which is first; all have one element per vertex.
    pub attributes: Vec<StoredAttribute>,
    /// The attributes of each morph target.
    pub targets: Vec<Vec<StoredAttribute>>,
    pub primitives: Vec<StoredPrimitive>,
}

/// Triangles on shared vertices, of one primitive or of several.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StoredPrimitive {
    /// The primitives of the file: the index of the mesh, and of the primitive in it.
    pub places: Vec<[usize; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

/// The keyframes of an animation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StoredTrack {
    /// The index of the animation, and of its sampler.
    pub place: [usize; 2],
    /// `true` if all channels that use them are rotations, `false` if none is.
    pub is_rotation: bool,
    /// The number of components of a stored element.
    pub width: usize,
    pub keys: Sampler,
}

/// The stored content of a file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Content {
    /// Vertices of the triangle primitives that no extension packs and that can be read completely.
    pub vertices: Vec<StoredVertices>,
    /// The keyframes of animations.
    pub tracks: Vec<StoredTrack>,
    /// The images in file order; `None` for one that cannot be decoded.
    pub images: Vec<Option<Bitmap>>,
}

const POSITION: &str = "POSITION";

impl Content {
    /// Reads the stored content of a file.
    ///
    /// # Errors
    /// Those of reading the file; [`taotie_engine::Error::Limit`] if its content does not fit in memory.
    pub fn read(source: GltfSource<'_>, raw: &RawGltf) -> Result<Self> {
        let reading = raw.reading();
        let bytes = source.bytes(reading)?.into_owned();
        let document = Document::of(reading, bytes, &mut Warnings::default())?;
        let reader = Reader { document: &document, json: &raw.json };
        let (vertices, tracks) = (reader.vertices(), reader.tracks());
        let images = (0..document.root.images.len()).map(|image| read_image(&document, image).ok()).collect();
        reading.check()?;
        Ok(Self { vertices, tracks, images })
    }
}

/// An extension by which the order of triangles states polygons: packing drops it.
pub(crate) const POLYGONS: &str = "FB_ngon_encoding";

/// Returns true for an extension of a mesh or primitive that may refer to vertices or triangles by number.
fn depends_on_order(name: &str) -> bool {
    name != POLYGONS && !is_known(name)
}

/// Returns the names of an object's extensions.
fn names(json: &Value) -> impl Iterator<Item = &str> {
    json.get("extensions")
        .and_then(Value::as_object)
        .into_iter()
        .flat_map(|all| all.keys().map(String::as_str))
}

/// Reads primitives, both typed and as raw JSON, since only the latter has all names.
struct Reader<'a> {
    document: &'a Document,
    json: &'a Value,
}

impl Reader<'_> {
    fn vertices(&self) -> Vec<StoredVertices> {
        let mut budget = most_elements(self.document);
        let mut found: BTreeMap<String, StoredVertices> = BTreeMap::new();
        for (mesh, typed) in self.document.root.meshes.iter().enumerate() {
            for (primitive, typed) in typed.primitives.iter().enumerate() {
                let json = &self.json["meshes"][mesh]["primitives"][primitive];
                if names(&self.json["meshes"][mesh]).any(depends_on_order) {
                    continue;
                }
                // A primitive that cannot be read stays unchanged.
                let Ok(Some(triangles)) = self.triangles(typed, json, &mut budget) else { continue };
                let key = format!("{} {}", json["attributes"], json["targets"]);
                let primitive = StoredPrimitive { places: vec![[mesh, primitive]], triangles };
                match found.get_mut(&key) {
                    Some(vertices) => vertices.primitives.push(primitive),
                    None => {
                        let Ok(read) = self.shared(json, &mut budget) else { continue };
                        found.insert(key, StoredVertices { primitives: vec![primitive], ..read });
                    }
                }
            }
        }
        let mut all: Vec<StoredVertices> =
            found.into_values().filter_map(StoredVertices::compacted).collect();
        all.sort_by_key(StoredVertices::first_place);
        joined(all)
    }

    fn tracks(&self) -> Vec<StoredTrack> {
        let mut budget = most_elements(self.document);
        let mut found = Vec::new();
        for (a, animation) in list(self.json, "animations").enumerate() {
            for (s, sampler) in list(animation, "samplers").enumerate() {
                let own = list(animation, "channels").filter(|channel| number(channel, "sampler") == Some(s));
                let rotates = |channel: &Value| channel.pointer("/target/path") == Some(&"rotation".into());
                let (turning, others): (Vec<_>, Vec<_>) = own.partition(|channel| rotates(channel));
                let Ok((width, keys)) = self.keys(sampler, &mut budget) else { continue };
                let is_rotation = others.is_empty();
                let can_pack = if is_rotation { width == 4 } else { turning.is_empty() && width <= 4 };
                if can_pack {
                    found.push(StoredTrack { place: [a, s], is_rotation, width, keys });
                }
            }
        }
        found
    }

    /// Returns the keyframes of a sampler, and the components of a stored element.
    fn keys(&self, sampler: &Value, budget: &mut usize) -> Reason<(usize, Sampler)> {
        let typed: gltf::json::animation::Sampler =
            gltf::json::deserialize::from_value(sampler.clone()).map_err(|e| e.to_string())?;
        let output = Accessor::open(self.document, typed.output.value())?;
        if output.holds_integers() {
            // Such as the booleans of KHR_animation_pointer: packed ones would be floats.
            return Err("its values are integers".into());
        }
        let width = output.width;
        let before = *budget;
        let keys = keyframes(self.document, &typed, budget)?;
        if !self.document.reading.take(bytes_of(before - *budget, 0)) {
            return Err("it does not fit in memory".into());
        }
        Ok((width, keys))
    }

    /// Returns the triangles of a primitive; `None` if it has none, or is packed by an extension.
    fn triangles(
        &self,
        typed: &Primitive,
        json: &Value,
        budget: &mut usize,
    ) -> Reason<Option<Vec<[u32; 3]>>> {
        let Checked::Valid(mode) = typed.mode else { return Ok(None) };
        if names(json).any(|name| name.contains("compression") || depends_on_order(name)) {
            return Ok(None);
        }
        let Some(position) = number(&json["attributes"], POSITION) else { return Ok(None) };
        let count = Accessor::open(self.document, position)?.count;
        let indices = typed.indices.map(|index| Accessor::open(self.document, index.value())).transpose()?;
        spend(budget, indices.as_ref().map_or(count, |indices| indices.count))?;
        if !self.document.reading.take(bytes_of(0, count)) {
            return Err("it does not fit in memory".into());
        }
        let found = triangulate(mode, &read_indices(indices.as_ref(), count)?);
        let is_whole = mode != Mode::Triangles || found.as_ref().is_some_and(|found| found.surplus == 0);
        Ok(found.map(|found| found.list).filter(|list| is_whole && !list.is_empty()))
    }

    /// Reads the vertices of a primitive.
    fn shared(&self, json: &Value, budget: &mut usize) -> Reason<StoredVertices> {
        let mut attributes = self.attributes(&json["attributes"], budget)?;
        let first =
            attributes.iter().position(|attribute| attribute.name == POSITION).ok_or("no POSITION")?;
        attributes.swap(0, first);
        let count = attributes[0].elements.count();
        let targets = json.get("targets").and_then(Value::as_array).into_iter().flatten();
        let targets = targets.map(|target| self.attributes(target, budget)).collect::<Reason<Vec<_>>>()?;
        let can_pack =
            |attribute: &StoredAttribute| attribute.elements.count() == count && attribute.can_be_packed();
        match attributes.iter().chain(targets.iter().flatten()).all(can_pack) {
            true => Ok(StoredVertices { attributes, targets, primitives: Vec::new() }),
            false => Err("its attributes differ in length, or cannot be packed".into()),
        }
    }

    fn attributes(&self, json: &Value, budget: &mut usize) -> Reason<Vec<StoredAttribute>> {
        let named = json.as_object().ok_or("no attributes")?.keys();
        named
            .map(|name| {
                let index = number(json, name).ok_or("an attribute without accessor")?;
                self.attribute((name, index), budget)
            })
            .collect()
    }

    fn attribute(&self, (name, index): (&str, usize), budget: &mut usize) -> Reason<StoredAttribute> {
        let accessor = Accessor::open(self.document, index)?;
        spend(budget, accessor.count)?;
        if !self.document.reading.take(bytes_of(accessor.count, 0)) {
            return Err("it does not fit in memory".into());
        }
        Ok(StoredAttribute {
            name: name.to_owned(),
            elements: accessor.stored(),
            is_normalized: accessor.is_normalized(),
        })
    }
}

/// Joins vertices that are equal, and their primitives with equal triangles: files often repeat a shape for each of its
/// materials.
fn joined(all: Vec<StoredVertices>) -> Vec<StoredVertices> {
    let mut joined: Vec<StoredVertices> = Vec::with_capacity(all.len());
    let mut known: HashMap<u64, Vec<usize>> = HashMap::new();
    for vertices in all {
        let same = known.entry(vertices.hash()).or_default();
        match same.iter().find(|own| joined[**own].has_vertices_of(&vertices)) {
            Some(own) => joined[*own].primitives.extend(vertices.primitives),
            None => {
                same.push(joined.len());
                joined.push(vertices);
            }
        }
    }
    joined.iter_mut().for_each(StoredVertices::join_primitives);
    joined
}

impl StoredVertices {
    fn first_place(&self) -> Option<[usize; 2]> {
        self.primitives.first()?.places.first().copied()
    }

    fn hash(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let all = self.attributes.iter().chain(self.targets.iter().flatten());
        all.for_each(|attribute| (&attribute.name, &attribute.elements.bytes).hash(&mut hasher));
        hasher.finish()
    }

    fn has_vertices_of(&self, other: &Self) -> bool {
        (&self.attributes, &self.targets) == (&other.attributes, &other.targets)
    }

    fn join_primitives(&mut self) {
        let mut first: HashMap<Vec<[u32; 3]>, usize> = HashMap::new();
        let mut joined: Vec<StoredPrimitive> = Vec::with_capacity(self.primitives.len());
        for primitive in std::mem::take(&mut self.primitives) {
            match first.get(&primitive.triangles) {
                Some(own) => joined[*own].places.extend(primitive.places),
                None => {
                    first.insert(primitive.triangles.clone(), joined.len());
                    joined.push(primitive);
                }
            }
        }
        self.primitives = joined;
    }

    /// Removes vertices that no triangle uses, and merges those that are equal in every attribute; returns `None` if
    /// no triangle is left.
    fn compacted(mut self) -> Option<Self> {
        let count = self.attributes[0].elements.count();
        let same = self.first_of_same(count);
        let mut lengths = Vec::with_capacity(self.primitives.len());
        let mut joined = Vec::new();
        for primitive in &mut self.primitives {
            let merged = primitive.triangles.iter().map(|triangle| triangle.map(|v| same[v as usize]));
            let before = joined.len();
            joined.extend(merged.filter(|[a, b, c]| a != b && b != c && c != a));
            lengths.push(joined.len() - before);
        }
        let (used, joined) = compact(joined, count);
        let mut rest = joined.as_slice();
        for (primitive, length) in self.primitives.iter_mut().zip(lengths) {
            let (own, others) = rest.split_at(length);
            primitive.triangles = own.to_vec();
            rest = others;
        }
        let mut pick = |attribute: &mut StoredAttribute| {
            let bytes = used.iter().flat_map(|v| attribute.element(*v as usize)).copied().collect();
            attribute.elements.bytes = bytes;
        };
        self.attributes.iter_mut().for_each(&mut pick);
        self.targets.iter_mut().flatten().for_each(&mut pick);
        // glTF has no empty primitives, so such a primitive stays unchanged.
        self.primitives.retain(|primitive| !primitive.triangles.is_empty());
        (!self.primitives.is_empty()).then_some(self)
    }

    /// Returns for each vertex the first one that is equal in every attribute.
    fn first_of_same(&self, count: usize) -> Vec<u32> {
        let all: Vec<&StoredAttribute> =
            self.attributes.iter().chain(self.targets.iter().flatten()).collect();
        let compare = |a: u32, b: u32| {
            let each = all.iter().map(|of| of.element(a as usize).cmp(of.element(b as usize)));
            each.fold(Ordering::Equal, Ordering::then)
        };
        let mut same: Vec<u32> = (0..count as u32).collect();
        let mut sorted = same.clone();
        sorted.sort_unstable_by(|a, b| compare(*a, *b).then(a.cmp(b)));
        for pair in sorted.windows(2) {
            if compare(pair[0], pair[1]) == Ordering::Equal {
                same[pair[1] as usize] = same[pair[0] as usize];
            }
        }
        same
    }
}

impl StoredAttribute {
    /// Returns `true` if it is as glTF defines it, with numbers that can be packed: positions are finite, and no
    /// element has more than 16 bytes.
    fn can_be_packed(&self) -> bool {
        let Supplied { component, width, bytes } = &self.elements;
        let is_finite = |word: &[u8; 4]| !self.is_float() || f32::from_le_bytes(*word).is_finite();
        let has_width = match self.name.as_str() {
            POSITION => *width == 3 && bytes.as_chunks::<4>().0.iter().all(is_finite),
            "NORMAL" => *width == 3,
            "TANGENT" => matches!(width, 3 | 4),
            _ => true,
        };
        has_width && width * component.size() <= 16
    }

    /// Returns `true` if it holds floats.
    pub fn is_float(&self) -> bool {
        self.elements.component == ComponentType::F32
    }

    /// Returns the components of a vertex as numbers; integers are not normalised.
    pub fn numbers(&self, vertex: usize) -> impl Iterator<Item = f32> {
        let component = self.elements.component;
        self.element(vertex).chunks_exact(component.size()).map(move |bytes| float(bytes, component, false))
    }

    /// Returns the components of a vertex as numbers; normalised integers map to [0, 1] or [−1, 1].
    pub fn unit_numbers(&self, vertex: usize) -> impl Iterator<Item = f32> {
        let component = self.elements.component;
        let number = move |bytes: &[u8]| float(bytes, component, self.is_normalized);
        self.element(vertex).chunks_exact(component.size()).map(number)
    }

    /// Returns the bytes of a vertex.
    pub fn element(&self, vertex: usize) -> &[u8] {
        let size = self.elements.width * self.elements.component.size();
        &self.elements.bytes[vertex * size..][..size]
    }
}

fn spend(budget: &mut usize, elements: usize) -> Reason<()> {
    *budget = budget.checked_sub(elements).ok_or("its primitives share bytes too often")?;
    Ok(())
}

/// Returns the items of a list.
fn list<'v>(json: &'v Value, name: &str) -> impl Iterator<Item = &'v Value> {
    json.get(name).and_then(Value::as_array).into_iter().flatten()
}

fn number(of: &Value, name: &str) -> Option<usize> {
    usize::try_from(of.get(name)?.as_u64()?).ok()
}

/// The tangents of a primitive.
pub(crate) struct MissingTangents {
    /// The index of its mesh in the file.
    pub mesh: usize,
    /// Its index in the mesh.
    pub primitive: usize,
    /// The tangents, in vertex order.
    pub tangents: Vec<[f32; 4]>,
}

/// Computes the tangents of the primitives in the file of `reading` that use one of `materials`, given by index, and
/// have normals and uvs but no tangents. Skips primitives whose vertices would have to be split, and those beyond the
/// budget of a file of its size.
///
/// # Errors
/// Those of reading the file; [`taotie_engine::Error::Limit`] if its meshes do not fit in memory.
pub(crate) fn missing_tangents(
    source: GltfSource<'_>,
    reading: &Arc<Reading>,
    materials: &[usize],
) -> Result<Vec<MissingTangents>> {
    let content = source.bytes(reading)?.into_owned();
    let document = Document::of(reading, content, &mut Warnings::default())?;
    let mut budget = most_elements(&document);
    let count = document.root.materials.len();
    let mut found = Vec::new();
    for (mesh, json) in document.root.meshes.iter().enumerate() {
        for (primitive, json) in json.primitives.iter().enumerate() {
            let material = json.material.map_or(count, |material| material.value().min(count));
            if !materials.contains(&material) {
                continue;
            }
            if let Some(tangents) = tangents(&document, json, &mut budget) {
                found.push(MissingTangents { mesh, primitive, tangents });
            }
        }
    }
    // A primitive skipped for lack of memory must not pass as one without missing tangents.
    reading.check()?;
    Ok(found)
}

fn tangents(document: &Document, primitive: &Primitive, budget: &mut usize) -> Option<Vec<[f32; 4]>> {
    let has = |semantic: Semantic| attribute(primitive, semantic).is_some();
    if extension(primitive, DRACO).is_some()
        || has(Semantic::Tangents)
        || !has(Semantic::Normals)
        || !has(Semantic::TexCoords(0))
    {
        return None;
    }
    let Checked::Valid(mode) = primitive.mode else { return None };
    let vertices = Vertices::open(document, primitive).ok()??;
    let indices = primitive.indices.map(|index| Accessor::open(document, index.value()));
    let indices = indices.transpose().ok()?;
    let count = indices.as_ref().map_or(0, |indices| indices.count);
    *budget = budget.checked_sub(vertices.count.checked_add(count)?)?;
    if !document.reading.take(bytes_of(vertices.count, count)) {
        return None;
    }
    let triangles = triangulate(mode, &read_indices(indices.as_ref(), vertices.count).ok()?)?.list;
    let all: Vec<u32> = (0..vertices.count as u32).collect();
    let mut data = vertices.read(&all, "", &mut Warnings::default());
    data.triangles = triangles;
    repair(&mut data, &mut Warnings::default());
    one_a_vertex(&Mesh::new(data).ok()?)
}

/// Returns the tangent of each vertex; `None` if a vertex has several.
fn one_a_vertex(mesh: &Mesh) -> Option<Vec<[f32; 4]>> {
    let made = with_tangents(mesh, 0, TangentMethod::MikkTSpace).ok()?.mesh;
    let mut found = vec![None; mesh.positions().len()];
    let corners = mesh.triangles().as_flattened().iter().zip(made.triangles().as_flattened());
    for (vertex, split) in corners {
        let tangent = made.tangents()[*split as usize];
        if found[*vertex as usize].replace(tangent).is_some_and(|known| known != tangent) {
            return None;
        }
    }
    // Vertices without triangles still need a tangent of length 1.
    Some(found.into_iter().map(|tangent| tangent.unwrap_or([1.0, 0.0, 0.0, 1.0])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::{Vec2, Vec3};
    use taotie_engine::mesh::MeshData;

    /// Two triangles that share an edge, the second with mirrored uvs if `is_mirrored`.
    fn pair(is_mirrored: bool) -> Mesh {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let uv = |x: f32, y: f32| Vec2::new(x, 1.0 - y);
        let last = if is_mirrored { uv(0.0, 0.0) } else { uv(1.0, 1.0) };
        Mesh::new(MeshData {
            positions: vec![
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(0.0, 1.0),
                corner(1.0, 1.0),
                corner(9.0, 9.0),
            ],
            normals: vec![Vec3::new(0.0, 0.0, 1.0); 5],
            uvs: vec![vec![uv(0.0, 0.0), uv(1.0, 0.0), uv(0.0, 1.0), last, uv(0.0, 0.0)]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..MeshData::default()
        })
        .unwrap()
    }

    #[test]
    fn vertices_with_two_tangents_get_none() {
        let found = one_a_vertex(&pair(false)).expect("each vertex has one");
        let is_right = |[x, y, z, w]: &[f32; 4]| (x - 1.0).abs() + y.abs() + z.abs() < 1e-6 && *w == 1.0;
        assert!(found.len() == 5 && found.iter().all(is_right), "{found:?}");
        assert_eq!(one_a_vertex(&pair(true)), None);
    }
}
