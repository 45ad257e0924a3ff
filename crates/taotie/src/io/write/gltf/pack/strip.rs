//! Removes the data to be packed from a document.

use super::super::edit;
use super::super::graft::prune::{drop_unnamed, each_view};
use super::super::graft::views::joined;
use crate::error::Result;
use crate::io::gltf::{RawGltf, StoredVertices, is_known};
use serde_json::{Map, Value};

/// Drops the tangents of primitives whose material does not use them: it has neither a normal map nor anisotropy.
pub(super) fn unread_tangents(json: &mut Value) {
    let reads = |material: &Value| {
        let text = material.to_string();
        ["ormalTexture\"", "KHR_materials_anisotropy"].iter().any(|name| text.contains(name))
    };
    let reads: Vec<bool> = edit::items(json, "materials").iter().map(reads).collect();
    let primitives = edit::items_mut(json, "meshes").flat_map(|mesh| edit::items_mut(mesh, "primitives"));
    for primitive in primitives {
        let own = edit::number(primitive, "material").is_some_and(|own| reads.get(own) != Some(&false));
        // Variants may use other materials, and targets move existing tangents.
        let may_be_read = primitive.pointer("/extensions/KHR_materials_variants").is_some();
        if own || may_be_read || primitive.get("targets").is_some() {
            continue;
        }
        if let Some(attributes) = primitive.get_mut("attributes") {
            edit::remove(attributes, "TANGENT");
        }
    }
}

/// Removes the vertex accessors and their triangles from a document.
pub(super) fn geometry(json: &mut Value, vertices: &[StoredVertices]) {
    for primitive in vertices.iter().flat_map(|vertices| &vertices.primitives) {
        let json = &mut json["meshes"][primitive.mesh]["primitives"][primitive.primitive];
        ["indices", "targets", "mode"].iter().for_each(|name| edit::remove(json, name));
        json["attributes"] = Value::Object(Map::new());
    }
}

/// Drops the accessors and views that are no longer used, and returns the bytes of the others. All are kept if the
/// document uses an extension that may refer to any.
///
/// # Errors
/// [`crate::Error::Parse`] if a view refers to missing bytes.
pub(super) fn bytes(raw: &mut RawGltf) -> Result<Vec<u8>> {
    if edit::items(&raw.json, "extensionsUsed").iter().all(names_no_geometry) {
        drop_unnamed(&mut raw.json, "accessors", each_accessor);
        drop_unnamed(&mut raw.json, "bufferViews", each_view);
    }
    joined(raw)
}

/// Returns `true` if an extension is known, or is about materials, textures or lights.
pub(in super::super) fn names_no_geometry(name: &Value) -> bool {
    let looks = ["KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "EXT_lights_"];
    name.as_str().is_some_and(|name| is_known(name) || looks.iter().any(|prefix| name.starts_with(prefix)))
}

/// Visits the accessors of primitives, skins and animations.
pub(in super::super) fn each_accessor(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for mesh in edit::items_mut(json, "meshes") {
        for primitive in edit::items_mut(mesh, "primitives") {
            primitive.get_mut("indices").into_iter().for_each(&mut *visit);
            for attributes in edit::items_mut(primitive, "targets") {
                attributes.as_object_mut().into_iter().flatten().for_each(|(_, accessor)| visit(accessor));
            }
            let attributes = primitive.get_mut("attributes").and_then(Value::as_object_mut);
            attributes.into_iter().flatten().for_each(|(_, accessor)| visit(accessor));
        }
    }
    edit::items_mut(json, "skins")
        .filter_map(|skin| skin.get_mut("inverseBindMatrices"))
        .for_each(&mut *visit);
    for animation in edit::items_mut(json, "animations") {
        for sampler in edit::items_mut(animation, "samplers") {
            ["input", "output"].iter().for_each(|name| {
                sampler.get_mut(*name).into_iter().for_each(&mut *visit);
            });
        }
    }
}
