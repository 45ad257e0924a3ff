//! The JSON of a material whose images are encoded.

use super::images::Encoded;
use super::layers::{self, Emission};
use super::material::GltfMaterial;
use super::number::short;
use super::slots::Slot;
use serde_json::{Value, json};

/// Returns the JSON of the material; texture `i` shows image `i`.
pub(super) fn json(material: &GltfMaterial, images: &[Encoded]) -> Value {
    let texture = |slot: Slot| images.iter().position(|image| image.serves(slot));
    let mut pbr = json!({
        "baseColorFactor": material.base_color.map(short),
        "metallicFactor": short(material.metallic),
        "roughnessFactor": short(material.roughness),
    });
    let mut json = json!({ "doubleSided": material.double_sided });
    if !material.name.is_empty() {
        json["name"] = material.name.into();
    }
    if let Some(index) = texture(Slot::BaseColor) {
        pbr["baseColorTexture"] = json!({ "index": index });
    }
    if let Some(index) = texture(Slot::MetallicRoughness) {
        pbr["metallicRoughnessTexture"] = json!({ "index": index });
    }
    if let Some(index) = texture(Slot::Occlusion) {
        json["occlusionTexture"] = json!({ "index": index, "strength": short(material.occlusion_strength) });
    }
    if let Some(index) = texture(Slot::Normal) {
        json["normalTexture"] = json!({ "index": index, "scale": short(material.normal_scale) });
    }
    if let Some(index) = texture(Slot::Emissive) {
        json["emissiveTexture"] = json!({ "index": index });
    }
    if material.emissive != [0.0; 3] {
        json["emissiveFactor"] = json!(Emission::of(material.emissive).color);
    }
    layers::say_alpha(&mut json, material.alpha);
    for (name, extension) in extensions(material) {
        json["extensions"][name] = extension;
    }
    json["pbrMetallicRoughness"] = pbr;
    json
}

/// Returns the material's extensions: emission beyond 1, and layers.
pub(super) fn extensions(material: &GltfMaterial) -> Vec<(&'static str, Value)> {
    let strength = Emission::of(material.emissive).extension().map(|json| (layers::STRENGTH, json));
    strength.into_iter().chain(material.layers.into_iter().flat_map(layers::factors)).collect()
}
