//! A glTF document under construction: its JSON, and the data that its accessors refer to; and the two kinds of files
//! that it becomes, a GLB, or JSON with external files, whose names are relative URIs.

use super::format::CodecSet;
use crate::json::Json;
use crate::write::{FileBytes, FileSet};
use gltf::json::accessor::ComponentType;
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// glTF's constants for the uses of a view.
pub(super) const VERTICES: u32 = 34962;
pub(super) const INDICES: u32 = 34963;

/// Maximum number of vertices for 16-bit indices; 65535 itself restarts a primitive.
pub(super) const MOST_OF_U16: usize = 65535;

/// The component type of an accessor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// Returns its glTF constant.
    fn code(self) -> u32 {
        match self {
            Self::I8 => 5120,
            Self::U8 => 5121,
            Self::I16 => 5122,
            Self::U16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

impl From<ComponentType> for Component {
    fn from(of: ComponentType) -> Self {
        match of {
            ComponentType::I8 => Self::I8,
            ComponentType::U8 => Self::U8,
            ComponentType::I16 => Self::I16,
            ComponentType::U16 => Self::U16,
            ComponentType::U32 => Self::U32,
            ComponentType::F32 => Self::F32,
        }
    }
}

/// Returns an accessor of `count` elements of `width` components, starting at the start of a view.
pub(super) fn accessor(view: usize, (component, width): (Component, usize), count: usize) -> Value {
    let kind = match width {
        1 => "SCALAR",
        2 => "VEC2",
        3 => "VEC3",
        4 => "VEC4",
        _ => "MAT4",
    };
    json!({ "bufferView": view, "componentType": component.code(), "count": count, "type": kind })
}

/// The packing of a compressed view, and its use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Packing {
    /// The number of elements.
    pub count: usize,
    /// The size of each unpacked element in bytes.
    pub stride: usize,
    /// The mode: `ATTRIBUTES` or `TRIANGLES`.
    pub mode: &'static str,
    /// The name of a filter in the extension.
    pub filter: Option<&'static str>,
    /// glTF's constant for its use; `None` for animations, whose views must not state any.
    pub target: Option<u32>,
    /// The codec set whose extension packs it.
    pub codecs: CodecSet,
}

impl Packing {
    /// Returns the unpacked size in bytes.
    pub fn size(&self) -> usize {
        self.count * self.stride
    }

    /// Returns the view of packed bytes with a start and a length in buffer 0. Unpacked, they belong in another
    /// buffer, starting at a given byte.
    pub fn view(&self, [start, length]: [usize; 2], (buffer, unpacked): (usize, usize)) -> Value {
        let Self { count, stride, mode, filter, target, codecs } = *self;
        let mut packed = json!({
            "buffer": 0, "byteOffset": start, "byteLength": length,
            "byteStride": stride, "count": count, "mode": mode,
        });
        if let Some(filter) = filter {
            packed["filter"] = filter.into();
        }
        let mut view = json!({
            "buffer": buffer, "byteOffset": unpacked, "byteLength": self.size(),
            "extensions": { codecs.meshopt(): packed },
        });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        if target == Some(VERTICES) {
            view["byteStride"] = stride.into();
        }
        view
    }
}

/// Returns the buffer that packed views unpack to; it has no data, as the extension demands for files that require
/// it.
pub(super) fn unpacked_buffer(bytes: usize, codecs: CodecSet) -> Value {
    json!({ "byteLength": bytes, "extensions": { codecs.meshopt(): { "fallback": true } } })
}

/// A glTF document under construction: JSON, to which [`GltfDraft::put`] adds anything, and the data that it refers
/// to through accessors.
///
/// Buffers, buffer views, accessors and the names of extensions are added to the JSON last.
#[derive(Debug, Clone, Default)]
pub struct GltfDraft {
    /// The document without buffers, buffer views, accessors and the names of extensions.
    pub(super) json: Value,
    /// The codec set whose extension packs meshes.
    pub(super) codecs: CodecSet,
    bytes: Vec<u8>,
    /// The total unpacked size of the compressed views in bytes.
    unpacked: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
    used: BTreeSet<&'static str>,
    required: BTreeSet<&'static str>,
}

impl GltfDraft {
    /// Starts with this JSON.
    pub(super) fn begun(json: Value, codecs: CodecSet) -> Self {
        Self { json, codecs, ..Self::default() }
    }

    /// Puts a value into the JSON: as member `name` of the object or, if `name` is `-`, at the end of the list that
    /// the JSON pointer `parent` (RFC 6901) refers to. The document itself is the empty pointer.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the pointer does not refer to an object or list.
    pub fn put(&mut self, parent: &str, name: &str, value: Json) -> Result<()> {
        match self.json.pointer_mut(parent) {
            Some(Value::Object(members)) => {
                members.insert(name.to_owned(), value.0);
                Ok(())
            }
            Some(Value::Array(items)) if name == "-" => {
                items.push(value.0);
                Ok(())
            }
            _ => Err(Error::invalid(
                format!("`{name}` at `{parent}`"),
                "the glTF document has no object or list there; add it first",
            )),
        }
    }

    /// Adds elements of `N` floats, 1 to 4, or 16 for matrices; returns the accessor's index.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().copied().flat_map(f32::to_le_bytes).collect();
        self.elements(&bytes, Component::F32, N)
    }

    /// Adds elements like [`Self::floats`], with the minimum and maximum of each component, which glTF requires for
    /// positions and times.
    pub fn bounded_floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let index = self.floats(values);
        let extreme = |of: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
            (0..N).map(|i| values.iter().map(|v| v[i]).fold(start, of)).collect()
        };
        self.accessors[index]["min"] = json!(extreme(f32::min, f32::INFINITY));
        self.accessors[index]["max"] = json!(extreme(f32::max, f32::NEG_INFINITY));
        index
    }

    /// Adds elements of four bytes, such as joints; returns the accessor's index.
    pub fn bytes(&mut self, values: &[[u8; 4]]) -> usize {
        self.elements(values.as_flattened(), Component::U8, 4)
    }

    /// Adds elements of `width` components in their memory layout; returns the accessor's index.
    pub(super) fn elements(&mut self, bytes: &[u8], component: Component, width: usize) -> usize {
        let view = self.view(bytes);
        let json = accessor(view, (component, width), bytes.len() / (width * component.size()));
        self.push_accessor(json)
    }

    pub(super) fn push_accessor(&mut self, json: Value) -> usize {
        self.accessors.push(json);
        self.accessors.len() - 1
    }

    /// Adds a view packed by meshoptimizer; returns its index. Its unpacked data belongs in a second buffer without
    /// data, as the extension demands for files that require it.
    pub(super) fn packed_view(&mut self, bytes: &[u8], packing: &Packing) -> usize {
        let view = packing.view([self.bytes.len(), bytes.len()], (1, self.unpacked));
        self.unpacked = (self.unpacked + packing.size()).next_multiple_of(4);
        self.append(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Registers an extension that programs may ignore.
    pub(super) fn uses(&mut self, extension: &'static str) {
        self.used.insert(extension);
    }

    /// Marks an extension as required: no program without it can read the file.
    pub(super) fn require(&mut self, extension: &'static str) {
        self.used.insert(extension);
        self.required.insert(extension);
    }

    /// Adds bytes and returns the index of their view. Each starts at a multiple of four.
    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.append(bytes);
        self.views.len() - 1
    }

    fn append(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// Marks an accessor as a vertex attribute.
    pub fn mark_vertices(&mut self, accessor: usize) {
        self.mark(accessor, VERTICES);
    }

    /// Marks an accessor as vertex indices.
    pub(super) fn mark_indices(&mut self, accessor: usize) {
        self.mark(accessor, INDICES);
    }

    fn mark(&mut self, accessor: usize, target: u32) {
        let view = self.accessors.get(accessor).and_then(|a| a["bufferView"].as_u64());
        if let Some(view) = view.and_then(|view| self.views.get_mut(view as usize)) {
            view["target"] = target.into();
        }
    }

    /// Returns the text of the whole document; its buffer is the file `uri`, or in the container.
    fn text(&self, uri: Option<String>) -> Result<Vec<u8>> {
        let mut json = self.json.clone();
        let mut buffer = json!({ "byteLength": self.bytes.len() });
        if let Some(uri) = uri {
            buffer["uri"] = uri.into();
        }
        let mut buffers = vec![buffer];
        if self.unpacked > 0 {
            buffers.push(unpacked_buffer(self.unpacked, self.codecs));
        }
        json["buffers"] = json!(buffers);
        json["bufferViews"] = json!(self.views);
        json["accessors"] = json!(self.accessors);
        for (name, extensions) in [("extensionsUsed", &self.used), ("extensionsRequired", &self.required)] {
            if !extensions.is_empty() {
                json[name] = json!(extensions);
            }
        }
        serde_json::to_vec(&json).map_err(|e| Error::invalid("glTF document", e.to_string()))
    }

    /// Writes the document as GLB, completely or not at all.
    ///
    /// # Errors
    /// [`Error::Limit`] if it would be 4 GiB or more, [`Error::Io`] if the file cannot be written.
    pub fn write_glb(&self, path: &Path) -> Result<()> {
        FileSet::one(|files| self.write_glb_in(files, path))
    }

    /// Writes the document as GLB, a file of a set.
    ///
    /// # Errors
    /// As [`GltfDraft::write_glb`].
    pub fn write_glb_in(&self, files: &FileSet, path: &Path) -> Result<()> {
        let head = Head::new(self.text(None)?, self.bytes.len())?;
        files.write_with(path, |mut out| {
            write_chunks(&mut out, &head, &self.bytes).map_err(|e| Error::io(path, e))
        })
    }

    /// Returns the document as GLB.
    ///
    /// # Errors
    /// [`Error::Limit`] if it would be 4 GiB or more.
    pub fn encode_glb(&self) -> Result<Vec<u8>> {
        encoded_glb(self.text(None)?, &self.bytes)
    }

    /// Returns the document as JSON, followed by its data and images as external files.
    pub(super) fn into_files(self, path: &Path, images: Vec<FileBytes>) -> Result<Vec<FileBytes>> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let binary = format!("{stem}.bin");
        let text = self.text(Some(uri(&binary)))?;
        let document = FileBytes { path: path.to_path_buf(), bytes: text };
        let numbers = FileBytes { path: path.with_file_name(&binary), bytes: self.bytes };
        Ok([document, numbers].into_iter().chain(images).collect())
    }
}

/// The kinds of glTF files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Container {
    /// One binary file.
    Glb,
    /// JSON with external files.
    Gltf,
}

impl Container {
    /// Returns the kind of a file by its extension.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for another extension.
    pub fn of(path: &Path) -> Result<Self> {
        let extension =
            path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "glb" => Ok(Self::Glb),
            "gltf" => Ok(Self::Gltf),
            _ => Err(Error::unsupported(
                format!("{}: the file extension '{extension}'", path.display()),
                "use .glb or .gltf",
            )),
        }
    }
}

/// Writes a GLB to `out`: a header, the JSON, which is padded with spaces, and one chunk of binary data, whose length
/// is a multiple of four. Source: glTF 2.0, 4.4.
fn write_chunks(out: &mut dyn Write, head: &Head, binary: &[u8]) -> io::Result<()> {
    out.write_all(b"glTF\x02\0\0\0")?;
    out.write_all(&head.length.to_le_bytes())?;
    out.write_all(&(head.json.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&head.json)?;
    if !binary.is_empty() {
        out.write_all(&(binary.len() as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(binary)?;
    }
    Ok(())
}

/// Returns the GLB for JSON and binary data, whose length is a multiple of four.
///
/// # Errors
/// [`Error::Limit`] if it would be 4 GiB or more.
pub(super) fn encoded_glb(json: Vec<u8>, binary: &[u8]) -> Result<Vec<u8>> {
    let head = Head::new(json, binary.len())?;
    let mut bytes = Vec::with_capacity(head.length as usize);
    write_chunks(&mut bytes, &head, binary).map_err(|e| Error::invalid("glTF document", e.to_string()))?;
    Ok(bytes)
}

/// The JSON chunk's data and the length of the whole file, which is known to fit.
#[derive(Debug)]
struct Head {
    json: Vec<u8>,
    length: u32,
}

impl Head {
    /// Measures the GLB of `json` and `binary` bytes.
    ///
    /// # Errors
    /// [`Error::Limit`] if its length does not fit 32 bits.
    fn new(mut json: Vec<u8>, binary: usize) -> Result<Self> {
        json.resize(json.len().next_multiple_of(4), b' ');
        let chunk = if binary == 0 { 0 } else { 8 + binary as u64 };
        let length = 20 + json.len() as u64 + chunk;
        let too_large = |_| {
            let why = "the limit is 4 GiB; write .gltf, or use smaller textures or fewer triangles";
            Error::limit(format!("a GLB of {length} bytes"), why)
        };
        Ok(Self { length: u32::try_from(length).map_err(too_large)?, json })
    }
}

/// Characters that must be escaped in a relative URI.
const RESERVED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// Returns the relative URI of a file.
pub(super) fn uri(name: &str) -> String {
    utf8_percent_encode(name, RESERVED).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_into_objects_and_behind_lists() {
        let mut draft = GltfDraft::begun(json!({ "nodes": [{}] }), CodecSet::Portable);
        let mut put = |parent, name| draft.put(parent, name, Json(json!(7)));
        put("/nodes/0", "mesh").unwrap();
        put("/nodes", "-").unwrap();
        put("", "scene").unwrap();
        assert!(put("/nodes", "0").is_err() && put("/skins", "-").is_err() && put("/scene", "a").is_err());
        assert_eq!(draft.json, json!({ "nodes": [{ "mesh": 7 }, 7], "scene": 7 }));
    }

    #[test]
    fn four_gibibytes_are_refused_with_advice() {
        let error = Head::new(vec![b'{', b'}'], u32::MAX as usize - 31).unwrap_err().to_string();
        assert!(error.contains("4294967296 bytes") && error.contains("write .gltf"), "{error}");
        assert_eq!(Head::new(vec![b'{', b'}'], u32::MAX as usize - 35).unwrap().length, u32::MAX - 3);
    }
}
