//! Surface lookup by uv, for pairs of meshes that share uvs.

use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::scene::Scene;
use crate::trace::{Bvh, Ray};

/// The first uv set of a scene as a flat mesh whose points map to a position and normal.
pub struct UvLookup {
    /// Each triangle at (u, v, 0).
    bvh: Bvh,
    surface: TexturedMesh,
}

impl UvLookup {
    /// Indexes all triangles of `scene` by their first uvs. Meshes without uvs are skipped.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: &Scene) -> Result<Self> {
        let mut scene = scene.clone().into_data();
        scene.instances.retain(|instance| !scene.meshes[instance.mesh].uvs().is_empty());
        let surface = TexturedMesh::new(Scene::new(scene)?)?;
        let mesh = surface.mesh();
        let place = |v: u32| Vec3::new(mesh.uvs()[0][v as usize].x, mesh.uvs()[0][v as usize].y, 0.0);
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.triangles()[t].map(place));
        Ok(Self { bvh, surface })
    }

    /// Returns the position and the unit normal (world space) at this uv, with normal and height maps read at their
    /// finest level; if triangles overlap, of the first. `None` if there is none.
    pub fn at(&self, uv: Vec2) -> Option<(Vec3, Vec3)> {
        let ray = Ray::new(Vec3::new(uv.x, uv.y, -1.0), Vec3::new(0.0, 0.0, 1.0));
        let point = self.bvh.nearest(&ray, f32::INFINITY)?.point();
        let mesh = self.surface.mesh();
        let normal = self.surface.normal(LookupPoint::finest(point), point.normal(mesh)).normal;
        Some((point.position(mesh), normal))
    }
}
