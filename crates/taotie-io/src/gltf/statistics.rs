//! The sizes of a document's contents, in bytes of the file and of GPU memory, and their counts.

use super::document::Document;
use super::meshopt;
use super::nodes::Nodes;
use super::raw::GltfSource;
use super::raw::{DRACO, extension};
use super::resources::{ByteSource, locate};
use super::textures::{image_name, sources};
use crate::bitmap::{ImageHeader, KTX2_TYPE};
use crate::file::open;
use crate::limits::Limits;
use crate::loaded::{GltfStructure, RootNode};
use crate::reading::Reading;
use gltf::json::accessor::Accessor;
use gltf::json::buffer::View;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufReader, Cursor};
use std::sync::Arc;
use taotie_engine::error::{Result, Warnings};

/// The bytes of a glTF file by content.
///
/// ```
/// use taotie_io::{GltfSizes, GltfSource, Limits};
/// use taotie_engine::mesh::Mesh;
/// use taotie_engine::scene::{Material, Scene};
/// use taotie_engine::Warnings;
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let vertices = ball.meshes()[0].positions().len() as u64;
/// let file = taotie_io::encode_scene(&ball, &[], &mut Warnings::default())?;
/// let sizes = GltfSizes::read(GltfSource::Glb(&file), &Limits::default())?;
/// let positions = sizes.attributes.iter().find(|size| size.name == "POSITION").expect("every mesh has positions");
/// assert_eq!((positions.bytes, positions.gpu_bytes), (vertices * 12, vertices * 12));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct GltfSizes {
    /// Bytes of the JSON, without the content of data URIs.
    pub json: u64,
    /// Vertex attributes by name, in alphabetical order. Morph targets are one entry, `morph targets`; so are
    /// primitives compressed by Draco, `Draco`.
    pub attributes: Vec<ContentSize>,
    /// Index buffers.
    pub indices: ContentSize,
    /// Images, in the order of the file.
    pub images: Vec<ImageSize>,
    /// Bytes of animations and skins.
    pub animations: u64,
    /// Bytes of buffers that contain none of these: instance transforms, unused data, padding.
    pub other: u64,
    /// GPU memory for vertices, indices and textures, in bytes. A viewer may use more, such as copies of textures
    /// with other samplers.
    pub gpu_bytes: u64,
}

/// The size of one kind of content.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ContentSize {
    /// The name of a vertex attribute, such as `POSITION`, or `indices`.
    pub name: String,
    /// Bytes in the file, as compressed.
    pub bytes: u64,
    /// GPU memory in bytes: uncompressed, each element a multiple of four bytes.
    pub gpu_bytes: u64,
}

/// The size of an image.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ImageSize {
    /// Its file, else its name, else its index.
    pub name: String,
    /// The media type found in its content, such as `image/png`; empty if unknown.
    pub media_type: String,
    /// Texels across; 0 if unknown.
    pub width: u32,
    /// Texels down; 0 if unknown.
    pub height: u32,
    /// Bytes in the file.
    pub bytes: u64,
    /// GPU memory in bytes with all mip levels: four per texel, one per texel of KTX2 (BC7, ASTC 4×4); 0 if no
    /// texture uses it.
    pub gpu_bytes: u64,
}

impl GltfSizes {
    /// Reads the sizes of a `.gltf` or `.glb` file. Images are not decoded.
    ///
    /// # Errors
    /// [`Error::Io`](taotie_engine::Error::Io) and [`Error::Parse`](taotie_engine::Error::Parse) if it cannot be
    /// read, [`Error::Limit`](taotie_engine::Error::Limit) if its buffers do not fit in memory.
    pub fn read(source: GltfSource<'_>, limits: &Limits) -> Result<Self> {
        let reading = Arc::new(Reading::new(source.path(), limits));
        let content = source.bytes(&reading)?.into_owned();
        let sizes = sizes_of(&Document::of(&reading, content, &mut Warnings::default())?);
        reading.check()?;
        Ok(sizes)
    }

    /// Returns it with the total GPU memory of its parts filled in.
    fn summed(self) -> Self {
        let vertices = self.attributes.iter().chain([&self.indices]).map(|size| size.gpu_bytes);
        let all = vertices.chain(self.images.iter().map(|image| image.gpu_bytes));
        Self { gpu_bytes: all.fold(0, u64::saturating_add), ..self }
    }

    /// Returns the sum of the bytes of all content.
    pub fn bytes(&self) -> u64 {
        let vertices = self.attributes.iter().chain([&self.indices]).map(|size| size.bytes);
        let all = vertices.chain(self.images.iter().map(|image| image.bytes));
        all.chain([self.json, self.animations, self.other]).fold(0, u64::saturating_add)
    }
}

impl ImageSize {
    /// Returns the GPU memory in bytes of an image of this size, with all mip levels.
    pub fn on_gpu(size: [u32; 2], is_block_compressed: bool) -> u64 {
        let [mut width, mut height] = size.map(u64::from);
        let mut bytes: u64 = 0;
        while width > 0 && height > 0 {
            let texels = match is_block_compressed {
                // 16 bytes per block of 4×4 texels.
                true => (width.div_ceil(4) * height.div_ceil(4)).saturating_mul(16),
                false => (width * height).saturating_mul(4),
            };
            bytes = bytes.saturating_add(texels);
            if width == 1 && height == 1 {
                break;
            }
            [width, height] = [width, height].map(|side| (side / 2).max(1));
        }
        bytes
    }
}

/// The content of an accessor or a buffer view.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Content {
    /// Elements of vertices, by attribute name.
    Attribute(String),
    Indices,
    Animation,
    /// The index of an image.
    Image(usize),
}

/// The name of the entry for morph targets, and for primitives compressed by Draco.
const MORPH_TARGETS: &str = "morph targets";
const OF_DRACO: &str = "Draco";

/// Returns the bytes of a document by content.
pub(super) fn sizes_of(document: &Document) -> GltfSizes {
    let accessors = accessors(document);
    let stored = stored_bytes(document, &accessors);
    let on_gpu = gpu_bytes(document, &accessors);
    let size = |content: &Content, name: &str| ContentSize {
        name: name.to_owned(),
        bytes: stored.get(content).copied().unwrap_or_default(),
        gpu_bytes: on_gpu.get(content).copied().unwrap_or_default(),
    };
    let contents: BTreeSet<&Content> = stored.keys().chain(on_gpu.keys()).collect();
    let attributes = contents.into_iter().filter_map(|content| match content {
        Content::Attribute(name) => Some(size(content, name)),
        _ => None,
    });
    let in_buffers = stored.values().fold(0, |sum: u64, bytes| sum.saturating_add(*bytes));
    GltfSizes {
        json: json_bytes(document),
        attributes: attributes.collect(),
        indices: size(&Content::Indices, "indices"),
        images: images(document, &stored),
        animations: size(&Content::Animation, "").bytes,
        other: buffer_bytes(document).saturating_sub(in_buffers),
        gpu_bytes: 0,
    }
    .summed()
}

/// Returns the GPU memory in bytes that each content needs.
fn gpu_bytes(document: &Document, accessors: &BTreeMap<usize, Content>) -> BTreeMap<Content, u64> {
    let mut sums: BTreeMap<Content, u64> = BTreeMap::new();
    for (index, content) in accessors {
        let Some(accessor) = document.root.accessors.get(*index) else { continue };
        let bytes = match content {
            Content::Attribute(_) => bytes_of(accessor, 4),
            Content::Indices => bytes_of(accessor, 1),
            Content::Animation | Content::Image(_) => continue,
        };
        let sum = sums.entry(content.clone()).or_default();
        *sum = sum.saturating_add(bytes);
    }
    sums
}

/// Returns the content of each accessor that the document uses.
fn accessors(document: &Document) -> BTreeMap<usize, Content> {
    let root = &document.root;
    let mut found = BTreeMap::new();
    let mut add = |index: usize, content: Content| {
        found.entry(index).or_insert(content);
    };
    for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        for (semantic, index) in &primitive.attributes {
            let Checked::Valid(semantic) = semantic else { continue };
            add(index.value(), Content::Attribute(semantic.to_string()));
        }
        for index in primitive.targets.iter().flatten().flat_map(morphed) {
            add(index.value(), Content::Attribute(MORPH_TARGETS.into()));
        }
        if let Some(index) = primitive.indices {
            add(index.value(), Content::Indices);
        }
    }
    let skins = root.skins.iter().filter_map(|skin| skin.inverse_bind_matrices);
    skins.for_each(|index| add(index.value(), Content::Animation));
    for sampler in
        document.animations.iter().filter_map(|animation| animation["samplers"].as_array()).flatten()
    {
        let ends = ["input", "output"].into_iter().filter_map(|end| sampler[end].as_u64());
        ends.for_each(|index| add(usize::try_from(index).unwrap_or(usize::MAX), Content::Animation));
    }
    found
}

fn morphed(target: &gltf::json::mesh::MorphTarget) -> impl Iterator<Item = Index<Accessor>> {
    [target.positions, target.normals, target.tangents].into_iter().flatten()
}

/// Returns the bytes of each content in the buffers. A shared view is divided in proportion to the size of the
/// elements.
fn stored_bytes(document: &Document, accessors: &BTreeMap<usize, Content>) -> BTreeMap<Content, u64> {
    let root = &document.root;
    let mut shares: BTreeMap<usize, BTreeMap<Content, u64>> = BTreeMap::new();
    let mut share = |view: usize, content: &Content, weight: u64| {
        let own = shares.entry(view).or_default().entry(content.clone()).or_default();
        *own = own.saturating_add(weight.max(1));
    };
    for (index, content) in accessors {
        let Some(accessor) = root.accessors.get(*index) else { continue };
        if let Some(view) = accessor.buffer_view {
            share(view.value(), content, bytes_of(accessor, 1));
        }
        let sparse = accessor.sparse.iter();
        let views = sparse.flat_map(|sparse| [sparse.indices.buffer_view, sparse.values.buffer_view]);
        views.for_each(|view| share(view.value(), content, 1));
    }
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    primitives.filter_map(draco_view).for_each(|view| share(view, &Content::Attribute(OF_DRACO.into()), 1));
    for (number, view) in
        root.images.iter().enumerate().filter_map(|(i, image)| Some((i, image.buffer_view?)))
    {
        share(view.value(), &Content::Image(number), 1);
    }
    let mut stored = BTreeMap::new();
    for (index, shares) in shares {
        let Some(view) = root.buffer_views.get(index) else { continue };
        divide(view_bytes(view), &shares, &mut stored);
    }
    stored
}

/// Distributes the bytes of a view among its contents, in proportion.
fn divide(bytes: u64, shares: &BTreeMap<Content, u64>, stored: &mut BTreeMap<Content, u64>) {
    let all: u128 = shares.values().map(|weight| u128::from(*weight)).sum();
    let (mut left, mut weight_left) = (bytes, all);
    for (content, weight) in shares {
        let own = (u128::from(left) * u128::from(*weight) / weight_left.max(1)) as u64;
        let sum: &mut u64 = stored.entry(content.clone()).or_default();
        *sum = sum.saturating_add(own);
        (left, weight_left) = (left - own, weight_left - u128::from(*weight));
    }
}

fn draco_view(primitive: &Primitive) -> Option<usize> {
    let view = extension(primitive, DRACO)?.get("bufferView")?.as_u64()?;
    usize::try_from(view).ok()
}

/// Returns the number of bytes of a view in the file, as compressed.
fn view_bytes(view: &View) -> u64 {
    let packed = meshopt::of_view(view).and_then(|json| json.get("byteLength")).and_then(Value::as_u64);
    packed.unwrap_or(view.byte_length.0)
}

/// Returns the number of bytes of the elements of an accessor, each a multiple of `unit`.
fn bytes_of(accessor: &Accessor, unit: u64) -> u64 {
    let (Checked::Valid(kind), Checked::Valid(component)) = (accessor.type_, accessor.component_type) else {
        return 0;
    };
    let element = (kind.multiplicity() * component.0.size()) as u64;
    accessor.count.0.saturating_mul(element.next_multiple_of(unit))
}

fn buffer_bytes(document: &Document) -> u64 {
    let stored = document.root.buffers.iter().filter(|buffer| !meshopt::is_fallback(buffer));
    stored.map(|buffer| buffer.byte_length.0).fold(0, u64::saturating_add)
}

fn json_bytes(document: &Document) -> u64 {
    let buffers = document.root.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let uris = buffers.chain(document.root.images.iter().filter_map(|image| image.uri.as_deref()));
    let data: usize = uris.filter(|uri| uri.starts_with("data:")).map(str::len).sum();
    document.json_bytes.saturating_sub(data as u64)
}

fn images(document: &Document, stored: &BTreeMap<Content, u64>) -> Vec<ImageSize> {
    let textures = 0..document.root.textures.len();
    let first = |texture| sources(document, texture).ok()?.into_iter().next();
    let shown: BTreeSet<usize> = textures.filter_map(first).collect();
    let image = |number: usize| {
        let name = image_name(document, number);
        let (header, bytes) = match stored.get(&Content::Image(number)) {
            Some(bytes) => (embedded(document, number), *bytes),
            None => external(document, number),
        };
        let (size, media_type) = header.map_or(([0; 2], ""), |header| (header.size, header.media_type));
        let gpu_bytes = match shown.contains(&number) {
            true => ImageSize::on_gpu(size, media_type == KTX2_TYPE),
            false => 0,
        };
        let [width, height] = size;
        ImageSize { name, media_type: media_type.into(), width, height, bytes, gpu_bytes }
    };
    (0..document.root.images.len()).map(image).collect()
}

fn embedded(document: &Document, number: usize) -> Option<ImageHeader> {
    let (bytes, _) = document.view(document.root.images[number].buffer_view?.value()).ok()?;
    ImageHeader::read(Cursor::new(bytes))
}

/// Returns the header and the size in bytes of an image outside the buffers.
fn external(document: &Document, number: usize) -> (Option<ImageHeader>, u64) {
    let uri = document.root.images[number].uri.as_deref();
    match uri.and_then(|uri| locate(uri, &document.reading).ok()) {
        Some(ByteSource::Data { bytes, .. }) => {
            let length = bytes.len() as u64;
            (ImageHeader::read(Cursor::new(bytes)), length)
        }
        Some(ByteSource::File(path)) => match open(&path) {
            Ok((file, length)) => (ImageHeader::read(BufReader::new(file)), length),
            Err(_) => (None, 0),
        },
        None => (None, 0),
    }
}

/// Returns the counts of the document's contents.
pub(super) fn structure(document: &Document, nodes: &Nodes) -> GltfStructure {
    let root = &document.root;
    let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    GltfStructure {
        nodes: root.nodes.len(),
        meshes: root.meshes.len(),
        primitives: primitives().count(),
        triangles: primitives().fold(0, |sum, one| sum.saturating_add(triangles(document, one))),
        materials: root.materials.len(),
        roots: roots(document, nodes),
    }
}

/// Returns the number of triangles implied by a primitive's accessors and mode; 0 for points and lines.
fn triangles(document: &Document, primitive: &Primitive) -> usize {
    let positions = || primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let accessor = primitive.indices.as_ref().or_else(positions);
    let accessor = accessor.and_then(|index| document.root.accessors.get(index.value()));
    let corners = accessor.map_or(0, |accessor| usize::try_from(accessor.count.0).unwrap_or(usize::MAX));
    match primitive.mode {
        Checked::Valid(Mode::Triangles) => corners / 3,
        Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => corners.saturating_sub(2),
        _ => 0,
    }
}

fn roots(document: &Document, nodes: &Nodes) -> Vec<RootNode> {
    let json = &document.root.nodes;
    let mut is_root = vec![false; json.len()];
    // The root above each node; parents come before their children.
    let mut root_of: Vec<usize> = (0..json.len()).collect();
    for node in nodes.shown.iter().copied() {
        if let Some(parent) = nodes.nodes[node].parent {
            root_of[node] = root_of[parent];
        }
        is_root[root_of[node]] |= json[node].mesh.is_some();
    }
    let roots = (0..json.len()).filter(|node| is_root[*node]);
    roots
        .map(|node| RootNode {
            name: json[node].name.clone().unwrap_or_else(|| format!("node {node}")),
            world_from_node: nodes.world[node],
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mip_levels_count() {
        assert_eq!(ImageSize::on_gpu([4, 2], false), (8 + 2 + 1) * 4);
        assert_eq!(ImageSize::on_gpu([1024, 1024], false), 5_592_404);
        assert_eq!(ImageSize::on_gpu([8, 8], true), (4 + 1 + 1 + 1) * 16);
        assert_eq!(ImageSize::on_gpu([0, 8], false), 0);
        assert_eq!([true, false].map(|is| ImageSize::on_gpu([u32::MAX; 2], is)), [u64::MAX; 2]);
    }
}
