//! Models built by code: OBJ with its MTL, PLY and STL, each as text and in binary, and glTF with every feature that
//! the reader supports; and packed files from the library's tests.

use super::pictures::WAVES;
use super::seed::{File, Seed};
use base64::Engine;
use serde_json::{Value, json};
use std::fmt::Write;
use taotie_engine::math::Vec2;
use taotie_engine::mesh::Mesh;

/// Every MTL statement that the reader supports.
const MTL: &str = "newmtl m\nKa .1 .1 .1\nKd .5 .5 .5\nKs 1\nNs 20\nKe 0 0 0\nd .9\nTr .1\nPr .3\nPm .4\n\
    map_Kd -s 1 2 3 -o .1 -mm 0 1 a.png\nmap_Bump -bm 2 -imfchan g a.png\nnorm a.png\nmap_Pr a.png\n\
    map_Pm -clamp on a.png\nmap_d a.png\nmap_Ke a.png\nnewmtl n\nKd 1 0 0\n";

/// An OBJ with every feature of the format in addition to triangles.
const MIXED: &str = "mtllib a.mtl\no x\nv 0 0 0 .1 .2 .3\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nv .5 .5 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf -5//1 -4//-1 -3//1 -2//1\nf 1 2 3 \\\n 4 5\ns 1\np 1\nl 1 2\n\
    g y\nusemtl n\nf 5/1/1 4/2/1 3/3/1\n";

/// The facets of a text STL.
const FACETS: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
    endfacet\nfacet normal 0 1 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 1 0 0\nendloop\nendfacet\nendsolid a\n";

/// A PLY with colours, UVs at corners, textures of faces, polygons and strips.
const PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
    property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\nelement tristrips 1\n\
    property list int int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n\
    4 0 1 2 3 8 0 0 1 0 1 1 0 1 1\n3 0 1 2 6 0 0 1 0 1 1 0\n5 0 1 2 -1 3\n";

/// Returns all scans.
pub fn scans() -> Vec<Seed> {
    let ball = Mesh::sphere(1.0, 10, 6);
    let utf16: Vec<u8> = MIXED.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let picture = File { name: "a.png".into(), bytes: WAVES.to_vec() };
    let materials = File { name: "a.mtl".into(), bytes: MTL.into() };
    vec![
        Seed { companions: vec![materials, picture.clone()], ..Seed::single("mixed.obj", MIXED) },
        Seed::single("ball.obj", obj(&ball)),
        Seed::single("utf16.obj", utf16),
        Seed { companions: vec![picture.clone()], ..Seed::single("all.mtl", MTL) },
        Seed { companions: vec![picture], ..Seed::single("text.ply", PLY) },
        Seed::single("little.ply", ply(&ball, false)),
        Seed::single("big.ply", ply(&ball, true)),
        Seed::single("text.stl", FACETS),
        Seed::single("binary.stl", stl(&ball)),
        Seed::single("text.fbx", &include_bytes!("../../../../tests/data/meshes/panel.fbx")[..]),
        Seed::single("binary.fbx", &include_bytes!("../../../../tests/data/meshes/blender.fbx")[..]),
    ]
}

/// Writes a mesh with its UVs and normals as OBJ.
fn obj(mesh: &Mesh) -> String {
    let mut text = String::from("mtllib none.mtl\n");
    for p in mesh.positions() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for uv in &mesh.uvs()[0] {
        let _ = writeln!(text, "vt {} {}", uv.x, uv.y);
    }
    for n in mesh.normals() {
        let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
    }
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| corner + 1);
        let _ = writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}");
    }
    text
}

/// Writes a mesh with colours as binary PLY.
fn ply(mesh: &Mesh, big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let (vertices, faces) = (mesh.positions().len(), mesh.triangles().len());
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face {faces}\n\
         property list uchar uint vertex_indices\nend_header\n"
    )
    .into_bytes();
    let ordered = |mut digits: [u8; 4]| {
        if big {
            digits.reverse();
        }
        digits
    };
    for p in mesh.positions() {
        bytes.extend(p.to_array().iter().flat_map(|v| ordered(v.to_le_bytes())));
        bytes.extend([200, 100, 50]);
    }
    for triangle in mesh.triangles() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| ordered(v.to_le_bytes())));
    }
    bytes
}

/// Writes a mesh as binary STL.
fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for triangle in 0..mesh.triangles().len() {
        bytes.extend([0; 12]);
        bytes.extend(mesh.corners(triangle).iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Returns all glTF files.
pub fn gltf() -> Vec<Seed> {
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
        let picture = self.view(WAVES);
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
