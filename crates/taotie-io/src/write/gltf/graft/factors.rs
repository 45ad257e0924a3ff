//! A material of a document: baked values replace its own, everything else stays as written.

use super::super::edit::{items, member, remove, short};
use super::super::material::GltfMaterial;
use super::super::material_json::{self, Emission, PBR, STRENGTH};
use serde_json::{Value, json};
use taotie_engine::scene::{AlphaMode, Material};

/// The specular-glossiness extension, which viewers use instead of the core's factors and textures.
pub(super) const GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Returns the number of materials that have that extension.
pub(super) fn count_glossy(document: &Value) -> usize {
    items(document, "materials").iter().filter(|material| extension(material, GLOSSINESS).is_some()).count()
}

/// Returns the core's factors and textures of a material; null if it has none.
pub(super) fn core(json: &Value) -> Value {
    json.get(PBR).cloned().unwrap_or_default()
}

/// Removes the specular-glossiness extension from a material whose core differs from `before`.
pub(super) fn uncover(json: &mut Value, before: &Value) {
    if core(json) != *before {
        drop_extension(json, GLOSSINESS);
    }
}

/// Changes the factors of a material of the document to those of another, where they differ. Layers that differ from
/// those of `said`, the material as read from the document, replace the existing ones, including their textures.
pub(super) fn graft(json: &mut Value, material: &GltfMaterial, said: &Material) {
    let mut pbr = json.get(PBR).cloned().unwrap_or_else(|| json!({}));
    set_color(&mut pbr, material.base_color);
    set_factor(&mut pbr, "metallicFactor", material.metallic);
    set_factor(&mut pbr, "roughnessFactor", material.roughness);
    if pbr != json!({}) {
        *member(json, PBR) = pbr;
    }
    graft_emission(json, material.emissive);
    if alpha(json) != material.alpha {
        ["alphaMode", "alphaCutoff"].into_iter().for_each(|name| remove(json, name));
        material_json::say_alpha(json, material.alpha);
    }
    let known = material_json::factors(said);
    let layers = material.layers.into_iter().flat_map(material_json::factors);
    for (name, layer) in layers.filter(|layer| !known.contains(layer)) {
        *member(member(json, "extensions"), name) = layer;
    }
}

/// Returns the names of a material's extensions.
pub(super) fn extensions(json: &Value) -> Vec<String> {
    let extensions = json.get("extensions").and_then(Value::as_object);
    extensions.into_iter().flat_map(|extensions| extensions.keys().cloned()).collect()
}

fn extension<'a>(json: &'a Value, name: &str) -> Option<&'a Value> {
    json.get("extensions")?.get(name)
}

/// Returns numbers as a reader sees them, with `unsaid` as the default.
fn numbers<const N: usize>(of: &Value, name: &str, unsaid: f32) -> [f32; N] {
    let number = |i: usize| of.get(name)?.get(i)?.as_f64();
    std::array::from_fn(|i| number(i).map_or(unsaid, |v| v as f32))
}

fn set_color(pbr: &mut Value, color: [f32; 4]) {
    if numbers::<4>(pbr, "baseColorFactor", 1.0) != color {
        *member(pbr, "baseColorFactor") = json!(color.map(short));
    }
}

fn set_factor(pbr: &mut Value, name: &str, value: f32) {
    let said = pbr.get(name).and_then(Value::as_f64).map_or(1.0, |v| v as f32);
    if said != value {
        *member(pbr, name) = short(value).into();
    }
}

/// Sets the emitted radiance of a material.
fn graft_emission(json: &mut Value, radiance: [f32; 3]) {
    let strength = extension(json, STRENGTH).and_then(|e| e.get("emissiveStrength")).and_then(Value::as_f64);
    let strength = strength.map_or(1.0, |v| v as f32);
    if numbers::<3>(json, "emissiveFactor", 0.0).map(|v| v * strength) == radiance {
        return;
    }
    let was_dark = numbers::<3>(json, "emissiveFactor", 0.0) == [0.0; 3];
    if was_dark {
        // A texture that was invisible until now would scale the new emission.
        remove(json, "emissiveTexture");
    }
    let emission = Emission::of(radiance);
    *member(json, "emissiveFactor") = json!(emission.color);
    match emission.extension() {
        Some(extension) => *member(member(json, "extensions"), STRENGTH) = extension,
        None => drop_extension(json, STRENGTH),
    }
}

fn drop_extension(json: &mut Value, name: &str) {
    let Some(extensions) = json.get_mut("extensions") else { return };
    remove(extensions, name);
    if *extensions == json!({}) {
        remove(json, "extensions");
    }
}

fn alpha(json: &Value) -> AlphaMode {
    match json.get("alphaMode").and_then(Value::as_str) {
        Some("BLEND") => AlphaMode::Blend,
        Some("MASK") => {
            let cutoff = json.get("alphaCutoff").and_then(Value::as_f64);
            AlphaMode::Mask(cutoff.map_or(0.5, |v| v as f32))
        }
        _ => AlphaMode::Opaque,
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::material::Slot;
    use super::super::super::material_json::put_texture;
    use super::*;
    use taotie_engine::scene::Clearcoat;

    /// A material as authored in a modelling program, and the same as read.
    fn brass() -> (Value, GltfMaterial<'static>) {
        let json = json!({
            "name": "brass", "extras": { "id": 7 }, "alphaMode": "MASK", "emissiveFactor": [0.5, 0.25, 0.0],
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.8, 0.6, 0.2, 1.0], "roughnessFactor": 0.3,
                "baseColorTexture": { "index": 1, "texCoord": 1 },
            },
            "extensions": { STRENGTH: { "emissiveStrength": 4.0 } },
        });
        let material = GltfMaterial {
            base_color: [0.8, 0.6, 0.2, 1.0],
            metallic: 1.0,
            roughness: 0.3,
            emissive: [2.0, 1.0, 0.0],
            alpha: AlphaMode::Mask(0.5),
            ..GltfMaterial::default()
        };
        (json, material)
    }

    #[test]
    fn what_is_the_same_is_not_touched() {
        let (mut json, material) = brass();
        let before = json.clone();
        graft(&mut json, &material, &Material::default());
        assert_eq!(json, before);
    }

    #[test]
    fn layers_stand_in_place_of_those_that_are_switched_off() {
        let coated = |factor: f32| {
            let coat = Clearcoat {
                factor,
                factor_texture: None,
                roughness: 0.25,
                roughness_texture: None,
                normal: None,
            };
            Material { clearcoat: Some(coat), ior: 1.25, ..Material::default() }
        };
        let off = json!({ "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 0 } }, "KHR_materials_ior": {} });
        let grafted = |said: &Material, own: &Material| {
            let mut json = json!({ "extensions": off });
            graft(
                &mut json,
                &GltfMaterial { metallic: 1.0, layers: Some(own), ..GltfMaterial::default() },
                said,
            );
            json["extensions"].clone()
        };
        let coat = json!({ "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25 });
        let on = json!({ "KHR_materials_clearcoat": coat, "KHR_materials_ior": { "ior": 1.25 } });
        assert_eq!(grafted(&Material::default(), &coated(0.5)), on);
        assert_eq!(grafted(&coated(0.5), &coated(0.5)), off, "its own are unchanged");
    }

    #[test]
    fn what_would_hide_the_core_goes_where_that_is_new() {
        let glossy = json!({ "extensions": { GLOSSINESS: {} } });
        let left = |slot: Slot| {
            let mut json = glossy.clone();
            let (core, material) = (core(&json), GltfMaterial::default());
            put_texture(&mut json, slot, 0, &material);
            uncover(&mut json, &core);
            count_glossy(&json!({ "materials": [json] }))
        };
        assert_eq!(
            [Slot::BaseColor, Slot::MetallicRoughness, Slot::Normal, Slot::Occlusion].map(left),
            [0, 0, 1, 1]
        );
    }

    #[test]
    fn what_nothing_says_is_not_made() {
        let mut json = json!({});
        let unsaid = GltfMaterial { metallic: 1.0, ..GltfMaterial::default() };
        graft(&mut json, &unsaid, &Material::default());
        assert_eq!(json, json!({}));
    }

    #[test]
    fn what_was_baked_replaces_what_it_said() {
        let (mut json, material) = brass();
        let baked = GltfMaterial {
            base_color: [1.0; 4],
            emissive: [1.0; 3],
            alpha: AlphaMode::Opaque,
            normal_scale: 1.0,
            ..material
        };
        graft(&mut json, &baked, &Material::default());
        put_texture(&mut json, Slot::BaseColor, 5, &baked);
        put_texture(&mut json, Slot::Normal, 6, &baked);
        let expected = json!({
            "name": "brass", "extras": { "id": 7 }, "emissiveFactor": [1.0, 1.0, 1.0],
            "pbrMetallicRoughness": {
                "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "roughnessFactor": 0.3,
                "baseColorTexture": { "index": 5 },
            },
            "normalTexture": { "index": 6, "scale": 1.0 },
        });
        assert_eq!(json, expected);
    }
}
