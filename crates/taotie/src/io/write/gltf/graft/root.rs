//! A root node for a document, which scales it to metres.

use super::super::edit;
use super::super::number::short;
use crate::error::{Result, Warnings};
use crate::io::gltf::RawGltf;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Puts a scaling node above the nodes of each scene, or above all parentless nodes if there are no scenes. Lights
/// and cameras, which nodes do not scale, are noted.
///
/// # Errors
/// [`crate::Error::Parse`] if scenes share some of their nodes, since a node can have only one parent.
pub(super) fn scale(raw: &mut RawGltf, scale: f32, warnings: &mut Warnings) -> Result<()> {
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
