//! A glTF document in the making: its JSON, and the numbers that its accessors name.

use super::container::{self, Head};
use super::images::{self, Encoded};
use crate::error::{Error, Result};
use crate::io::write::{write_bytes, write_with};
use serde_json::{Value, json};
use std::path::Path;

/// glTF's numbers for what a view is for.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The type of an accessor's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Component {
    U8,
    U16,
    U32,
    F32,
}

impl Component {
    /// Its number in glTF.
    fn code(self) -> u32 {
        match self {
            Self::U8 => 5121,
            Self::U16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// A glTF document in the making: JSON, to which anything may be added, and the numbers that it names by accessors.
///
/// Buffers, buffer views and accessors are added to the JSON at the end.
#[derive(Debug, Clone, Default)]
pub struct GltfDraft {
    /// The document without buffers, buffer views and accessors.
    pub json: Value,
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl GltfDraft {
    /// Adds elements of `N` floats, 1 to 4, or 16 for matrices; gives the accessor's number.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().copied().flat_map(f32::to_le_bytes).collect();
        self.elements(&bytes, Component::F32, N)
    }

    /// As [`Self::floats`], with the least and greatest value of each component, which glTF wants of positions and
    /// times.
    pub fn bounded_floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let index = self.floats(values);
        let extreme = |of: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
            (0..N).map(|i| values.iter().map(|v| v[i]).fold(start, of)).collect()
        };
        self.accessors[index]["min"] = json!(extreme(f32::min, f32::INFINITY));
        self.accessors[index]["max"] = json!(extreme(f32::max, f32::NEG_INFINITY));
        index
    }

    /// Adds elements of four bytes, such as joints; gives the accessor's number.
    pub fn bytes(&mut self, values: &[[u8; 4]]) -> usize {
        self.elements(values.as_flattened(), Component::U8, 4)
    }

    /// Adds elements of `width` numbers as they lie in memory; gives the accessor's number.
    pub(super) fn elements(&mut self, bytes: &[u8], component: Component, width: usize) -> usize {
        let kind = match width {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        let view = self.view(bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": component.code(),
            "count": bytes.len() / (width * component.size()), "type": kind,
        }));
        self.accessors.len() - 1
    }

    /// Adds bytes and gives the number of their view. Each begins at a multiple of four.
    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// Says that an accessor holds a vertex attribute.
    pub fn mark_vertices(&mut self, accessor: usize) {
        self.mark(accessor, VERTICES);
    }

    /// Says that an accessor holds indices of vertices.
    pub(super) fn mark_indices(&mut self, accessor: usize) {
        self.mark(accessor, INDICES);
    }

    fn mark(&mut self, accessor: usize, target: u32) {
        let view = self.accessors.get(accessor).and_then(|a| a["bufferView"].as_u64());
        if let Some(view) = view.and_then(|view| self.views.get_mut(view as usize)) {
            view["target"] = target.into();
        }
    }

    /// The whole document's text; its buffer is the file `uri`, or the container's.
    fn text(&self, uri: Option<String>) -> Result<Vec<u8>> {
        let mut json = self.json.clone();
        let mut buffer = json!({ "byteLength": self.bytes.len() });
        if let Some(uri) = uri {
            buffer["uri"] = uri.into();
        }
        json["buffers"] = json!([buffer]);
        json["bufferViews"] = json!(self.views);
        json["accessors"] = json!(self.accessors);
        serde_json::to_vec(&json).map_err(|e| Error::invalid("glTF document", e.to_string()))
    }

    /// Writes the document as GLB, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Limit`] where it would have 4 GiB or more, [`Error::Io`] where the file cannot be written.
    pub fn write_glb(&self, path: &Path) -> Result<()> {
        let head = Head::new(self.text(None)?, self.bytes.len())?;
        write_with(path, |mut out| {
            container::write(&mut out, &head, &self.bytes).map_err(|e| Error::io(path, e))
        })
    }

    /// The document as GLB.
    ///
    /// # Errors
    /// [`Error::Limit`] where it would have 4 GiB or more.
    pub fn encode_glb(&self) -> Result<Vec<u8>> {
        let head = Head::new(self.text(None)?, self.bytes.len())?;
        let mut bytes = Vec::new();
        container::write(&mut bytes, &head, &self.bytes)
            .map_err(|e| Error::invalid("glTF document", e.to_string()))?;
        Ok(bytes)
    }

    /// Writes the document as JSON, with its numbers and images in files beside it.
    pub(super) fn write_gltf(&self, path: &Path, images: &[Encoded]) -> Result<()> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        for image in images {
            if let Some(bytes) = image.bytes() {
                write_bytes(&path.with_file_name(image.file_name(&stem)), bytes)?;
            }
        }
        let binary = format!("{stem}.bin");
        write_bytes(&path.with_file_name(&binary), &self.bytes)?;
        write_bytes(path, &self.text(Some(images::uri(&binary)))?)
    }
}
