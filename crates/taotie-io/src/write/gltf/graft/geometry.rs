//! The primitives and nodes of a document: the default material, vertex colours and tangents of primitives, and a
//! root node that scales everything to metres.

use super::super::draft::VERTICES;
use super::super::edit::{self, short};
use crate::gltf::{GltfSource, RawGltf, missing_tangents};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use taotie_engine::error::{Result, Warnings};

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
}
