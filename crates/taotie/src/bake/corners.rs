//! The triangles of a scene in world space.

use crate::math::Vec3;
use crate::scene::{Instance, Scene};
use crate::surface;
use crate::trace::Hit;

/// Positions and unit normals of each triangle's corners, world space, over all instances in order.
#[derive(Default)]
pub(super) struct Corners {
    pub positions: Vec<[Vec3; 3]>,
    pub normals: Vec<[Vec3; 3]>,
}

impl Corners {
    /// Adds the triangles of an instance; normals that its mesh lacks are made.
    pub fn add(&mut self, scene: &Scene, instance: &Instance) {
        let mesh = &scene.meshes[instance.mesh];
        let m = instance.world_from_object;
        let place = |i: u32| m.transform_point(mesh.positions()[i as usize].to_f64()).to_f32();
        let made = if mesh.normals().is_empty() { surface::vertex_normals(mesh) } else { Vec::new() };
        let normals = if made.is_empty() { mesh.normals() } else { &made };
        let matrix = m.normal_matrix();
        let turn = |i: u32| {
            let n = normals[i as usize].to_f64();
            matrix.transform_vector(n).normalize_or(n).to_f32()
        };
        self.positions.extend(mesh.triangles().iter().map(|triangle| triangle.map(place)));
        self.normals.extend(mesh.triangles().iter().map(|triangle| triangle.map(turn)));
    }

    /// The interpolated unit normal at a hit.
    pub fn normal_at(&self, hit: &Hit) -> Vec3 {
        let corners = self.normals[hit.triangle as usize];
        blend(corners, hit.weights).normalize_or(corners[0])
    }
}

/// The mean of three vectors with these weights.
pub(super) fn blend([a, b, c]: [Vec3; 3], [u, v, w]: [f32; 3]) -> Vec3 {
    a * u + b * v + c * w
}
