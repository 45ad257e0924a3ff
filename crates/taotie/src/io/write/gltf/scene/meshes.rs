//! Meshes with their materials, and their instances.

use super::super::packed::{Grid, PackedMesh};
use super::super::parts::MeshPart;
use super::super::{mesh, packed};
use super::writer::{Writer, placed};
use crate::error::Result;
use crate::math::Mat4;
use crate::mesh::Mesh;
use crate::scene::Instance;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Maximum deviation of two axes of a transform from a right angle, as a cosine, for it to count as orthogonal.
const SQUARE: f64 = 1e-4;

/// The written parts of a mesh of the scene.
struct Shape {
    primitives: Vec<Value>,
    grid: Option<Grid>,
}

impl Writer<'_> {
    /// Writes the instances, and each mesh once per material used with it; its data is shared.
    pub(super) fn meshes(&mut self) -> Result<()> {
        let scene = self.scene;
        let mut shapes: HashMap<usize, Shape> = HashMap::new();
        let mut numbers: HashMap<(usize, usize), usize> = HashMap::new();
        let mut meshes = Vec::new();
        let seen = |instance: &&Instance| !scene.meshes()[instance.mesh].triangles().is_empty();
        for instance in scene.instances().iter().filter(seen) {
            let shape = match shapes.entry(instance.mesh) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => place.insert(self.shape(&scene.meshes()[instance.mesh])?),
            };
            let number = *numbers.entry((instance.mesh, instance.material)).or_insert_with(|| {
                let mut primitives = shape.primitives.clone();
                primitives.iter_mut().for_each(|p| p["material"] = instance.material.into());
                meshes.push(json!({ "primitives": primitives }));
                meshes.len() - 1
            });
            self.instance(number, shape.grid.as_ref(), &instance.world_from_object)?;
        }
        self.draft.json["meshes"] = meshes.into();
        self.note("dropped meshes without triangles or instances", scene.meshes().len() - shapes.len());
        Ok(())
    }

    /// Names meshes, and the nodes that show them, after the scene's meshes.
    pub(super) fn name_meshes(&mut self, names: &[String]) {
        let scene = self.scene;
        let seen = |instance: &&Instance| !scene.meshes()[instance.mesh].triangles().is_empty();
        let nodes = self.nodes.iter_mut().filter(|node| node.get("mesh").is_some());
        for (node, instance) in nodes.zip(scene.instances().iter().filter(seen)) {
            let Some(name) = names.get(instance.mesh).filter(|name| !name.is_empty()) else { continue };
            node["name"] = name.as_str().into();
            let mesh = node["mesh"].as_u64().unwrap_or_default();
            if let Some(mesh) = self.draft.json.pointer_mut(&format!("/meshes/{mesh}")) {
                mesh["name"] = name.as_str().into();
            }
        }
    }

    fn shape(&mut self, mesh: &Mesh) -> Result<Shape> {
        self.note("meshes without normals, which glTF shows faceted", usize::from(mesh.normals().is_empty()));
        let lost = mesh.normals().is_empty() && !mesh.tangents().is_empty();
        self.note("dropped tangents of meshes without normals", usize::from(lost));
        let grid =
            self.format.meshopt.then(|| Grid::around(std::iter::once(mesh), self.format.bits.positions));
        let parts = [MeshPart::whole(mesh)];
        let primitives = match &grid {
            Some(grid) => packed::add(
                &mut self.draft,
                PackedMesh { mesh, parts: &parts, grid, bits: self.format.bits },
            )?,
            None => mesh::add(&mut self.draft, mesh, &parts),
        };
        Ok(Shape { primitives, grid })
    }

    /// Adds a node that shows a mesh, with a separate node below it if the mesh is packed and the node is
    /// transformed.
    fn instance(&mut self, mesh: usize, grid: Option<&Grid>, world: &Mat4) -> Result<()> {
        self.note(
            "sheared transforms, which not every program reads correctly",
            usize::from(is_sheared(world)),
        );
        let mut shown = json!({ "mesh": mesh });
        if let Some(grid) = grid {
            grid.place(&mut shown);
            if *world != Mat4::IDENTITY {
                self.nodes.push(shown);
                shown = json!({ "children": [self.nodes.len() - 1] });
            }
        }
        self.show(placed(shown, world)?);
        Ok(())
    }
}

/// Returns `true` if the axes are not at right angles. Source: glTF 2.0, 3.5.3, which requires decomposable matrices.
fn is_sheared(m: &Mat4) -> bool {
    let pair = |a: usize, b: usize| {
        let (a, b) = (m.axis(a), m.axis(b));
        a.dot(b).abs() > SQUARE * a.length() * b.length()
    };
    pair(0, 1) || pair(1, 2) || pair(2, 0)
}
