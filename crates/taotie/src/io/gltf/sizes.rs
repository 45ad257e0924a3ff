//! The sizes in bytes of a document's contents.

use super::document::Document;
use super::extensions::{DRACO, extension};
use super::images::{image_name, sources};
use super::meshopt;
use super::source::GltfSource;
use super::uri::{self, ByteSource};
use crate::error::{Result, Warnings};
use crate::io::bitmap::{ImageHeader, KTX2_TYPE};
use crate::io::file::open;
use crate::io::limits::Limits;
use crate::io::reading::Reading;
use crate::io::sizes::{ContentSize, GltfSizes, ImageSize};
use gltf::json::accessor::Accessor;
use gltf::json::buffer::View;
use gltf::json::mesh::Primitive;
use gltf::json::validation::Checked;
use gltf::json::{Index, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufReader, Cursor};
use std::sync::Arc;

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

impl GltfSizes {
    /// Reads the sizes of a `.gltf` or `.glb` file. Images are not decoded.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) and [`Error::Parse`](crate::Error::Parse) if it cannot be read,
    /// [`Error::Limit`](crate::Error::Limit) if its buffers do not fit in memory.
    pub fn read(source: GltfSource<'_>, limits: &Limits) -> Result<Self> {
        let reading = Arc::new(Reading::new(source.path(), limits));
        let content = source.bytes(&reading)?.into_owned();
        let sizes = of(&Document::of(&reading, content, &mut Warnings::default())?);
        reading.check()?;
        Ok(sizes)
    }
}

/// Returns the bytes of a document by content.
fn of(document: &Document) -> GltfSizes {
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
    match uri.and_then(|uri| uri::locate(uri, &document.reading).ok()) {
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
