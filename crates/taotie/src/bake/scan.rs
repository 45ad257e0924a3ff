//! The high-poly surface to bake from.

use super::appearance::MaterialSample;
use super::seen_cells::SeenCells;
use super::sights::{Ground, Sights};
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::scene::Scene;
use crate::surface::facet_normal;
use crate::trace::Bvh;
use std::sync::{Arc, OnceLock};

/// The triangles of a high-poly scene with their materials, indexed for queries from points of a low-poly mesh.
///
/// Its shape is defined by its triangles: rays, heights, occlusion and curvature ignore maps. Its normals include its
/// normal and height maps.
pub struct Scan {
    surface: Arc<TexturedMesh>,
    bvh: Bvh,
    sights: Sights,
    /// Which sides of its triangles can be seen, as far as queried so far.
    seen: OnceLock<SeenCells>,
}

impl Scan {
    /// Takes over a scene as one mesh in world space, with smooth normals if it had none.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: Scene) -> Result<Self> {
        Ok(Self::of(Arc::new(Self::surface_of(scene)?)))
    }

    /// Takes over an asset made from a scan: it is seen from the same viewpoints, and backfaces that no renderer
    /// draws hide nothing.
    ///
    /// As [`Scan::new`].
    /// As those of [`Scan::new`].
    pub(crate) fn of_asset(scene: Scene, scan: &Scan) -> Result<Self> {
        let surface = Arc::new(Self::surface_of(scene)?);
        Ok(Self::with_sights(surface, |_| scan.sights.of_asset()))
    }

    /// Makes the surface that [`Scan::of`] indexes.
    ///
    /// # Errors
    /// As [`Scan::new`].
    pub(crate) fn surface_of(scene: Scene) -> Result<TexturedMesh> {
        TexturedMesh::new(scene)?.with_visible_means()
    }

    /// Builds the spatial index of a surface, which may be shared.
    pub(crate) fn of(surface: Arc<TexturedMesh>) -> Self {
        Self::with_sights(surface, Sights::of)
    }

    fn with_sights(surface: Arc<TexturedMesh>, sights: impl Fn(Ground<'_>) -> Sights) -> Self {
        let mesh = surface.mesh();
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.corners(t));
        let sights = sights(Ground { surface: &surface, bvh: &bvh });
        Self { surface, bvh, sights, seen: OnceLock::new() }
    }

    /// Returns the surface for visibility rays.
    pub(super) fn ground(&self) -> Ground<'_> {
        Ground { surface: &self.surface, bvh: &self.bvh }
    }

    /// Returns the viewpoints from which the surface is seen.
    pub(super) fn sights(&self) -> &Sights {
        &self.sights
    }

    /// Returns `true` if a point can be seen: its front, or either side of a double-sided material. Small triangles
    /// are visible or hidden as a whole.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn is_seen(&self, point: Point) -> bool {
        let Some(normal) = facet_normal(self.mesh().corners(point.triangle as usize)) else { return false };
        let is_double = self.surface.material(point.triangle).double_sided;
        self.is_visible(point, normal) || is_double && self.is_visible(point, -normal)
    }

    /// Returns `true` if a point can be seen from either side, as [`Scan::is_seen`] does for double-sided materials.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub(crate) fn is_seen_from_anywhere(&self, point: Point) -> bool {
        let normal = facet_normal(self.mesh().corners(point.triangle as usize));
        normal.is_some_and(|normal| self.is_visible(point, normal) || self.is_visible(point, -normal))
    }

    /// Returns `true` if the side of the surface that faces `direction` can be seen at a point.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub(super) fn is_visible(&self, point: Point, direction: Vec3) -> bool {
        let seen = self.seen.get_or_init(|| SeenCells::new(self.mesh(), self.sights.reach()));
        let is_front = self.mesh().faces(point.triangle, direction);
        let look = |point: Point| self.sights.is_side_visible(self.ground(), point, direction);
        seen.is_seen(self.mesh(), (point, is_front), look)
    }

    /// Returns the triangles, world space, with normals.
    pub fn mesh(&self) -> &Mesh {
        self.surface.mesh()
    }

    /// Returns the triangles with their materials.
    pub fn surface(&self) -> &TexturedMesh {
        &self.surface
    }

    /// Returns the triangles' acceleration structure for rays.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Returns the material values at a point.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn sample(&self, at: LookupPoint) -> MaterialSample {
        self.surface.sample(at)
    }
}
