//! Packs a complete glTF file: everything is preserved — nodes, materials, uvs, skins, morph targets, animations,
//! extensions — with fewer bits per vertex, simplified triangles, and re-encoded images.

mod geometry;
mod tracks;

use super::codec::CodecKind;
use super::draft::{Packing, encoded_glb, unpacked_buffer};
use super::edit;
use super::format::{CodecSet, VertexBits};
use super::graft::{Storage, take_along};
use super::image_encoding::LossyTexture;
use super::stream::{PackedTriangles, Stream};
use crate::gltf::{
    Content, GltfSource, INSTANCING, OF_TEXTURES, POLYGONS, RawGltf, StoredTrack, StoredVertices,
    image_bytes, uses,
};
use crate::limits::Limits;
use geometry::{Precision, Shaped, Simplified};
use meshopt::SimplifyVertex;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding};
use taotie_engine::scene::LAYERS;
use tracks::Arrays;

/// A glTF file that can be packed in several ways. Tangents that no material reads are dropped. Meshes packed by an
/// extension are copied unchanged; so are images that cannot be decoded, are KTX2, or have a use that is not rendered
/// here.
///
/// ```
/// use taotie_io::{GltfPacker, GltfSource, Limits, PackedGeometry};
/// use taotie_engine::mesh::Mesh;
/// use taotie_engine::scene::{Material, Scene};
/// use taotie_engine::Warnings;
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 64, 32), Material::default())?;
/// let file = taotie_io::encode_scene(&ball, &[], &mut Warnings::default())?;
/// let packer = GltfPacker::open(GltfSource::Glb(&file), &Limits::default())?;
/// let packed = packer.encode(PackedGeometry { kept: 0.5, ..PackedGeometry::default() }, &[])?;
/// assert!(packed.len() < file.len() / 5);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug)]
pub struct GltfPacker {
    /// The document without the packed content.
    json: Value,
    /// The bytes of everything that is not packed.
    bytes: Vec<u8>,
    vertices: Vec<StoredVertices>,
    /// The longest side of the mesh for each of these.
    extents: Vec<f64>,
    /// The locks of each of these; none if there is only one primitive, shown once.
    locks: Vec<Vec<SimplifyVertex>>,
    tracks: Vec<StoredTrack>,
    images: Vec<Option<OwnImage>>,
    longest_side: Option<u32>,
}

/// The options for packing the meshes of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackedGeometry {
    /// The fraction of triangles that is kept, (0, 1]; the others are simplified away, primitive by primitive. Files with
    /// animations or skins keep all of them.
    pub kept: f64,
    /// Bits of vertices. Positions have 2^bits to 2^(bits+1) steps along the longest side of a mesh.
    pub bits: VertexBits,
    /// The codec set, which determines the extension for packing meshes.
    pub codecs: CodecSet,
}

impl Default for PackedGeometry {
    fn default() -> Self {
        Self { kept: 1.0, bits: VertexBits::default(), codecs: CodecSet::default() }
    }
}

/// A re-encoded image of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedImage {
    /// Its index in the file.
    pub number: usize,
    /// The longer side in texels.
    pub side: u32,
    /// Its file.
    pub bytes: Arc<Vec<u8>>,
}

impl GltfPacker {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Parse`] if it cannot be read, [`Error::Limit`] if that exceeds a limit.
    pub fn open(source: GltfSource<'_>, limits: &Limits) -> Result<Self> {
        let mut raw = RawGltf::read(source, limits)?;
        drop_unread_tangents(&mut raw.json);
        let Content { mut vertices, tracks, images } = Content::read(source, &raw)?;
        let longest_side = longest_side(&raw.json, &images);
        let images = taken_images(&mut raw, images)?;
        let extents = geometry::extents(&vertices);
        vertices.iter_mut().zip(&extents).for_each(|(own, extent)| geometry::join_copies(own, *extent));
        let is_alone = is_alone(&raw.json);
        let locks = |vertices| if is_alone { Vec::new() } else { geometry::locks(vertices) };
        let locks = vertices.iter().map(locks).collect();
        drop_geometry(&mut raw.json, &vertices);
        let tracks = tracks::taken(&mut raw.json, tracks);
        let bytes = used_bytes(&mut raw)?;
        Ok(Self { json: raw.json, bytes, vertices, tracks, extents, locks, images, longest_side })
    }

    /// Returns the number of images.
    pub fn image_count(&self) -> usize {
        self.images.len()
    }

    /// Returns an image that can be re-encoded; `None` if it is copied unchanged.
    pub fn image(&self, number: usize) -> Option<&LossyTexture> {
        self.images.get(number)?.as_ref().map(|own| &own.texture)
    }

    /// Returns the kind and size in bytes of a stored image; `None` if it is copied unchanged.
    pub fn stored(&self, number: usize) -> Option<(CodecKind, usize)> {
        self.images.get(number)?.as_ref().map(|own| (own.kind, own.stored.len()))
    }

    /// Returns the longest side of any image in texels, 0 if there are none; `None` if one is unknown, or if uv
    /// transforms make texels finer.
    pub fn longest_side(&self) -> Option<u32> {
        self.longest_side
    }

    /// Returns the packed file as GLB, with these images replacing its own.
    ///
    /// # Errors
    /// [`Error::Limit`] for a GLB of 4 GiB or more; [`Error::Invalid`] for a number out of range.
    pub fn encode(&self, geometry: PackedGeometry, images: &[PackedImage]) -> Result<Vec<u8>> {
        geometry.bits.check()?;
        if !(geometry.kept > 0.0 && geometry.kept <= 1.0) {
            return Err(Error::invalid(
                format!("fraction of triangles {}", geometry.kept),
                "use more than 0 and at most 1",
            ));
        }
        // At rest, nothing shows which triangles a motion needs.
        let kept = if moves(&self.json) { 1.0 } else { geometry.kept };
        let mut file = Packed::new(&self.json, self.bytes.clone(), geometry.codecs);
        for ((vertices, extent), locks) in self.vertices.iter().zip(&self.extents).zip(&self.locks) {
            let simplified = Simplified::new(vertices, locks, kept);
            let precision = Precision { bits: geometry.bits, extent: *extent };
            file.add_vertices(&simplified.vertices, &Shaped::new(&simplified), &precision)?;
        }
        file.add_tracks(&self.tracks)?;
        let own = self.images.iter().enumerate().filter_map(|(number, own)| Some((number, own.as_ref()?)));
        for (number, own) in own {
            file.add_image(number, own, images.iter().find(|image| image.number == number));
        }
        file.glb()
    }
}

/// Returns the longest side of any image; `None` if one is unknown, or if there are uv transforms.
fn longest_side(json: &Value, images: &[Option<Bitmap>]) -> Option<u32> {
    let transform = Value::from("KHR_texture_transform");
    if edit::items(json, "extensionsUsed").contains(&transform) {
        return None;
    }
    let side = |image: &Option<Bitmap>| image.as_ref().map(|bitmap| bitmap.width().max(bitmap.height()));
    images.iter().map(side).try_fold(0, |longest, side| Some(side?.max(longest)))
}

/// Returns `true` if a document has one primitive shown by one node, so that no other touches its border.
fn is_alone(json: &Value) -> bool {
    let primitives = edit::items(json, "meshes").iter().map(|mesh| edit::items(mesh, "primitives").len());
    let shown: Vec<_> = edit::items(json, "nodes").iter().filter(|node| node.get("mesh").is_some()).collect();
    let is_once = |node: &Value| node.pointer(&format!("/extensions/{INSTANCING}")).is_none();
    primitives.sum::<usize>() == 1 && matches!(shown[..], [only] if is_once(only))
}

/// Returns `true` if a document has animations or skins.
fn moves(json: &Value) -> bool {
    ["animations", "skins"].iter().any(|name| !edit::items(json, name).is_empty())
}

/// Drops the tangents of primitives whose material does not use them: it has neither a normal map nor a layer with a
/// direction.
fn drop_unread_tangents(json: &mut Value) {
    let directed = LAYERS.iter().filter(|layer| layer.has_direction()).map(|layer| layer.extension);
    let readers: Vec<&str> = directed.chain(["ormalTexture\""]).collect();
    let reads = |material: &Value| {
        let text = material.to_string();
        readers.iter().any(|name| text.contains(name))
    };
    let reads: Vec<bool> = edit::items(json, "materials").iter().map(reads).collect();
    let primitives = edit::items_mut(json, "meshes").flat_map(|mesh| edit::items_mut(mesh, "primitives"));
    for primitive in primitives {
        let own = edit::number(primitive, "material").is_some_and(|own| reads.get(own) != Some(&false));
        // Variants may use other materials, and targets move existing tangents.
        let may_be_read = primitive.pointer("/extensions/KHR_materials_variants").is_some();
        if own || may_be_read || primitive.get("targets").is_some() {
            continue;
        }
        if let Some(attributes) = primitive.get_mut("attributes") {
            edit::remove(attributes, "TANGENT");
        }
    }
}

/// Removes the vertex accessors and their triangles from a document.
fn drop_geometry(json: &mut Value, vertices: &[StoredVertices]) {
    let primitives = vertices.iter().flat_map(|vertices| &vertices.primitives);
    for [mesh, primitive] in primitives.flat_map(|primitive| &primitive.places) {
        let json = &mut json["meshes"][*mesh]["primitives"][*primitive];
        ["indices", "targets", "mode"].iter().for_each(|name| edit::remove(json, name));
        edit::remove_extension(json, POLYGONS);
        json["attributes"] = Value::Object(Map::new());
    }
}

/// Drops the accessors and views that are no longer used, and returns the bytes of the others. If unknown extensions contain
/// numbers, which may refer to accessors or views, those with such a number are kept, and the others are only emptied.
///
/// # Errors
/// [`taotie_engine::Error::Parse`] if a view refers to missing bytes.
fn used_bytes(raw: &mut RawGltf) -> Result<Vec<u8>> {
    let foreign = edit::foreign_numbers(&raw.json);
    let [of_accessors, of_views]: [edit::Visit; 2] = [edit::each_accessor, edit::each_view];
    for (list, each) in [("accessors", of_accessors), ("bufferViews", of_views)] {
        match foreign.is_empty() {
            true => drop(edit::drop_unnamed(&mut raw.json, list, each)),
            false => edit::empty_unnamed(&mut raw.json, list, (each, &foreign)),
        }
    }
    edit::joined_buffers(raw)
}

/// A packed file under construction.
struct Packed {
    json: Value,
    bytes: Vec<u8>,
    /// The buffer that packed views unpack to, which follows those of the file, and its bytes.
    fallback: usize,
    unpacked: usize,
    codecs: CodecSet,
}

impl Packed {
    fn new(json: &Value, bytes: Vec<u8>, codecs: CodecSet) -> Self {
        let fallback = edit::items(json, "buffers").len().max(1);
        Self { json: json.clone(), bytes, fallback, unpacked: 0, codecs }
    }

    /// Appends bytes at a multiple of four; returns their start.
    fn append(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        start
    }

    fn packed_view(&mut self, bytes: &[u8], packing: &Packing) -> usize {
        let view = packing.view([self.append(bytes), bytes.len()], (self.fallback, self.unpacked));
        self.unpacked = (self.unpacked + packing.size()).next_multiple_of(4);
        edit::push(&mut self.json, "bufferViews", view)
    }

    /// Adds vertices, and the triangles of their primitives.
    fn add_vertices(&mut self, from: &StoredVertices, shaped: &Shaped, precision: &Precision) -> Result<()> {
        let codecs = self.codecs;
        edit::require(&mut self.json, codecs.meshopt());
        let mut named = |streams: Vec<Stream>| -> Result<Value> {
            let mut attributes = json!({});
            for stream in streams {
                if matches!(stream.name.as_str(), "NORMAL" | "TANGENT") && stream.filter == Some("OCTAHEDRAL")
                {
                    edit::require(&mut self.json, "KHR_mesh_quantization");
                }
                let view = self.packed_view(&stream.packed(codecs)?, &stream.packing(codecs));
                let accessor = edit::push(&mut self.json, "accessors", stream.accessor(view));
                attributes[&stream.name] = accessor.into();
            }
            Ok(attributes)
        };
        let attributes = named(precision.attributes(&from.attributes, &shaped.order))?;
        let targets = from.targets.iter().map(|target| named(precision.target(target, &shaped.order)));
        let targets = targets.collect::<Result<Vec<_>>>()?;
        for (primitive, triangles) in from.primitives.iter().zip(&shaped.triangles) {
            let packed = PackedTriangles::new(triangles, shaped.order.len(), codecs)?;
            let view = self.packed_view(&packed.bytes, &packed.packing);
            let indices = edit::push(&mut self.json, "accessors", packed.accessor(view));
            for [mesh, place] in &primitive.places {
                let json = &mut self.json["meshes"][*mesh]["primitives"][*place];
                json["attributes"] = attributes.clone();
                json["indices"] = indices.into();
                if !targets.is_empty() {
                    json["targets"] = json!(targets);
                }
            }
        }
        Ok(())
    }

    /// Adds the times and values of tracks: all of the same layout in one view.
    fn add_tracks(&mut self, tracks: &[StoredTrack]) -> Result<()> {
        let Arrays { streams, of_tracks } = Arrays::of(tracks);
        let mut views: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (i, stream) in streams.iter().enumerate() {
            views.entry((stream.width, stream.filter)).or_default().push(i);
        }
        let mut accessors = vec![0; streams.len()];
        for numbers in views.into_values() {
            let Some(joined) = Stream::joined(numbers.iter().map(|i| &streams[*i])) else { continue };
            edit::require(&mut self.json, self.codecs.meshopt());
            let packing = Packing { target: None, ..joined.packing(self.codecs) };
            let view = self.packed_view(&joined.packed(self.codecs)?, &packing);
            let mut offset = 0;
            for i in numbers {
                let mut accessor = streams[i].accessor(view);
                if offset > 0 {
                    accessor["byteOffset"] = offset.into();
                }
                offset += streams[i].bytes.len();
                accessors[i] = edit::push(&mut self.json, "accessors", accessor);
            }
        }
        for (track, [input, output]) in tracks.iter().zip(of_tracks) {
            let [animation, sampler] = track.place;
            let sampler = &mut self.json["animations"][animation]["samplers"][sampler];
            sampler["input"] = accessors[input].into();
            sampler["output"] = accessors[output].into();
        }
        Ok(())
    }

    /// Adds an image, as stored or re-encoded.
    fn add_image(&mut self, number: usize, own: &OwnImage, packed: Option<&PackedImage>) {
        let bytes = packed.map_or(&own.stored, |packed| &packed.bytes);
        let start = self.append(bytes);
        let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() });
        let view = edit::push(&mut self.json, "bufferViews", view);
        let json = &mut self.json["images"][number];
        *edit::member(json, "bufferView") = view.into();
        let kind = CodecKind::detect(bytes).unwrap_or(own.kind);
        *edit::member(json, "mimeType") = kind.media_type().into();
        if kind != own.kind {
            show_as(kind, &mut self.json, number);
        }
    }

    fn glb(mut self) -> Result<Vec<u8>> {
        for name in OF_TEXTURES {
            edit::drop_unused(&mut self.json, &["textures"], name);
        }
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        if !self.bytes.is_empty() {
            let others = edit::taken(&mut self.json, "buffers").into_iter().skip(1);
            let unpacked = (self.unpacked > 0).then(|| unpacked_buffer(self.unpacked, self.codecs));
            let own = json!({ "byteLength": self.bytes.len() });
            self.json["buffers"] = std::iter::once(own).chain(others).chain(unpacked).collect();
        }
        for codecs in [CodecSet::Portable, CodecSet::WebLatest] {
            edit::drop_unused(&mut self.json, &["buffers", "bufferViews"], codecs.meshopt());
        }
        encoded_glb(edit::text(&self.json)?, &self.bytes)
    }
}

/// An image that can be re-encoded.
#[derive(Debug)]
struct OwnImage {
    texture: LossyTexture,
    /// The bytes of its file.
    stored: Vec<u8>,
    kind: CodecKind,
}

/// Takes the bytes of images out of a document; `None` for an image that stays in it.
///
/// # Errors
/// [`taotie_engine::Error::Io`] if a file cannot be read.
fn taken_images(raw: &mut RawGltf, bitmaps: Vec<Option<Bitmap>>) -> Result<Vec<Option<OwnImage>>> {
    take_along(raw, bitmaps.len(), Storage::Inside)?;
    let is_opaque = is_opaque(&raw.json);
    let own = bitmaps.into_iter().enumerate().map(|(number, bitmap)| {
        let encoding = encoding(&uses(&raw.json, number)).filter(|_| !has_substitute(&raw.json, number))?;
        let stored = image_bytes(raw, raw.json.pointer(&format!("/images/{number}"))?).ok()??;
        let kind = CodecKind::detect(&stored).filter(|kind| *kind != CodecKind::Ktx2)?;
        // The maximum side length of WebP.
        let bits = if encoding == Encoding::Srgb { 8 } else { 16 };
        let fits = |bitmap: &Bitmap| bitmap.bits() <= bits && bitmap.width().max(bitmap.height()) <= 16_383;
        let bitmap = bitmap.filter(|bitmap| cfg!(feature = "webp") && fits(bitmap))?;
        let texture = LossyTexture::new(bitmap, encoding);
        let texture = if is_opaque { texture.without_alpha() } else { texture };
        let json = raw.json.pointer_mut(&format!("/images/{number}"))?;
        ["bufferView", "uri", "mimeType"].iter().for_each(|name| edit::remove(json, name));
        Some(OwnImage { texture, stored, kind })
    });
    Ok(own.collect())
}

/// Returns `true` if no material of a document reads alpha.
fn is_opaque(json: &Value) -> bool {
    let mode = |material: &Value| material.get("alphaMode").is_none_or(|mode| mode == "OPAQUE");
    edit::items(json, "materials").iter().all(mode)
}

/// Returns the encoding of an image's texels according to its uses; `None` if it has several encodings, none, or one
/// whose loss cannot be measured here.
fn encoding(uses: &[String]) -> Option<Encoding> {
    let of = |role: &String| match role.as_str() {
        "normal" => Some(Encoding::Normal),
        "base color" | "emissive" => Some(Encoding::Srgb),
        "metallic roughness" | "occlusion" => Some(Encoding::Linear),
        _ => None,
    };
    let first = of(uses.first()?)?;
    uses.iter().all(|role| of(role) == Some(first)).then_some(first)
}

/// Updates textures to an image whose kind has changed: with the right extension, or without.
fn show_as(kind: CodecKind, json: &mut Value, number: usize) {
    let pointer = |name: &str| format!("/extensions/{name}/source");
    for texture in edit::items_mut(json, "textures") {
        let extended = OF_TEXTURES.iter().find_map(|name| texture.pointer(&pointer(name)));
        if extended.or(texture.get("source")).and_then(Value::as_u64) != Some(number as u64) {
            continue;
        }
        edit::remove(texture, "source");
        let extensions = edit::member(texture, "extensions");
        OF_TEXTURES.iter().for_each(|name| edit::remove(extensions, name));
        match kind.extension() {
            Some(name) => *edit::member(extensions, name) = json!({ "source": number }),
            None => *edit::member(texture, "source") = number.into(),
        }
        if texture["extensions"].as_object().is_none_or(|all| all.is_empty()) {
            edit::remove(texture, "extensions");
        }
    }
    if let Some(name) = kind.extension() {
        edit::require(json, name);
    }
}

/// Returns `true` if a texture has an alternative to this image, which is a fallback for programs that cannot read
/// it.
fn has_substitute(json: &Value, number: usize) -> bool {
    let shows = |texture: &Value, name: &str| texture.pointer(&format!("/extensions/{name}")).is_some();
    let substitutes = |texture: &Value| OF_TEXTURES.iter().any(|name| shows(texture, name));
    let own = |texture: &&Value| edit::number(texture, "source") == Some(number);
    edit::items(json, "textures").iter().filter(own).any(substitutes)
}
