//! The high-poly surface to bake from, what a viewer sees of it, which of its points can be seen, and devices other than
//! the CPU that cast rays at it.

use super::appearance::{Appearance, MaterialSample};
use super::sights::{Ground, SeenCells, SightLine, Sights};
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::error::Result;
use crate::image::Texture;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::scene::Scene;
use crate::surface::{facet_normal, shell_labels};
use crate::trace::{Bvh, Hit, Ray, RayInterval};
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
    /// The label of each triangle's shell, once a projection asks for it.
    shells: OnceLock<Vec<u32>>,
    /// The object of each part; parts beyond its end are separate objects.
    objects: Arc<[u32]>,
    /// The device that casts the rays of bakes; `None` for the CPU.
    device: Option<Arc<dyn RayDevice>>,
    /// Its triangles on that device, once a bake needs them.
    caster: OnceLock<Box<dyn RayCaster>>,
}

/// A device other than the CPU that casts rays of bakes, such as a GPU.
pub trait RayDevice: Send + Sync {
    /// Uploads the triangles of a scan.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if they do not fit, or those of the device.
    fn load(&self, scan: &Scan) -> Result<Box<dyn RayCaster>>;
}

/// The triangles of a scan on a [`RayDevice`]. Rays whose `group` is not `None` see only parts of the scan whose entry in
/// `groups` is the same. It may be called from several threads at once.
pub trait RayCaster: Send + Sync {
    /// Returns, for each ray, the triangles of the two hits nearest to its middle at which the scan's interpolated normal
    /// points along the ray, the nearest first.
    ///
    /// # Errors
    /// Those of the device.
    fn nearest(&self, rays: &[CastRay], groups: &[Option<u32>]) -> Result<Vec<[Option<u32>; 2]>>;

    /// Returns the open part of the hemisphere over each point.
    ///
    /// # Errors
    /// Those of the device.
    fn open(&self, sky: SkyRays<'_>, points: &[SkyPoint], groups: &[Option<u32>]) -> Result<Vec<Open>>;
}

/// The number of rays after which a batch is passed to a [`RayCaster`]: enough for all cores of a GPU. The last batch of
/// each band of a map is smaller.
pub(super) const BATCH: usize = 1 << 17;

/// Returns the memory in bytes that a bake needs in addition if a [`RayDevice`] casts its rays: batches of all threads,
/// and the triangles and vertices on a device that uses the memory of the CPU.
pub fn bytes_on_device(triangles: u64, vertices: u64) -> u64 {
    /// Rays and points of a batch, as the CPU and the device have them.
    const RAY: u64 = 512;
    /// A triangle with its share of the tree, as a list and on the device.
    const TRIANGLE: u64 = 32;
    const VERTEX: u64 = 32;
    /// The driver.
    const DRIVER: u64 = 96 << 20;
    let batches = rayon::current_num_threads() as u64 * BATCH as u64 * RAY;
    let scan = triangles.saturating_mul(TRIANGLE).saturating_add(vertices.saturating_mul(VERTEX));
    scan.saturating_add(batches + DRIVER)
}

/// A ray for a [`RayCaster`], world space and model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CastRay {
    /// Its middle.
    pub middle: Vec3,
    /// Its direction, unit.
    pub direction: Vec3,
    /// The distance of its ends from its middle.
    pub distance: f32,
    /// The group of parts of the scan that it sees; `None` for all.
    pub group: Option<u32>,
}

/// The directions of rays over the hemisphere.
#[derive(Debug, Clone, Copy)]
pub struct SkyRays<'a> {
    /// Unit vectors over the whole sphere.
    pub directions: &'a [Vec3],
    /// Points of class c follow direction c and every `classes`-th after it.
    pub classes: u32,
    /// The distance within which surfaces block them, in model units; may be infinite.
    pub distance: f32,
}

/// A point whose sky is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkyPoint {
    /// The origin of its rays, a little above the surface.
    pub origin: Vec3,
    /// The interpolated normal, unit: each direction is weighted by its cosine to it.
    pub normal: Vec3,
    /// The normal of the triangle on the same side, unit: directions below the triangle do not count.
    pub facet: Vec3,
    /// Its class, below [`SkyRays::classes`].
    pub class: u32,
    /// The group of parts of the scan that its rays see; `None` for all.
    pub group: Option<u32>,
}

/// The open part of a hemisphere: sums over directions, each weighted by its cosine.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Open {
    /// The weights of all directions.
    pub looked: f32,
    /// The weights of open directions.
    pub seen: f32,
    /// The weighted open directions.
    pub direction: Vec3,
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
    /// # Errors
    /// As [`Scan::new`].
    pub fn of_asset(scene: Scene, scan: &Scan) -> Result<Self> {
        let surface = Arc::new(Self::surface_of(scene)?);
        Ok(Self::with_sights(surface, |_| scan.sights.of_asset()))
    }

    /// Makes the surface that [`Scan::of`] indexes.
    ///
    /// # Errors
    /// As [`Scan::new`].
    pub fn surface_of(scene: Scene) -> Result<TexturedMesh> {
        TexturedMesh::new(scene)?.with_visible_means()
    }

    /// Builds the spatial index of a surface, which may be shared.
    pub fn of(surface: Arc<TexturedMesh>) -> Self {
        Self::with_sights(surface, Sights::of)
    }

    fn with_sights(surface: Arc<TexturedMesh>, sights: impl Fn(Ground<'_>) -> Sights) -> Self {
        let mesh = surface.mesh();
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.corners(t));
        let sights = sights(Ground { surface: &surface, bvh: &bvh });
        let (seen, shells, caster) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Self { surface, bvh, sights, seen, shells, objects: Arc::default(), device: None, caster }
    }

    /// Returns the scan with a device that casts the rays of its bakes.
    #[must_use]
    pub fn cast_by(self, device: Option<Arc<dyn RayDevice>>) -> Self {
        Self { device, caster: OnceLock::new(), ..self }
    }

    /// Returns the triangles on the device that casts the rays of bakes; the first call uploads them. `None` for the CPU.
    ///
    /// # Errors
    /// As [`RayDevice::load`].
    pub(super) fn caster(&self) -> Result<Option<&dyn RayCaster>> {
        let Some(device) = &self.device else { return Ok(None) };
        if self.caster.get().is_none() {
            let loaded = device.load(self)?;
            self.caster.get_or_init(|| loaded);
        }
        Ok(self.caster.get().map(Box::as_ref))
    }

    /// Uploads the triangles to the device that casts the rays of bakes, if there is one.
    ///
    /// # Errors
    /// As [`RayDevice::load`].
    pub fn load_on_device(&self) -> Result<()> {
        self.caster().map(|_| ())
    }

    /// Joins parts into objects: one number for each instance of its scene.
    #[must_use]
    pub fn with_objects(self, objects: Arc<[u32]>) -> Self {
        Self { objects, ..self }
    }

    /// Returns the number of a triangle's object.
    pub fn object_number(&self, triangle: u32) -> usize {
        let part = self.surface.part_number(triangle);
        self.objects.get(part).map_or(part, |object| *object as usize)
    }

    /// Returns the surface for visibility rays.
    fn ground(&self) -> Ground<'_> {
        Ground { surface: &self.surface, bvh: &self.bvh }
    }

    /// Returns the viewpoints from which the surface is seen.
    pub(super) fn sights(&self) -> &Sights {
        &self.sights
    }

    /// Returns `true` if a point can be seen: its front, or either side of a double-sided material. Parts of triangles whose
    /// corners and centre are all visible, or all hidden, count as a whole.
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
        let look = |point: Point, normal: Vec3| self.sights.is_side_visible(self.ground(), point, normal);
        seen.is_seen(self.mesh(), (point, is_front), look)
    }

    /// Returns `true` if two triangles are not connected.
    pub(super) fn are_apart(&self, a: u32, b: u32) -> bool {
        let shells = self.shells.get_or_init(|| shell_labels(self.mesh()));
        shells[a as usize] != shells[b as usize]
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

/// The surface that a viewer sees along a ray: the first one drawn, and its shading normal.
impl Scan {
    /// Returns the first hit below the distance `limit` that a renderer draws: front faces, back faces of
    /// double-sided materials, and nothing that alpha makes transparent.
    pub fn first_seen(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        let toward = -ray.direction();
        self.bvh().nearest_of(ray, limit, |hit| self.is_drawn(hit.point(), toward))
    }

    /// Returns the first hit below the distance `limit` that a renderer draws, but of those up to the distance `from` only
    /// what nothing shows through.
    pub fn first_seen_beyond(&self, ray: &Ray, (from, limit): (f32, f32)) -> Option<Hit> {
        let toward = -ray.direction();
        let is_solid = |hit: &Hit| self.surface().is_solid_at(hit.point());
        let counts = |hit: &Hit| self.is_drawn(hit.point(), toward) && (hit.distance > from || is_solid(hit));
        self.bvh().nearest_of(ray, limit, counts)
    }

    /// Returns the hit nearest to the centre of an interval of a ray at which a renderer draws something that can be seen
    /// through.
    pub fn seen_through(&self, ray: &Ray, interval: RayInterval) -> Option<Hit> {
        let toward = -ray.direction();
        let counts = |hit: &Hit| {
            let point = hit.point();
            (self.is_drawn(point, toward) && !self.surface().is_solid_at(point)).then_some(())
        };
        Some(self.bvh().nearest_to(ray, interval, counts).best()?.0)
    }

    /// Returns the unit normal with which a renderer shades a point, sampled at the lookup width `at.width`, for a
    /// viewer in the direction `toward`: the back of a double-sided material shows it reversed.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn seen_normal(&self, at: LookupPoint, toward: Vec3) -> Vec3 {
        let smooth = at.point.normal(self.mesh());
        let normal = self.surface().normal(at, smooth).normal;
        if self.mesh().faces(at.point.triangle, toward) { normal } else { -normal }
    }

    /// Returns the material at a point, sampled at the lookup width `at.width`.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn seen_material(&self, at: LookupPoint) -> MaterialSample {
        self.surface().sample(at)
    }

    /// Returns `true` if a renderer draws this point for a viewer in the direction `toward`.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn is_drawn(&self, point: Point, toward: Vec3) -> bool {
        let material = self.surface().material(point.triangle);
        if !material.double_sided && !self.mesh().faces(point.triangle, toward) {
            return false;
        }
        self.surface().is_shown_at(point)
    }
}

/// The triangles of a surface, some of whose textures are replaced.
pub(crate) struct Retextured<'a> {
    surface: &'a Scan,
    appearance: Appearance,
}

impl<'a> Retextured<'a> {
    /// Replaces textures by their index.
    ///
    /// # Errors
    /// As [`crate::image::Bitmap::new`].
    pub fn new(surface: &'a Scan, textures: &[usize], with: &Texture) -> Result<Self> {
        Ok(Self { surface, appearance: surface.surface().retextured(textures, with)? })
    }

    /// Returns the normal with which a renderer shades a point, as [`Scan::seen_normal`] does.
    pub fn seen_normal(&self, at: LookupPoint, toward: Vec3) -> Vec3 {
        let mesh = self.surface.mesh();
        let normal = self.appearance.normal(mesh, at, at.point.normal(mesh)).normal;
        if mesh.faces(at.point.triangle, toward) { normal } else { -normal }
    }

    /// Returns the material at a point, as [`Scan::seen_material`] does.
    pub fn seen_material(&self, at: LookupPoint) -> MaterialSample {
        self.appearance.sample(self.surface.mesh(), at)
    }
}

/// Determines which points of a surface a viewer can see.
///
/// A point is visible from outside if nothing hides it in the direction of its facet normal or in one of 256 fixed
/// directions on its front; for double-sided materials, on either side. If less than half of the area is visible in
/// this way, and more of it from the largest free space within, the surface is an interior (a room, a tomb, a cave),
/// and its points are seen from there.
#[derive(Clone, Copy)]
pub struct Visibility<'a> {
    surface: &'a Scan,
    sights: &'a Sights,
}

impl<'a> Visibility<'a> {
    /// Analyses a surface.
    pub fn of(surface: &'a Scan) -> Self {
        Self { surface, sights: surface.sights() }
    }

    /// Returns the viewpoints in the free space of an interior; none if it is seen from outside.
    pub fn places(&self) -> &'a [Vec3] {
        self.sights.places()
    }

    /// Returns `true` if the surface is seen from within: a room, a tomb or a cave.
    pub fn is_interior(&self) -> bool {
        !self.sights.places().is_empty()
    }

    /// Returns the line of sight closest to the normal at a point. `None` if it is hidden.
    pub fn sight_line(&self, point: Point) -> Option<SightLine> {
        self.sights.sight_line(self.surface.ground(), point)
    }
}
