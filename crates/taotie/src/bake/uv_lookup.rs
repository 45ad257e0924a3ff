//! A surface looked up by its uvs, for pairs of meshes that share them.

use super::corners::{self, Corners};
use crate::math::{Vec2, Vec3};
use crate::scene::Scene;
use crate::trace::{Bvh, Ray};

/// The first uv set of a scene as a flat drawing whose places know their normal.
pub struct UvLookup {
    /// Each triangle at (u, v, 0).
    bvh: Bvh,
    corners: Corners,
}

impl UvLookup {
    /// Sorts all triangles of `scene` by their first uvs. Meshes without uvs are left out.
    pub fn new(scene: &Scene) -> Self {
        let (mut flat, mut corners) = (Vec::new(), Corners::default());
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            let Some(uvs) = mesh.uvs().first() else { continue };
            let place = |i: u32| Vec3::new(uvs[i as usize].x, uvs[i as usize].y, 0.0);
            flat.extend(mesh.triangles().iter().map(|triangle| triangle.map(place)));
            corners.add(scene, instance);
        }
        Self { bvh: Bvh::build(&flat), corners }
    }

    /// Position and unit normal (world space) of the place with this uv; where triangles overlap, of the first. `None`
    /// where there is none.
    pub fn at(&self, uv: Vec2) -> Option<(Vec3, Vec3)> {
        let ray = Ray::new(Vec3::new(uv.x, uv.y, -1.0), Vec3::new(0.0, 0.0, 1.0));
        let hit = self.bvh.nearest(&ray, f32::INFINITY)?;
        let triangle = hit.triangle as usize;
        let position = corners::blend(self.corners.positions[triangle], hit.weights);
        Some((position, self.corners.normal_at(&hit)))
    }
}
