//! The order of blended surfaces: from the farthest triangle to the nearest, by the triangles' centres.

use std::ops::Range;
use taotie_engine::math::Mat4;
use taotie_engine::render::Surface;

/// Triangles of one surface, as a range of the indices of [`BlendOrder`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct BlendRun {
    /// The index of the surface.
    pub surface: usize,
    /// The indices of its vertices.
    pub indices: Range<u32>,
}

/// All triangles of blended surfaces, in drawing order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct BlendOrder {
    /// The vertices of each triangle, as indices into its surface.
    pub indices: Vec<[u32; 3]>,
    /// Runs of consecutive triangles of the same surface.
    pub runs: Vec<BlendRun>,
}

/// A triangle with the depth of its centre.
struct Placed {
    /// Reversed: 0 is far.
    depth: f64,
    surface: usize,
    triangle: usize,
}

impl BlendOrder {
    /// Sorts the triangles of the surfaces whose indices are in `blended`.
    pub(crate) fn new(surfaces: &[Surface<'_>], blended: &[usize], clip_from_world: &Mat4) -> Self {
        let mut placed = Vec::new();
        for surface in blended.iter().copied() {
            let count = surfaces[surface].triangles.len();
            placed.extend((0..count).map(|triangle| {
                let depth = depth(&surfaces[surface], triangle, clip_from_world);
                Placed { depth, surface, triangle }
            }));
        }
        // At equal depth, triangles that come first in the scene are on top.
        placed.sort_by(|a, b| {
            a.depth.total_cmp(&b.depth).then((b.surface, b.triangle).cmp(&(a.surface, a.triangle)))
        });
        let mut order = Self::default();
        for Placed { surface, triangle, .. } in placed {
            order.push(surface, surfaces[surface].triangles[triangle]);
        }
        order
    }

    fn push(&mut self, surface: usize, triangle: [u32; 3]) {
        let start = 3 * self.indices.len() as u32;
        self.indices.push(triangle);
        match self.runs.last_mut() {
            Some(run) if run.surface == surface => run.indices.end = start + 3,
            _ => self.runs.push(BlendRun { surface, indices: start..start + 3 }),
        }
    }
}

/// The reversed depth of a triangle's centre; infinite behind the eye.
fn depth(surface: &Surface<'_>, triangle: usize, clip_from_world: &Mat4) -> f64 {
    let [a, b, c] = surface.triangles[triangle].map(|v| surface.positions[v as usize].to_f64());
    let [_, _, z, w] = clip_from_world.transform_homogeneous((a + b + c) / 3.0);
    if w > 0.0 { z / w } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::Vec3;
    use taotie_engine::mesh::{Mesh, MeshData};
    use taotie_engine::render::{Prepared, SurfaceSettings};
    use taotie_engine::scene::{Instance, Material, Scene};

    /// A scene of two triangles, one in front of the other by `between`, instanced twice, the second time elsewhere.
    fn prepared() -> Prepared {
        let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let positions = [0.0, -2.0]
            .iter()
            .flat_map(|z| [corner(0.0, 0.0, *z), corner(1.0, 0.0, *z), corner(0.0, 1.0, *z)])
            .collect();
        let data = MeshData { positions, triangles: vec![[0, 1, 2], [3, 4, 5]], ..MeshData::default() };
        let mut scene = Scene::of_mesh(Mesh::new(data).unwrap(), Material::default()).unwrap();
        let world_from_object = Mat4::translation(Vec3::new(0.0, 0.0, -1.0));
        scene.edit(|data| data.instances.push(Instance { mesh: 0, material: 0, world_from_object })).unwrap();
        Prepared::new(scene, &SurfaceSettings::default()).unwrap()
    }

    /// Seen along −z from z = 10, depth 1/distance.
    fn view() -> Mat4 {
        Mat4 {
            columns: [
                [1.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, -1.0],
                [0.0, 0.0, 1.0, 10.0],
            ],
        }
    }

    #[test]
    fn far_triangles_come_first_whatever_surface_they_are_of() {
        let prepared = prepared();
        let order = BlendOrder::new(&prepared.surfaces(), &[0, 1], &view());
        // z: 0 and −2 of the first, −1 and −3 of the second.
        assert_eq!(order.indices, [[3, 4, 5], [3, 4, 5], [0, 1, 2], [0, 1, 2]]);
        let runs: Vec<_> = order.runs.iter().map(|run| (run.surface, run.indices.clone())).collect();
        assert_eq!(runs, [(1, 0..3), (0, 3..6), (1, 6..9), (0, 9..12)]);
    }

    #[test]
    fn triangles_of_one_surface_are_drawn_at_once_and_equal_ones_backwards() {
        let prepared = prepared();
        let surfaces = prepared.surfaces();
        let order = BlendOrder::new(&surfaces, &[0], &view());
        assert_eq!(order.runs, [BlendRun { surface: 0, indices: 0..6 }]);
        let [first, _] = surfaces[..] else { panic!("there are two") };
        let twice = BlendOrder::new(&[first, first], &[0, 1], &view());
        assert_eq!(twice.runs.iter().map(|run| run.surface).collect::<Vec<_>>(), [1, 0, 1, 0]);
    }
}
