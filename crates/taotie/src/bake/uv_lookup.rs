//! A surface looked up by its uvs, for pairs of meshes that share them.

use super::scan::merged;
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::mesh::Mesh;
use crate::scene::Scene;
use crate::trace::{Bvh, Ray};

/// The first uv set of a scene as a flat drawing whose places know their normal.
pub struct UvLookup {
    /// Each triangle at (u, v, 0).
    bvh: Bvh,
    mesh: Mesh,
}

impl UvLookup {
    /// Sorts all triangles of `scene` by their first uvs. Meshes without uvs are left out.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] where the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: &Scene) -> Result<Self> {
        let mut instances = scene.instances().to_vec();
        instances.retain(|instance| !scene.meshes()[instance.mesh].uvs().is_empty());
        let mesh = merged(&mut scene.meshes().to_vec(), &instances)?;
        let place = |v: u32| Vec3::new(mesh.uvs()[0][v as usize].x, mesh.uvs()[0][v as usize].y, 0.0);
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.triangles()[t].map(place));
        Ok(Self { bvh, mesh })
    }

    /// Returns the position and the unit normal (world space) of the place with this uv; where triangles overlap, of
    /// the first. `None` where there is none.
    pub fn at(&self, uv: Vec2) -> Option<(Vec3, Vec3)> {
        let ray = Ray::new(Vec3::new(uv.x, uv.y, -1.0), Vec3::new(0.0, 0.0, 1.0));
        let hit = self.bvh.nearest(&ray, f32::INFINITY)?;
        let point = hit.point();
        Some((point.position(&self.mesh), point.normal(&self.mesh)))
    }
}
