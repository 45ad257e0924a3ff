//! Tangents for primitives that have none and show a new normal map, provided that no vertex has to be split.

use super::super::edit;
use super::views;
use crate::error::Result;
use crate::io::gltf::{GltfSource, RawGltf, missing_tangents};
use serde_json::json;

/// Adds tangents to the primitives that use one of `materials`, given by index in the file `source`. For other
/// primitives, viewers generate them with MikkTSpace, as here.
///
/// # Errors
/// Those of reading the file.
pub(super) fn give(raw: &mut RawGltf, source: GltfSource<'_>, materials: &[usize]) -> Result<()> {
    if materials.is_empty() {
        return Ok(());
    }
    for found in missing_tangents(source, raw.reading(), materials)? {
        let bytes = found.tangents.as_flattened().iter().copied().flat_map(f32::to_le_bytes).collect();
        let view = views::add(raw, bytes);
        for view in edit::items_mut(&mut raw.json, "bufferViews").skip(view) {
            *edit::member(view, "target") = super::super::draft::VERTICES.into();
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
