//! The counts of a glTF document's contents, and the placement of its models.

use crate::math::Mat4;

/// The contents of a glTF document, whether or not its scene shows them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GltfStructure {
    /// Nodes.
    pub nodes: usize,
    /// Meshes.
    pub meshes: usize,
    /// Primitives of all meshes.
    pub primitives: usize,
    /// Triangles of all primitives; each mesh counts once, however often it is shown.
    pub triangles: usize,
    /// Materials.
    pub materials: usize,
    /// The root nodes of the scene that show a mesh, directly or through a descendant.
    pub roots: Vec<RootNode>,
}

/// A root node of a glTF scene.
#[derive(Debug, Clone, PartialEq)]
pub struct RootNode {
    /// Its name, or `node` and its index.
    pub name: String,
    /// Transforms from the node's space to the world.
    pub world_from_node: Mat4,
}
