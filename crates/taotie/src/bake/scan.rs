//! The high-poly surface that is baked from.

use super::appearance::MaterialSample;
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::Scene;
use crate::trace::Bvh;
use std::sync::Arc;

/// The triangles of a high-poly scene with their materials, sorted so that they can be found from points of a low-poly
/// one.
///
/// Its shape is its triangles: rays, heights, occlusion and curvature know no map. Its normals are those that its
/// normal and height maps make of it.
pub struct Scan {
    surface: Arc<TexturedMesh>,
    bvh: Bvh,
}

impl Scan {
    /// Takes a scene over: one mesh in world space, with smooth normals where it had none.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] where the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: Scene) -> Result<Self> {
        Ok(Self::of(Arc::new(Self::surface_of(scene)?)))
    }

    /// Makes the surface that [`Scan::of`] sorts.
    ///
    /// # Errors
    /// As those of [`Scan::new`].
    pub(crate) fn surface_of(scene: Scene) -> Result<TexturedMesh> {
        TexturedMesh::new(scene)?.with_visible_means()
    }

    /// Sorts a surface, which others may share.
    pub(crate) fn of(surface: Arc<TexturedMesh>) -> Self {
        let mesh = surface.mesh();
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.corners(t));
        Self { surface, bvh }
    }

    /// Returns the triangles, world space, with normals.
    pub fn mesh(&self) -> &Mesh {
        self.surface.mesh()
    }

    /// Returns the triangles with their materials.
    pub fn surface(&self) -> &TexturedMesh {
        &self.surface
    }

    /// Returns the triangles sorted for rays.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Returns what the material is at a point.
    ///
    /// # Panics
    /// Where the mesh has no such triangle.
    pub fn sample(&self, at: LookupPoint) -> MaterialSample {
        self.surface.sample(at)
    }
}
