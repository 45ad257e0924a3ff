//! The primitives of a document that use a material.

use super::super::edit::{self, items, items_mut};
use serde_json::{Value, json};

/// Adds glTF's default material to the file if `number` is one past the last, and assigns it to all triangles without
/// a material.
pub(super) fn give_default(json: &mut Value, number: usize) {
    let count = items(json, "materials").len();
    if number != count {
        return;
    }
    edit::push(json, "materials", json!({}));
    let primitives = items_mut(json, "meshes").flat_map(|mesh| items_mut(mesh, "primitives"));
    let names_none = |primitive: &&mut Value| {
        edit::number(primitive, "material").is_none_or(|named| named >= count)
            && edit::number(primitive, "mode").is_none_or(|mode| (4..=6).contains(&mode))
    };
    primitives.filter(names_none).for_each(|p| *edit::member(p, "material") = number.into());
}

/// Removes the vertex colours of primitives that use a material.
pub(super) fn drop_colors(json: &mut Value, material: usize) {
    const COLORS: &str = "COLOR_0";
    let primitives = items_mut(json, "meshes").flat_map(|mesh| items_mut(mesh, "primitives"));
    for primitive in primitives.filter(|p| edit::number(p, "material") == Some(material)) {
        let packed = "/extensions/KHR_draco_mesh_compression/attributes";
        for place in ["/attributes", packed] {
            primitive.pointer_mut(place).into_iter().for_each(|attributes| edit::remove(attributes, COLORS));
        }
        items_mut(primitive, "targets").for_each(|target| edit::remove(target, COLORS));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_triangles_without_a_material_get_the_default() {
        let primitives = json!([{ "material": 0 }, { "mode": 1 }, { "mode": 4 }, { "material": 9 }]);
        let mut json = json!({ "materials": [{ "name": "a" }], "meshes": [{ "primitives": primitives }] });
        give_default(&mut json, 0);
        assert_eq!(items(&json, "materials").len(), 1, "0 exists");
        give_default(&mut json, 1);
        let named: Vec<_> =
            items(&json["meshes"][0], "primitives").iter().map(|p| edit::number(p, "material")).collect();
        assert_eq!(named, [Some(0), None, Some(1), Some(1)]);
        assert_eq!(items(&json, "materials").len(), 2);
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
