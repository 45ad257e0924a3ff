//! Counts of the document's contents, and the root nodes shown by its scene.

use super::document::Document;
use super::nodes::Nodes;
use crate::io::structure::{GltfStructure, RootNode};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

/// Returns the counts of the document's contents.
pub(super) fn of(document: &Document, nodes: &Nodes) -> GltfStructure {
    let root = &document.root;
    let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    GltfStructure {
        nodes: root.nodes.len(),
        meshes: root.meshes.len(),
        primitives: primitives().count(),
        triangles: primitives().fold(0, |sum, one| sum.saturating_add(triangles(document, one))),
        materials: root.materials.len(),
        roots: roots(document, nodes),
    }
}

/// Returns the number of triangles implied by a primitive's accessors and mode; 0 for points and lines.
fn triangles(document: &Document, primitive: &Primitive) -> usize {
    let positions = || primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let accessor = primitive.indices.as_ref().or_else(positions);
    let accessor = accessor.and_then(|index| document.root.accessors.get(index.value()));
    let corners = accessor.map_or(0, |accessor| usize::try_from(accessor.count.0).unwrap_or(usize::MAX));
    match primitive.mode {
        Checked::Valid(Mode::Triangles) => corners / 3,
        Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => corners.saturating_sub(2),
        _ => 0,
    }
}

fn roots(document: &Document, nodes: &Nodes) -> Vec<RootNode> {
    let json = &document.root.nodes;
    let mut is_root = vec![false; json.len()];
    // The root above each node; parents come before their children.
    let mut root_of: Vec<usize> = (0..json.len()).collect();
    for node in nodes.shown.iter().copied() {
        if let Some(parent) = nodes.nodes[node].parent {
            root_of[node] = root_of[parent];
        }
        is_root[root_of[node]] |= json[node].mesh.is_some();
    }
    let roots = (0..json.len()).filter(|node| is_root[*node]);
    roots
        .map(|node| RootNode {
            name: json[node].name.clone().unwrap_or_else(|| format!("node {node}")),
            world_from_node: nodes.world[node],
        })
        .collect()
}
