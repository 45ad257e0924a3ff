//! The pouring vessel as a GLB with skin and animation, its textures beside it.

use crate::jue::pour;
use anyhow::Result;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use taotie::io;
use taotie::math::Mat4;
use taotie::mesh::Mesh;
use taotie::scene::Scene;
use taotie::scene::animation::{Node, RigData, Sampler, Transform};

/// glTF's numbers for component types, wrapping and what views hold.
const U8: u32 = 5121;
const U16: u32 = 5123;
const F32: u32 = 5126;
const CLAMP: u32 = 33071;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Writes `jue-pouring.glb` into `folder`, where the maps of [`super::export`] lie; returns the file.
///
/// # Errors
/// Those of writing.
pub fn write(folder: &Path, scene: &Scene) -> Result<PathBuf> {
    let path = folder.join("jue-pouring.glb");
    io::write_bytes(&path, &container(scene)?)?;
    Ok(path)
}

/// Header, JSON and binary chunk. Source: glTF 2.0, 4.4.
fn container(scene: &Scene) -> Result<Vec<u8>> {
    let mut buffer = Buffer::default();
    let json = document(&mut buffer, &scene.meshes[0]);
    let mut text = serde_json::to_vec(&json)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat();
    let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &buffer.bytes)].concat();
    let length = 12 + chunks.len() as u32;
    Ok([&b"glTF\x02\0\0\0"[..], &length.to_le_bytes(), &chunks].concat())
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
        let size = match component {
            U8 => 1,
            U16 => 2,
            _ => 4,
        };
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component,
            "count": bytes.len() / (width * size), "type": kind,
        }));
        self.accessors.len() - 1
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

fn document(buffer: &mut Buffer, mesh: &Mesh) -> Value {
    let rig = pour::rig(mesh);
    let data = rig.data();
    let attributes = attributes(buffer, mesh, data);
    let indices: Vec<u8> =
        mesh.triangles().iter().flatten().flat_map(|index| (*index as u16).to_le_bytes()).collect();
    let vertices = buffer.views.len();
    let indices = buffer.add(&indices, U16, "SCALAR");
    buffer.views[..vertices].iter_mut().for_each(|view| view["target"] = VERTICES.into());
    buffer.views[vertices]["target"] = INDICES.into();
    let skin = &data.skins[0];
    let binds = skin.inverse_bind_matrices.iter().flat_map(columns);
    let binds = buffer.floats(binds.collect::<Vec<_>>(), "MAT4");
    let animation = animation(buffer, data);
    let textures = [0, 1, 2].map(|source| json!({ "sampler": 0, "source": source }));
    let images = ["jue_color.png", "jue_orm.png", "jue_normal.png"].map(|uri| json!({ "uri": uri }));
    // The joints' nodes come first and the one that shows the mesh last, so that the rig's numbers hold.
    let mut nodes: Vec<Value> = (0..data.nodes.len()).map(|i| node(&data.nodes, i)).collect();
    nodes.push(json!({ "name": "jue", "mesh": 0, "skin": 0 }));
    json!({
        "asset": { "version": "2.0", "generator": "taotie" },
        "scene": 0,
        "scenes": [{ "nodes": [0, nodes.len() - 1] }],
        "nodes": nodes,
        "meshes": [{ "name": "jue", "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] }],
        "skins": [{ "joints": skin.joints, "inverseBindMatrices": binds }],
        "animations": [animation],
        "materials": [material()],
        "samplers": [{ "wrapS": CLAMP, "wrapT": CLAMP }],
        "textures": textures,
        "images": images,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    })
}

fn attributes(buffer: &mut Buffer, mesh: &Mesh, data: &RigData) -> Value {
    let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let mut attributes = json!({
        "POSITION": buffer.bounded(&positions, "VEC3"),
        "NORMAL": buffer.floats(mesh.normals().iter().flat_map(|n| n.to_array()), "VEC3"),
        "TEXCOORD_0": buffer.floats(mesh.uvs()[0].iter().flat_map(|uv| [uv.x, uv.y]), "VEC2"),
    });
    if let Some(binding) = &data.deformed[0].shape.binding {
        // glTF counts joints and weights by fours.
        let fours =
            |i: usize| (0..4).map(move |k| (k < binding.per_vertex).then_some(i * binding.per_vertex + k));
        let places = || (0..positions.len()).flat_map(fours);
        // Joints that a vertex does not follow are joint 0.
        let followed = |at: &usize| binding.weights[*at] > 0.0;
        let joints: Vec<u8> =
            places().map(|at| at.filter(followed).map_or(0, |at| binding.joints[at] as u8)).collect();
        attributes["JOINTS_0"] = buffer.add(&joints, U8, "VEC4").into();
        let weights = places().map(|at| at.map_or(0.0, |at| binding.weights[at]));
        attributes["WEIGHTS_0"] = buffer.floats(weights.collect::<Vec<_>>(), "VEC4").into();
    }
    attributes
}

fn columns(m: &Mat4) -> [f32; 16] {
    std::array::from_fn(|i| m.columns[i / 4][i % 4] as f32)
}

fn node(nodes: &[Node], index: usize) -> Value {
    let children: Vec<usize> = (0..nodes.len()).filter(|i| nodes[*i].parent == Some(index)).collect();
    let mut node = json!({ "name": if index == 0 { "foot" } else { "cup" } });
    if let Transform::Parts { translation, .. } = nodes[index].local {
        node["translation"] = json!(translation.to_array());
    }
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}

fn animation(buffer: &mut Buffer, data: &RigData) -> Value {
    let animation = &data.animations[0];
    let mut sampler = |sampler: &Sampler| {
        let times: Vec<[f32; 1]> = sampler.times().iter().map(|time| [*time]).collect();
        json!({
            "input": buffer.bounded(&times, "SCALAR"),
            "output": buffer.floats(sampler.values().iter().copied(), "VEC4"),
            "interpolation": "CUBICSPLINE",
        })
    };
    let samplers: Vec<Value> = animation.samplers.iter().map(&mut sampler).collect();
    let channels: Vec<Value> = animation
        .channels
        .iter()
        .map(|c| json!({ "sampler": c.sampler, "target": { "node": c.node, "path": "rotation" } }))
        .collect();
    json!({ "name": animation.name, "channels": channels, "samplers": samplers })
}

/// As the scene of the vessel has it.
fn material() -> Value {
    json!({
        "name": "excavated bronze",
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "occlusionTexture": { "index": 1, "strength": 0.7 },
        "normalTexture": { "index": 2 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::export;
    use crate::jue;
    use taotie::scene::Material;

    #[test]
    fn the_file_moves_as_the_vessel_does() {
        let folder = tempfile::tempdir().unwrap();
        let scene = jue::scene(64);
        export::write(folder.path(), &scene).unwrap();
        let mut loaded = io::load_model(&write(folder.path(), &scene).unwrap()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let (read, ours) = (&loaded.scene.materials[0], &scene.materials[0]);
        let look = |m: &Material| (m.base_color, m.metallic, m.roughness, m.occlusion_strength);
        assert_eq!(look(read), look(ours));
        assert_eq!(read.normal, ours.normal);
        let rig = loaded.rig.unwrap();
        assert_eq!((rig.animations()[0].name.as_str(), rig.animations()[0].seconds()), ("pour", 2.0));
        let own = pour::rig(&scene.meshes[0]);
        for seconds in [0.0, 0.3, pour::POURED, 1.7] {
            let mut expected = scene.clone();
            own.pose(&mut expected, 0, seconds).unwrap();
            rig.pose(&mut loaded.scene, 0, seconds).unwrap();
            let positions = loaded.scene.corners().zip(expected.corners());
            let farthest = positions.map(|(p, q)| (p - q).length()).fold(0.0, f64::max);
            assert!(farthest < 1e-6, "{farthest} metres at {seconds} seconds");
        }
    }
}
