//! Primitives to meshes, each built once for all nodes that show it alike.

use super::accessor::Accessor;
use super::document::{Document, Reason, no_such};
use super::nodes::Nodes;
use super::repair::repair;
use super::triangles::{read_indices, triangulate};
use super::vertices::{Pose, Vertices, joint_matrices};
use crate::error::{Error, Result, Warnings};
use crate::math::Mat4;
use crate::mesh::Mesh;
use crate::scene::Instance;
use gltf::json;
use gltf::json::mesh::Primitive;
use gltf::json::validation::Checked;
use std::collections::HashMap;

/// The most vertices and indices of all meshes together, in multiples of the bytes of the buffers. Sharing data
/// between primitives is common; a small file that asks for gigabytes is not.
const MAX_ELEMENTS_PER_BYTE: usize = 8;

/// Added to that, so that tiny files are free.
const MAX_ELEMENTS_OF_SMALL: usize = 1 << 22;

const NOT_TRIANGLES: &str = "primitives of points or lines; only triangles are drawn";

/// The meshes of the scene with their places.
#[derive(Default)]
pub(super) struct Meshes {
    /// The meshes.
    pub meshes: Vec<Mesh>,
    /// Their names, in the same order.
    pub names: Vec<String>,
    /// Where they are shown. `material` is that of the file, or the number of the file's materials for the default.
    pub instances: Vec<Instance>,
}

/// A mesh of the file, and the node that poses it if it has a skin or morph weights of its own.
type Key = (usize, Option<usize>);

/// Builds what the shown nodes show. A primitive that cannot be read is left out with a warning.
///
/// # Errors
/// The first primitive's where none can be read, or that there is nothing to draw.
pub(super) fn build(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Result<Meshes> {
    let mut builder = Builder {
        document,
        nodes,
        warnings,
        budget: MAX_ELEMENTS_OF_SMALL + MAX_ELEMENTS_PER_BYTE * document.total_bytes(),
        built: HashMap::new(),
        out: Meshes::default(),
        failures: Vec::new(),
    };
    for node in &nodes.shown {
        builder.show(*node)?;
    }
    if document.root.nodes.is_empty() {
        builder.show_library()?;
    }
    builder.finish()
}

struct Builder<'a> {
    document: &'a Document,
    nodes: &'a Nodes,
    warnings: &'a mut Warnings,
    budget: usize,
    built: HashMap<Key, Vec<(usize, usize)>>,
    out: Meshes,
    failures: Vec<(String, String)>,
}

impl Builder<'_> {
    /// Shows every mesh of a file that has no nodes at all, such as a library of parts.
    fn show_library(&mut self) -> Result<()> {
        for mesh in 0..self.document.root.meshes.len() {
            self.warnings.note("meshes that no node shows, since the file has none; drawn at the origin", 1);
            for (mesh, material) in self.build_mesh(mesh, None)? {
                self.out.instances.push(Instance { mesh, material, world_from_object: Mat4::IDENTITY });
            }
        }
        Ok(())
    }

    fn show(&mut self, node: usize) -> Result<()> {
        let json = &self.document.root.nodes[node];
        let Some(mesh) = json.mesh.map(|m| m.value()) else { return Ok(()) };
        let posed = json.skin.is_some() || json.weights.is_some();
        let key = (mesh, posed.then_some(node));
        if !self.built.contains_key(&key) {
            let parts = self.build_mesh(mesh, Some(node))?;
            self.built.insert(key, parts);
        }
        // A skin puts the mesh into the world by itself: the node's own place does not count (glTF 2.0, 3.7.3.3).
        let world = if json.skin.is_some() { Mat4::IDENTITY } else { self.nodes.world[node] };
        for (mesh, material) in &self.built[&key] {
            self.out.instances.push(Instance { mesh: *mesh, material: *material, world_from_object: world });
        }
        Ok(())
    }

    /// The meshes and materials of the primitives of mesh `index` as `node` shows them.
    fn build_mesh(&mut self, index: usize, node: Option<usize>) -> Result<Vec<(usize, usize)>> {
        let posed = match self.document.root.meshes.get(index) {
            Some(mesh) => self.pose(mesh, node).map(|pose| (mesh, pose)),
            None => Err(no_such("mesh", index)),
        };
        let (mesh, pose) = match posed {
            Ok(posed) => posed,
            Err(why) => {
                self.failures.push((node.map_or("scene".into(), |n| format!("node {n}")), why));
                return Ok(Vec::new());
            }
        };
        let mut parts = Vec::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let place = place_of(mesh.name.as_deref(), index, p);
            match self.build_primitive(primitive, &pose, &place) {
                Ok(Some(built)) => {
                    self.out.meshes.push(built);
                    self.out.names.push(mesh.name.clone().unwrap_or_else(|| format!("mesh {index}")));
                    parts.push((self.out.meshes.len() - 1, self.material_of(primitive, &place)));
                }
                Ok(None) => {}
                Err(Stop::Here(why)) => self.failures.push((place, why)),
                Err(Stop::Everything(error)) => return Err(error),
            }
        }
        Ok(parts)
    }

    fn pose(&mut self, mesh: &json::Mesh, node: Option<usize>) -> Reason<Pose> {
        let node = node.map(|n| &self.document.root.nodes[n]);
        let weights = node.and_then(|n| n.weights.as_ref()).or(mesh.weights.as_ref());
        let mut weights = weights.cloned().unwrap_or_default();
        for weight in weights.iter_mut().filter(|w| !w.is_finite()) {
            self.warnings.note("morph weights that were infinite or NaN, set to 0", 1);
            *weight = 0.0;
        }
        let skin = node.and_then(|n| n.skin).map(|s| s.value());
        let joints =
            skin.map(|s| joint_matrices(self.document, s, &self.nodes.world, self.warnings)).transpose()?;
        Ok(Pose { weights, joints })
    }

    /// The mesh of a primitive; `None` where it has nothing to draw.
    fn build_primitive(
        &mut self,
        primitive: &Primitive,
        pose: &Pose,
        place: &str,
    ) -> std::result::Result<Option<Mesh>, Stop> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err("its mode is unknown".to_owned().into());
        };
        let Some(vertices) = Vertices::open(self.document, primitive)? else {
            self.warnings.note("primitives without POSITION; nothing to draw", 1);
            return Ok(None);
        };
        let indices = self.indices(primitive, vertices.count)?;
        let Some(triangles) = triangulate(mode, &indices) else {
            self.warnings.note(NOT_TRIANGLES, 1);
            return Ok(None);
        };
        self.warnings.note("indices that make no whole triangle", triangles.surplus);
        let (used, triangles) = compact(triangles.list, vertices.count);
        if triangles.is_empty() {
            self.warnings.note("primitives without a triangle; nothing to draw", 1);
            return Ok(None);
        }
        let mut data = vertices.read(&used, pose, place, self.warnings)?;
        data.triangles = triangles;
        repair(&mut data, self.warnings);
        let mesh = Mesh::new(data).map_err(|e| e.to_string())?;
        self.warnings.note("triangles without area", mesh.degenerate_triangles());
        Ok(Some(mesh))
    }

    fn indices(&mut self, primitive: &Primitive, vertices: usize) -> std::result::Result<Vec<u32>, Stop> {
        let within = |why: String| format!("indices: {why}");
        let accessor = match primitive.indices {
            Some(index) => Some(Accessor::open(self.document, index.value()).map_err(within)?),
            None => None,
        };
        self.spend(accessor.as_ref().map_or(vertices, |a| a.count))?;
        Ok(read_indices(accessor.as_ref(), vertices).map_err(within)?)
    }

    fn spend(&mut self, elements: usize) -> std::result::Result<(), Stop> {
        match self.budget.checked_sub(elements) {
            Some(rest) => self.budget = rest,
            None => {
                let bytes = self.document.total_bytes();
                return Err(Stop::Everything(Error::limit(
                    format!("{}: the geometry", self.document.path.display()),
                    format!("its primitives share {bytes} bytes too many times; split the file"),
                )));
            }
        }
        Ok(())
    }

    fn material_of(&mut self, primitive: &Primitive, place: &str) -> usize {
        let count = self.document.root.materials.len();
        let index = primitive.material.map_or(count, |m| m.value());
        if index > count || (index == count && primitive.material.is_some()) {
            self.warnings.note(format!("{place}: {}; drawn with the default", no_such("material", index)), 1);
        }
        index.min(count)
    }

    fn why_empty(&self) -> &'static str {
        if self.warnings.iter().any(|(what, _)| what == NOT_TRIANGLES) {
            "there is nothing to draw: it holds only points or lines"
        } else {
            "there is nothing to draw: no node shows a triangle"
        }
    }

    fn finish(self) -> Result<Meshes> {
        if self.out.instances.is_empty() {
            return Err(match self.failures.first() {
                Some((place, why)) => self.document.error(place, why),
                None => self.document.error("scene", self.why_empty()),
            });
        }
        for (place, why) in self.failures {
            self.warnings.note(format!("{place} is left out: {why}"), 1);
        }
        Ok(self.out)
    }
}

/// Whether one primitive or the whole file fails.
enum Stop {
    Here(String),
    Everything(Error),
}

impl From<String> for Stop {
    fn from(why: String) -> Self {
        Self::Here(why)
    }
}

fn place_of(name: Option<&str>, mesh: usize, primitive: usize) -> String {
    let name: String = name.unwrap_or_default().chars().filter(|c| !c.is_control()).take(60).collect();
    if name.is_empty() {
        format!("mesh {mesh}, primitive {primitive}")
    } else {
        format!("mesh {mesh} '{name}', primitive {primitive}")
    }
}

/// The vertices that triangles name, in rising order, and the triangles over them.
fn compact(mut triangles: Vec<[u32; 3]>, count: usize) -> (Vec<u32>, Vec<[u32; 3]>) {
    let corners = triangles.as_flattened();
    if corners.len() < count / 4 {
        // A small part of a large shared array: time and space by the part alone.
        let mut used = corners.to_vec();
        used.sort_unstable();
        used.dedup();
        for index in triangles.as_flattened_mut() {
            *index = used.partition_point(|u| u < index) as u32;
        }
        return (used, triangles);
    }
    let mut new_index = vec![u32::MAX; count];
    corners.iter().for_each(|i| new_index[*i as usize] = 0);
    let mut used = Vec::with_capacity(count);
    for (i, new) in new_index.iter_mut().enumerate().filter(|(_, new)| **new == 0) {
        *new = used.len() as u32;
        used.push(i as u32);
    }
    for index in triangles.as_flattened_mut() {
        *index = new_index[*index as usize];
    }
    (used, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compacting_drops_what_no_triangle_names() {
        let triangles = vec![[7, 2, 4], [4, 2, 9]];
        let expected = (vec![2, 4, 7, 9], vec![[2, 0, 1], [1, 0, 3]]);
        assert_eq!(compact(triangles.clone(), 10), expected, "dense");
        assert_eq!(compact(triangles, 1000), expected, "sparse");
        assert_eq!(compact(vec![[2, 0, 1]], 3), (vec![0, 1, 2], vec![[2, 0, 1]]), "all used: as stored");
    }
}
