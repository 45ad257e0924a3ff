//! The vessel as GLB files, their textures beside them as [`super::export`] writes them.

mod high;
mod pouring;

pub use high::write as write_high;
pub use pouring::write as write_pouring;

use anyhow::Result;
use serde_json::{Value, json};
use std::path::Path;
use taotie::io;
use taotie::mesh::Mesh;

/// glTF's numbers for component types, wrapping and what views hold.
const U8: u32 = 5121;
const U32: u32 = 5125;
const F32: u32 = 5126;
const CLAMP: u32 = 33071;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Writes a document and its binary chunk: header, JSON and data. Source: glTF 2.0, 4.4.
///
/// # Errors
/// Those of writing.
fn write(path: &Path, json: &Value, buffer: &Buffer) -> Result<()> {
    let mut text = serde_json::to_vec(json)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat();
    let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &buffer.bytes)].concat();
    let length = 12 + chunks.len() as u32;
    Ok(io::write_bytes(path, &[&b"glTF\x02\0\0\0"[..], &length.to_le_bytes(), &chunks].concat())?)
}

/// The binary chunk in the making, each accessor with a view of its own.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds elements of so many components and gives the accessor's number.
    fn add(&mut self, bytes: &[u8], component: u32, kind: &str) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let size = if component == U8 { 1 } else { 4 };
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component,
            "count": bytes.len() / (width * size), "type": kind,
        }));
        self.accessors.len() - 1
    }

    /// Positions, normals and uvs.
    fn vertices(&mut self, mesh: &Mesh) -> Value {
        let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
        json!({
            "POSITION": self.bounded(&positions, "VEC3"),
            "NORMAL": self.floats(mesh.normals().iter().flat_map(|n| n.to_array()), "VEC3"),
            "TEXCOORD_0": self.floats(mesh.uvs()[0].iter().flat_map(|uv| [uv.x, uv.y]), "VEC2"),
        })
    }

    /// Triangles, after all vertex attributes; marks what the views are for.
    fn triangles(&mut self, mesh: &Mesh) -> usize {
        self.views.iter_mut().for_each(|view| view["target"] = VERTICES.into());
        let indices: Vec<u8> =
            mesh.triangles().iter().flatten().flat_map(|index| index.to_le_bytes()).collect();
        let index = self.add(&indices, U32, "SCALAR");
        if let Some(view) = self.views.last_mut() {
            view["target"] = INDICES.into();
        }
        index
    }

    fn floats(&mut self, values: impl IntoIterator<Item = f32>, kind: &str) -> usize {
        let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
        self.add(&bytes, F32, kind)
    }

    /// As [`Buffer::floats`], with the least and greatest value of each component, which glTF wants of positions and
    /// times.
    fn bounded<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let index = self.floats(values.as_flattened().iter().copied(), kind);
        let extreme = |of: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
            (0..N).map(|i| values.iter().map(|v| v[i]).fold(start, of)).collect()
        };
        self.accessors[index]["min"] = json!(extreme(f32::min, f32::INFINITY));
        self.accessors[index]["max"] = json!(extreme(f32::max, f32::NEG_INFINITY));
        index
    }
}

/// The parts of a document that all vessels share; textures are colour and occlusion with roughness and metallic, then
/// those named.
fn document(buffer: &Buffer, more_textures: &[&str], material: &Value) -> Value {
    let images: Vec<Value> = ["jue_color.png", "jue_orm.png"]
        .iter()
        .chain(more_textures)
        .map(|uri| json!({ "uri": uri }))
        .collect();
    let textures: Vec<Value> =
        (0..images.len()).map(|source| json!({ "sampler": 0, "source": source })).collect();
    json!({
        "asset": { "version": "2.0", "generator": "taotie" },
        "scene": 0,
        "materials": [material],
        "samplers": [{ "wrapS": CLAMP, "wrapT": CLAMP }],
        "textures": textures,
        "images": images,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    })
}

/// As the scene of the vessel has it, without relief.
fn material() -> Value {
    json!({
        "name": "excavated bronze",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "occlusionTexture": { "index": 1, "strength": 0.7 },
    })
}
