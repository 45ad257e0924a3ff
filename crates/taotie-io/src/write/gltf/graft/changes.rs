//! Changes of a document by a bake: the values of a material, of which everything else stays as written; the default
//! material, vertex colours and tangents of primitives; and a root node that scales everything to metres.

use super::super::draft::VERTICES;
use super::super::edit::{self, drop_extension, items, remove, short};
use super::super::material::{GltfMaterial, MaterialParts, PBR, STRENGTH, TextureInfo, layers};
use crate::gltf::{GltfSource, RawGltf, missing_tangents};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use taotie_engine::error::{Result, Warnings};
use taotie_engine::scene::{AlphaMode, Material};

/// The specular-glossiness extension, which viewers use instead of the core's factors and textures.
pub(super) const GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Returns the number of materials that have that extension.
pub(super) fn count_glossy(document: &Value) -> usize {
    items(document, "materials").iter().filter(|material| extension(material, GLOSSINESS).is_some()).count()
}

/// Changes a material of the document to another where they differ, and adds these textures. Layers that differ from
/// those of `said`, the material as read from the document, replace the existing ones, including their textures. The
/// specular-glossiness extension is removed if the core changes.
pub(super) fn graft(json: &mut Value, material: &GltfMaterial, said: &Material, textures: Vec<TextureInfo>) {
    let core = json.get(PBR).cloned().unwrap_or_default();
    let emissive = Some(material.emissive);
    let mut parts = MaterialParts { name: "", double_sided: None, emissive, ..material.parts(textures) };
    parts.base_color.take_if(|color| numbers::<4>(&core, "baseColorFactor", 1.0) == *color);
    parts.metallic.take_if(|factor| number(&core, "metallicFactor", 1.0) == *factor);
    parts.roughness.take_if(|factor| number(&core, "roughnessFactor", 1.0) == *factor);
    parts.emissive.take_if(|radiance| emission(json) == *radiance);
    parts.alpha.take_if(|mode| alpha(json) == *mode);
    let known = layers(said);
    parts.layers.retain(|layer| !known.contains(layer));
    if parts.emissive.is_some() && numbers::<3>(json, "emissiveFactor", 0.0) == [0.0; 3] {
        // A texture that was invisible until now would scale the new emission.
        remove(json, "emissiveTexture");
    }
    parts.put_into(json);
    if json.get(PBR).cloned().unwrap_or_default() != core {
        drop_extension(json, GLOSSINESS);
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

/// Returns a number as a reader sees it, with `unsaid` as the default.
fn number(of: &Value, name: &str, unsaid: f32) -> f32 {
    of.get(name).and_then(Value::as_f64).map_or(unsaid, |v| v as f32)
}

/// Returns the numbers of a list as a reader sees them, with `unsaid` as the default.
fn numbers<const N: usize>(of: &Value, name: &str, unsaid: f32) -> [f32; N] {
    let number = |i: usize| of.get(name)?.get(i)?.as_f64();
    std::array::from_fn(|i| number(i).map_or(unsaid, |v| v as f32))
}

/// Returns the emitted radiance of a material.
fn emission(json: &Value) -> [f32; 3] {
    let strength = extension(json, STRENGTH).map_or(1.0, |of| number(of, "emissiveStrength", 1.0));
    numbers::<3>(json, "emissiveFactor", 0.0).map(|v| v * strength)
}

fn alpha(json: &Value) -> AlphaMode {
    match json.get("alphaMode").and_then(Value::as_str) {
        Some("BLEND") => AlphaMode::Blend,
        Some("MASK") => AlphaMode::Mask(number(json, "alphaCutoff", 0.5)),
        _ => AlphaMode::Opaque,
    }
}

/// Adds glTF's default material to the file if `number` is one past the last, and assigns it to all triangles without
/// a material.
pub(super) fn give_default_material(json: &mut Value, number: usize) {
    let count = edit::items(json, "materials").len();
    if number != count {
        return;
    }
    edit::push(json, "materials", json!({}));
    let primitives = edit::items_mut(json, "meshes").flat_map(|mesh| edit::items_mut(mesh, "primitives"));
    let names_none = |primitive: &&mut Value| {
        edit::number(primitive, "material").is_none_or(|named| named >= count)
            && edit::number(primitive, "mode").is_none_or(|mode| (4..=6).contains(&mode))
    };
    primitives.filter(names_none).for_each(|p| *edit::member(p, "material") = number.into());
}

/// Removes the vertex colours of primitives that use a material.
pub(super) fn drop_colors(json: &mut Value, material: usize) {
    const COLORS: &str = "COLOR_0";
    let primitives = edit::items_mut(json, "meshes").flat_map(|mesh| edit::items_mut(mesh, "primitives"));
    for primitive in primitives.filter(|p| edit::number(p, "material") == Some(material)) {
        let packed = "/extensions/KHR_draco_mesh_compression/attributes";
        for place in ["/attributes", packed] {
            primitive.pointer_mut(place).into_iter().for_each(|attributes| edit::remove(attributes, COLORS));
        }
        edit::items_mut(primitive, "targets").for_each(|target| edit::remove(target, COLORS));
    }
}

/// Adds tangents to the primitives that have none and use one of `materials`, given by index in the file `source`,
/// provided that no vertex has to be split. For other primitives, viewers generate them with MikkTSpace, as here.
///
/// # Errors
/// Those of reading the file.
pub(super) fn give_tangents(raw: &mut RawGltf, source: GltfSource<'_>, materials: &[usize]) -> Result<()> {
    if materials.is_empty() {
        return Ok(());
    }
    for found in missing_tangents(source, raw.reading(), materials)? {
        let bytes = found.tangents.as_flattened().iter().copied().flat_map(f32::to_le_bytes).collect();
        let view = edit::add_view(raw, bytes);
        for view in edit::items_mut(&mut raw.json, "bufferViews").skip(view) {
            *edit::member(view, "target") = VERTICES.into();
        }
        let (float, count) = (5126, found.tangents.len());
        let accessor = json!({ "bufferView": view, "componentType": float, "count": count, "type": "VEC4" });
        let accessor = edit::push(&mut raw.json, "accessors", accessor);
        let attributes = format!("/meshes/{}/primitives/{}/attributes", found.mesh, found.primitive);
        if let Some(attributes) = raw.json.pointer_mut(&attributes) {
            *edit::member(attributes, "TANGENT") = accessor.into();
        }
    }
    Ok(())
}

/// Puts a scaling node above the nodes of each scene, or above all parentless nodes if there are no scenes. Lights
/// and cameras, which nodes do not scale, are noted.
///
/// # Errors
/// [`taotie_engine::Error::Parse`] if scenes share some of their nodes, since a node can have only one parent.
pub(super) fn scale_to_metres(raw: &mut RawGltf, scale: f32, warnings: &mut Warnings) -> Result<()> {
    let scales = [short(scale); 3];
    let root = |children: &[Value]| json!({ "name": "metres", "scale": scales, "children": children });
    if edit::items(&raw.json, "scenes").is_empty() {
        let children = parentless(&raw.json);
        edit::push(&mut raw.json, "nodes", root(&children));
    }
    let mut roots: Vec<(Vec<Value>, usize)> = Vec::new();
    for scene in 0..edit::items(&raw.json, "scenes").len() {
        let children = edit::items(&raw.json["scenes"][scene], "nodes").to_vec();
        let shared = roots.iter().find(|(others, _)| children.iter().any(|child| others.contains(child)));
        let number = match shared {
            Some((same, number)) if *same == children => *number,
            Some(_) => {
                let why =
                    "shares nodes with another scene and cannot be scaled to metres; scale the file yourself";
                return Err(raw.error(format!("scene {scene}"), why));
            }
            None => edit::push(&mut raw.json, "nodes", root(&children)),
        };
        roots.push((children, number));
        *edit::member(&mut raw.json["scenes"][scene], "nodes") = json!([number]);
    }
    let count = |list: &str| raw.json.pointer(list).and_then(Value::as_array).map_or(0, Vec::len);
    let lit = count("/cameras") + count("/extensions/KHR_lights_punctual/lights");
    warnings.note("cameras and lights in the low-poly mesh's file; ranges not scaled to metres", lit);
    Ok(())
}

/// Returns the indices of all nodes without a parent.
fn parentless(json: &Value) -> Vec<Value> {
    let nodes = edit::items(json, "nodes");
    let children = nodes.iter().flat_map(|node| edit::items(node, "children")).filter_map(Value::as_u64);
    let children: BTreeSet<u64> = children.collect();
    (0..nodes.len() as u64).filter(|node| !children.contains(node)).map(Value::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::scene::{Clearcoat, TextureRole};

    #[test]
    fn only_triangles_without_a_material_get_the_default() {
        let primitives = json!([{ "material": 0 }, { "mode": 1 }, { "mode": 4 }, { "material": 9 }]);
        let mut json = json!({ "materials": [{ "name": "a" }], "meshes": [{ "primitives": primitives }] });
        give_default_material(&mut json, 0);
        assert_eq!(edit::items(&json, "materials").len(), 1, "0 exists");
        give_default_material(&mut json, 1);
        let named: Vec<_> = edit::items(&json["meshes"][0], "primitives")
            .iter()
            .map(|p| edit::number(p, "material"))
            .collect();
        assert_eq!(named, [Some(0), None, Some(1), Some(1)]);
        assert_eq!(edit::items(&json, "materials").len(), 2);
    }

    #[test]
    fn colours_go_where_the_material_is_shown() {
        let colored =
            |material: usize| json!({ "material": material, "attributes": { "COLOR_0": 1, "POSITION": 0 } });
        let mut json = json!({ "meshes": [{ "primitives": [colored(0), colored(1)] }] });
        drop_colors(&mut json, 1);
        let left = json!({ "material": 1, "attributes": { "POSITION": 0 } });
        assert_eq!(json["meshes"][0]["primitives"], json!([colored(0), left]));
    }

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
        graft(&mut json, &material, &Material::default(), Vec::new());
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
            let material = GltfMaterial { metallic: 1.0, layers: Some(own), ..GltfMaterial::default() };
            graft(&mut json, &material, said, Vec::new());
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
        let material = GltfMaterial { metallic: 1.0, ..GltfMaterial::default() };
        let left = |role: TextureRole| {
            let mut json = glossy.clone();
            graft(&mut json, &material, &Material::default(), vec![material.texture(role, 0)]);
            count_glossy(&json!({ "materials": [json] }))
        };
        let roles = [
            TextureRole::BaseColor,
            TextureRole::MetallicRoughness,
            TextureRole::Normal,
            TextureRole::Occlusion,
        ];
        assert_eq!(roles.map(left), [0, 0, 1, 1]);
    }

    #[test]
    fn what_nothing_says_is_not_made() {
        let mut json = json!({});
        let unsaid = GltfMaterial { metallic: 1.0, ..GltfMaterial::default() };
        graft(&mut json, &unsaid, &Material::default(), Vec::new());
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
        let textures = vec![baked.texture(TextureRole::BaseColor, 5), baked.texture(TextureRole::Normal, 6)];
        graft(&mut json, &baked, &Material::default(), textures);
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
