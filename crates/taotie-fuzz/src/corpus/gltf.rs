//! glTF built by code, with every feature that the reader supports, and packed files from the library's tests.

use super::seed::Seed;
use base64::Engine;
use serde_json::{Value, json};
use taotie_engine::math::Vec2;
use taotie_engine::mesh::Mesh;

/// Returns all models.
pub fn seeds() -> Vec<Seed> {
    let (document, bytes) = Maker::default().whole();
    vec![
        Seed::single("whole.glb", glb(&document, &bytes)),
        Seed::single("whole.gltf", text(document, &bytes)),
        Seed::single("plain.glb", &include_bytes!("../../../../tests/data/meshes/patch.glb")[..]),
        Seed::single(
            "draco.glb",
            &include_bytes!("../../../../tests/data/meshes/hill-draco-valence.glb")[..],
        ),
        Seed::single(
            "draco-edgebreaker.glb",
            &include_bytes!("../../../../tests/data/meshes/patch-draco-edgebreaker.glb")[..],
        ),
        Seed::single(
            "draco-sequential.glb",
            &include_bytes!("../../../../tests/data/meshes/patch-draco-sequential.glb")[..],
        ),
        Seed::single(
            "meshopt-ext.glb",
            &include_bytes!("../../../../tests/data/meshes/patch-meshopt-ext.glb")[..],
        ),
        Seed::single(
            "meshopt-khr.glb",
            &include_bytes!("../../../../tests/data/meshes/patch-meshopt-khr.glb")[..],
        ),
    ]
}

/// A buffer that is filled view by view, with its accessors.
#[derive(Default)]
struct Maker {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Maker {
    /// Adds a view and returns its number.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    /// Adds an accessor of floats and returns its number.
    fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let count = values.len() / width;
        self.accessors
            .push(json!({ "bufferView": view, "count": count, "componentType": 5126, "type": kind }));
        self.accessors.len() - 1
    }

    /// Adds an accessor of integers of one or two bytes and returns its number.
    fn integers(&mut self, kind: &str, component: u32, bytes: &[u8]) -> usize {
        let width = if component == 5123 { 2 } else { 1 } * if kind == "VEC4" { 4 } else { 1 };
        let (view, count) = (self.view(bytes), bytes.len() / width);
        self.accessors
            .push(json!({ "bufferView": view, "count": count, "componentType": component, "type": kind }));
        self.accessors.len() - 1
    }

    /// Adds a sparse accessor that moves vertex 1, without a buffer view for itself, and returns its number.
    fn sparse(&mut self, count: usize) -> usize {
        let indices = self.view(&[1, 0]);
        let values: Vec<u8> = [0.0f32, 0.25, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        let values = self.view(&values);
        self.accessors.push(json!({ "count": count, "componentType": 5126, "type": "VEC3", "sparse": { "count": 1,
            "indices": { "bufferView": indices, "componentType": 5123 }, "values": { "bufferView": values } } }));
        self.accessors.len() - 1
    }

    /// Returns the primitive of a ball with every attribute, a morph target, and a skin of two joints.
    fn primitive(&mut self, ball: &Mesh) -> Value {
        let count = ball.positions().len();
        let vectors = |values: &[taotie_engine::math::Vec3]| {
            values.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>()
        };
        let uvs: Vec<f32> = ball.uvs()[0].iter().flat_map(|Vec2 { x, y }| [*x, *y]).collect();
        let indices: Vec<u8> =
            ball.triangles().as_flattened().iter().flat_map(|i| (*i as u16).to_le_bytes()).collect();
        let positions = self.floats("VEC3", 3, &vectors(ball.positions()));
        let normals = self.floats("VEC3", 3, &vectors(ball.normals()));
        let uvs = self.floats("VEC2", 2, &uvs);
        let tangents = self.floats("VEC4", 4, &[1.0, 0.0, 0.0, 1.0].repeat(count));
        let colors = self.integers("VEC4", 5121, &[200, 100, 50, 255].repeat(count));
        self.accessors[colors]["normalized"] = json!(true);
        let joints = self.integers("VEC4", 5121, &[0, 1, 0, 0].repeat(count));
        let weights = self.floats("VEC4", 4, &[0.75, 0.25, 0.0, 0.0].repeat(count));
        let indices = self.integers("SCALAR", 5123, &indices);
        let moved = self.sparse(count);
        json!({ "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs, "TANGENT": tangents,
            "COLOR_0": colors, "JOINTS_0": joints, "WEIGHTS_0": weights }, "indices": indices, "material": 0, "mode": 4,
            "targets": [{ "POSITION": moved }], "extensions": { "KHR_materials_variants": {
            "mappings": [{ "material": 1, "variants": [0] }] } } })
    }

    /// Returns animations of a node and of weights, and the skin's matrices.
    fn motion(&mut self) -> [Value; 2] {
        let identity: Vec<f32> = (0..16).map(|i| if i % 5 == 0 { 1.0 } else { 0.0 }).collect();
        let matrices = self.floats("MAT4", 16, &identity.repeat(2));
        let times = self.floats("SCALAR", 1, &[0.0, 1.0]);
        let places = self.floats("VEC3", 3, &[0.0, 0.0, 0.0, 4.0, 2.0, 0.0]);
        let turns = self.floats("VEC4", 4, &[0.0, 0.0, 0.0, 1.0].repeat(6));
        let weights = self.floats("SCALAR", 1, &[0.0, 1.0]);
        let channel = |sampler: usize, node: usize, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
        let animations = json!([{ "name": "move",
            "channels": [channel(0, 1, "translation"), channel(1, 1, "rotation"), channel(2, 0, "weights")],
            "samplers": [{ "input": times, "output": places },
                { "input": times, "output": turns, "interpolation": "CUBICSPLINE" },
                { "input": times, "output": weights, "interpolation": "STEP" }] }]);
        [animations, json!([{ "joints": [1, 2], "inverseBindMatrices": matrices }])]
    }

    /// Returns the document and its buffer.
    fn whole(mut self) -> (Value, Vec<u8>) {
        let primitive = self.primitive(&Mesh::sphere(1.0, 8, 5));
        let [animations, skins] = self.motion();
        let picture = self.view(super::pictures::WAVES);
        let document = json!({
            "asset": { "version": "2.0", "generator": "taotie-fuzz", "copyright": "CC0" },
            "scene": 0, "scenes": [{ "nodes": [0, 1, 4] }],
            "nodes": [{ "mesh": 0, "skin": 0, "weights": [0.5] }, { "children": [2], "scale": [1, 2, 1] },
                { "mesh": 0, "rotation": [0, 0, 0, 1], "translation": [3, 0, 0],
                    "extensions": { "MSFT_lod": { "ids": [3] } }, "extras": { "MSFT_screencoverage": [0.5, 0.1] } },
                { "camera": 0, "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1] },
                { "camera": 1, "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
            "meshes": [{ "name": "ball", "weights": [0.25], "primitives": [primitive] }],
            "skins": skins, "animations": animations, "materials": materials(),
            "images": [{ "bufferView": picture, "mimeType": "image/png" }],
            "samplers": [{ "magFilter": 9728, "minFilter": 9987, "wrapS": 33071, "wrapT": 33648 }],
            "textures": [{ "source": 0, "sampler": 0 }],
            "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1, "zfar": 50 } },
                { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 2, "znear": 0.1, "zfar": 9 } }],
            "extensions": { "KHR_lights_punctual": { "lights": [
                { "type": "spot", "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 }, "intensity": 30, "range": 9 }] },
                "KHR_materials_variants": { "variants": [{ "name": "red" }] },
                "KHR_xmp_json_ld": { "packets": [{ "dc:title": "ball", "@context": {} }] } },
            "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_variants", "KHR_texture_transform", "MSFT_lod"],
            "buffers": [{ "byteLength": self.bytes.len() }], "bufferViews": self.views, "accessors": self.accessors,
        });
        (document, self.bytes)
    }
}

/// Returns two materials: one with every map and layer, and one that is translucent.
fn materials() -> Value {
    let map = json!({ "index": 0, "texCoord": 0, "extensions": { "KHR_texture_transform": {
        "offset": [0.25, 0.5], "rotation": 0.5, "scale": [2, 3] } } });
    let normal = json!({ "index": 0, "scale": 0.75 });
    json!([{ "name": "full", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
        "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": map, "metallicFactor": 0.5,
            "roughnessFactor": 0.5, "metallicRoughnessTexture": map },
        "normalTexture": normal, "occlusionTexture": { "index": 0, "strength": 0.5 }, "emissiveTexture": map,
        "emissiveFactor": [0.25, 0.5, 1],
        "extensions": { "KHR_materials_ior": { "ior": 1.33 }, "KHR_materials_emissive_strength": { "emissiveStrength": 5 },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1, 0.5, 1], "specularTexture": map },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25,
                "clearcoatNormalTexture": normal },
            "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.5 },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 1, "anisotropyTexture": map } } },
        { "name": "glass", "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.5] },
            "extensions": { "KHR_materials_unlit": {} } }])
}

/// Returns the document with its buffer embedded as text.
fn text(mut document: Value, bytes: &[u8]) -> Vec<u8> {
    let data = base64::engine::general_purpose::STANDARD.encode(bytes);
    document["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{data}"));
    document.to_string().into_bytes()
}

/// Returns the document and its buffer as a GLB.
fn glb(document: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = bytes.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = |length: usize| (length as u32).to_le_bytes();
    let all = length(28 + json.len() + binary.len());
    [
        b"glTF\x02\0\0\0",
        &all[..],
        &length(json.len()),
        b"JSON",
        &json,
        &length(binary.len()),
        b"BIN\0",
        &binary,
    ]
    .concat()
}
