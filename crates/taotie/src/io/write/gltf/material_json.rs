//! The JSON of a material with encoded images.

use super::edit::member;
use super::images::Encoded;
use super::layers::{self, Emission};
use super::material::GltfMaterial;
use super::number::short;
use super::slots::Slot;
use serde_json::{Value, json};

/// The member with the core's factors.
pub(super) const PBR: &str = "pbrMetallicRoughness";

/// Returns the JSON of the material; texture `i` uses image `i`.
pub(super) fn json(material: &GltfMaterial, images: &[Encoded]) -> Value {
    let mut json = json!({
        "doubleSided": material.double_sided,
        PBR: {
            "baseColorFactor": material.base_color.map(short),
            "metallicFactor": short(material.metallic),
            "roughnessFactor": short(material.roughness),
        },
    });
    if !material.name.is_empty() {
        json["name"] = material.name.into();
    }
    for (texture, image) in images.iter().enumerate() {
        image.slots().iter().for_each(|slot| put_texture(&mut json, *slot, texture, material));
    }
    if material.emissive != [0.0; 3] {
        json["emissiveFactor"] = json!(Emission::of(material.emissive).color);
    }
    layers::say_alpha(&mut json, material.alpha);
    for (name, extension) in extensions(material) {
        json["extensions"][name] = extension;
    }
    json
}

/// Puts a texture, given by index, into a slot of a material. It uses uv set 0, untransformed.
pub(super) fn put_texture(json: &mut Value, slot: Slot, texture: usize, material: &GltfMaterial) {
    let info = json!({ "index": texture });
    match slot {
        Slot::BaseColor => *member(member(json, PBR), "baseColorTexture") = info,
        Slot::MetallicRoughness => {
            *member(member(json, PBR), "metallicRoughnessTexture") = info;
        }
        Slot::Occlusion => {
            let strength = short(material.occlusion_strength);
            *member(json, "occlusionTexture") = json!({ "index": texture, "strength": strength });
        }
        Slot::Normal => {
            let scale = short(material.normal_scale);
            *member(json, "normalTexture") = json!({ "index": texture, "scale": scale });
        }
        Slot::Emissive => *member(json, "emissiveTexture") = info,
    }
}

/// Returns the material's extensions: emission beyond 1, and layers.
pub(super) fn extensions(material: &GltfMaterial) -> Vec<(&'static str, Value)> {
    let strength = Emission::of(material.emissive).extension().map(|json| (layers::STRENGTH, json));
    strength.into_iter().chain(material.layers.into_iter().flat_map(layers::factors)).collect()
}
