//! Small models and textures for the tests.

use super::pictures::write_square;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::path::Path;
use taotie_engine::image::Encoding;
use taotie_engine::math::{Vec3, scalar};
use taotie_io::PngSamples;

/// One triangle.
pub const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Returns a glTF file of one triangle mesh with these positions and indices.
pub fn gltf(positions: &[[f32; 3]], indices: &[u16]) -> String {
    let position_bytes: Vec<u8> = positions.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let index_bytes: Vec<u8> = indices.iter().flat_map(|v| v.to_le_bytes()).collect();
    let buffer = |bytes: &[u8]| {
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes));
        json!({ "byteLength": bytes.len(), "uri": uri })
    };
    json!({
        "asset": { "version": "2.0" },
        "buffers": [buffer(&position_bytes), buffer(&index_bytes)],
        "bufferViews": [
            { "buffer": 0, "byteLength": position_bytes.len() },
            { "buffer": 1, "byteLength": index_bytes.len() },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": positions.len(), "type": "VEC3",
              "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": indices.len(), "type": "SCALAR" },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "scene": 0,
    })
    .to_string()
}

/// Returns a unit square with everything that a vertex can have, a normal map `normals.png`, a missing texture, a
/// light, two cameras and an unknown extension.
pub fn square() -> String {
    let floats: [f32; 48] = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, // normals
        1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, // tangents
        0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, // uvs
    ];
    let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
    let bytes: Vec<u8> = floats
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .chain(indices.iter().flat_map(|v| v.to_le_bytes()))
        .collect();
    let accessor = |view: usize, kind: &str, count: usize, component: u32| json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
    let view =
        |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    json!({
        "asset": { "version": "2.0", "generator": "by hand", "copyright": "nobody" },
        "extensionsUsed": ["KHR_lights_punctual", "EXT_nobody_knows"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "name": "lamp" }] } },
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&bytes)),
        }],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 64), view(160, 32), view(192, 12)],
        "accessors": [
            accessor(0, "VEC3", 4, 5126), accessor(1, "VEC3", 4, 5126), accessor(2, "VEC4", 4, 5126),
            accessor(3, "VEC2", 4, 5126), accessor(4, "SCALAR", 6, 5123),
        ],
        "images": [{ "uri": "normals.png" }, { "uri": "missing.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }],
        "materials": [{
            "name": "stone",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 0.125, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.75,
                "baseColorTexture": { "index": 1 },
            },
            "normalTexture": { "index": 0, "scale": 0.5 },
            "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        }],
        "cameras": [
            { "type": "perspective", "name": "front", "perspective": { "yfov": 0.7, "znear": 0.1 } },
            { "type": "orthographic", "orthographic": { "xmag": 1.0, "ymag": 1.0, "znear": 0.1, "zfar": 9.0 } },
        ],
        "meshes": [{
            "name": "square",
            "primitives": [{
                "attributes": { "POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3 },
                "indices": 4, "material": 0,
            }],
        }],
        "nodes": [
            { "mesh": 0 },
            { "camera": 0, "name": "front", "translation": [0.5, 0.5, 3.0] },
            { "camera": 1, "translation": [0.5, 0.5, 3.0] },
            { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [0.0, 2.0, 2.0] },
        ],
        "scenes": [{ "nodes": [0, 1, 2, 3] }],
        "scene": 0,
    })
    .to_string()
}

/// Returns the JSON of [`square`], to be modified.
pub fn square_json() -> Value {
    serde_json::from_str(&square()).expect("it is JSON")
}

/// Returns [`square`] with every layer that a material can have.
pub fn coated_square() -> String {
    let mut json = square_json();
    json["materials"][0]["extensions"] = json!({
        "KHR_materials_ior": { "ior": 1.25 },
        "KHR_materials_specular": {
            "specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 2.0], "specularColorTexture": { "index": 0 },
        },
        "KHR_materials_clearcoat": {
            "clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.125,
            "clearcoatNormalTexture": { "index": 0, "scale": 0.25 },
        },
        "KHR_materials_anisotropy": {
            "anisotropyStrength": 0.5, "anisotropyRotation": std::f64::consts::FRAC_PI_2,
        },
        "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.25, 0.0], "sheenRoughnessFactor": 0.5 },
        "KHR_materials_transmission": { "transmissionFactor": 0.5, "transmissionTexture": { "index": 0 } },
        "KHR_materials_volume": {
            "thicknessFactor": 2.0, "attenuationDistance": 4.0, "attenuationColor": [0.5, 1.0, 0.25],
        },
        "KHR_materials_iridescence": { "iridescenceFactor": 0.75, "iridescenceIor": 1.5 },
        "KHR_materials_dispersion": { "dispersion": 1.25 },
    });
    json.to_string()
}

/// Returns [`square`] with two animations of two seconds: in `rise` it moves two units up, in the other, which has no
/// name, it turns by 90° about its lower left corner.
pub fn moving_square() -> String {
    let mut json = square_json();
    let floats: [f32; 16] = [0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.6, 0.8];
    let bytes: Vec<u8> = floats.iter().flat_map(|v| v.to_le_bytes()).collect();
    let push = |list: &mut Value, value: Value| list.as_array_mut().expect("a list").push(value);
    let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&bytes));
    push(&mut json["buffers"], json!({ "byteLength": bytes.len(), "uri": uri }));
    for (offset, length, kind) in [(0, 8, "SCALAR"), (8, 24, "VEC3"), (32, 32, "VEC4")] {
        let view = json["bufferViews"].as_array().expect("a list").len();
        push(&mut json["bufferViews"], json!({ "buffer": 1, "byteOffset": offset, "byteLength": length }));
        push(
            &mut json["accessors"],
            json!({ "bufferView": view, "componentType": 5126, "count": 2, "type": kind }),
        );
    }
    let channels = |path: &str| json!([{ "sampler": 0, "target": { "node": 0, "path": path } }]);
    json["animations"] = json!([
        { "name": "rise", "channels": channels("translation"), "samplers": [{ "input": 5, "output": 6 }] },
        { "channels": channels("rotation"), "samplers": [{ "input": 5, "output": 7 }] },
    ]);
    json.to_string()
}

/// The direction of green in [`write_relief`].
#[derive(Clone, Copy, PartialEq)]
pub enum Green {
    Up,
    Down,
}

/// Writes the tangent-space normal map of round hills.
pub fn write_relief(path: &Path, green: Green) {
    let sign = if green == Green::Up { 1.0 } else { -1.0 };
    write_normals(path, |x, y| {
        let wave = |v: u32| f64::from(v) * std::f64::consts::TAU / 24.0;
        let (p, q) = (
            scalar::cos(wave(x)) * scalar::sin(wave(y)),
            // Rows go down, heights are differentiated upwards.
            -scalar::sin(wave(x)) * scalar::cos(wave(y)),
        );
        Vec3::new(-0.5 * p, -0.5 * q * sign, 1.0)
    });
}

/// Writes an object-space normal map of a ball.
pub fn write_ball(path: &Path) {
    write_normals(path, |x, y| {
        let (longitude, latitude) = (f64::from(x) * 0.0327, f64::from(y) * 0.0163);
        let across = scalar::sin(latitude);
        Vec3::new(across * scalar::cos(longitude), across * scalar::sin(longitude), scalar::cos(latitude))
    });
}

fn write_normals(path: &Path, normal: impl Fn(u32, u32) -> Vec3<f64>) {
    const SIDE: u32 = 192;
    let encode = |v: f64| ((v * 0.5 + 0.5) * 255.0).round() as u8;
    let texels = (0..SIDE * SIDE).flat_map(|i| normal(i % SIDE, i / SIDE).normalize().to_array().map(encode));
    let samples: Vec<u8> = texels.collect();
    write_square(path, PngSamples::U8(&samples), Encoding::Linear);
}
