//! The errors of maps that no picture of the asset shows: each is read at points spread over the low-poly mesh and
//! compared with the scan there, seen head-on.
//!
//! Nothing is taken from the rays of the bake: the point of the scan is the one straight along the triangle's normal,
//! occlusion and thickness are integrated over other directions, and heights are measured by the distance from the scan of
//! the point that they state. Only if points of the same uv correspond, it is that point, which the bake uses too.

use crate::bake::{
    Bevel, Cage, Correspondence, LookupPoint, MapKind, ProjectionRay, Scan, Seen, Target, facet_of,
};
use crate::compare::{Field, Summary, angle_deg, color_difference};
use crate::error::Result;
use crate::math::{Vec2, Vec3, integration};
use crate::mesh::{Mesh, Point, TangentFrame, blend, each, sample_area};
use crate::parallel;
use crate::scene::NormalSpace;
use crate::shade::sampling::cosine_direction;
use crate::surface::{facet_normal, mean_curvatures, tangent_normal, tangent_space_normal};
use crate::trace::Ray;

/// The error of a map, at points that see the scan.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MapError {
    /// The unit: `°`; `ΔE00`; `share` of labels that are another's; a length or its inverse; or nothing.
    pub unit: String,
    /// The share of the points that do not see the scan and are not compared, [0, 1].
    pub unseen: f64,
    /// The errors at the others.
    #[serde(flatten)]
    pub summary: Summary,
}

/// A map as its file stores it.
#[derive(Clone, Copy)]
pub struct StoredMap<'a> {
    /// The kind of map; of metallic-roughness, only the metalness is compared.
    pub kind: MapKind,
    /// The space of directions and displacements.
    pub space: NormalSpace,
    /// The component of vectors and colours that is stored, 0 to 2; `None` if all are, and for numbers.
    pub component: Option<usize>,
    /// Returns the vector, colour (linear RGB) or number at a uv; numbers and single components are the first.
    pub value: &'a (dyn Fn(Vec2) -> Vec3 + Sync),
}

/// A low-poly mesh and its scan.
#[derive(Clone, Copy)]
pub struct MapCheck<'a> {
    /// The low-poly mesh, with uvs, normals and tangents.
    pub low: &'a Mesh,
    /// The cage of the bake, for the objects that each triangle shows and for the directions of heights.
    pub cage: &'a Cage,
    /// The scan.
    pub scan: &'a Scan,
    /// `true` if rays for occlusion, bent normals, thickness and rounded edges see only the objects that the cage names.
    pub isolated: bool,
    /// The distance within which surfaces occlude, in model units; `None` for any distance.
    pub sky_distance: Option<f32>,
    /// The radius of rounded edges, in model units; `None` for the default of a bake.
    pub bevel_radius: Option<f32>,
    /// The roughness that replaces that of the scan's materials, [0, 1]; `None` for theirs.
    pub roughness: Option<f32>,
}

/// Points at which a map is compared.
const POINTS: usize = 10_000;
/// The same for maps whose values need many rays.
const POINTS_OF_RAYS: usize = 1_000;
/// Rays for each of these points.
const RAYS: u32 = 512;
/// The distance along the normal within which the scan is looked for at least, as a fraction of its diagonal.
const REACH: f32 = 0.02;
/// The height above the surface at which rays start, as a fraction of the scan's diagonal.
const OFFSET: f32 = 1e-5;

impl MapCheck<'_> {
    /// Measures the error of a map, in `unit`: angles in degrees; CIEDE2000; differences of fractions, numbers,
    /// curvatures and single components; the distance of positions and displaced points from the point seen, and of points
    /// at a height from the scan, in model units; 1 or 0 for labels. `None` if no point sees the scan, and for maps that
    /// are not of the scan: wireframes.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the mesh has no area.
    pub fn error(&self, map: &StoredMap<'_>, unit: &str) -> Result<Option<MapError>> {
        if map.kind == MapKind::Wireframe {
            return Ok(None);
        }
        let count = if needs_rays(map.kind) { POINTS_OF_RAYS } else { POINTS };
        let point = sample_area(self.low, count)?;
        let known = Known::of(self, map.kind);
        let errors = parallel::collect(count, |i| {
            self.error_at(map, (point(i), i as u32), &known).unwrap_or(f32::NAN)
        });
        let summary = Field::new(count as u32, 1, errors)?.summary();
        Ok(summary.map(|summary| {
            let unseen = (count - summary.count) as f64 / count as f64;
            MapError { unit: unit.to_owned(), unseen, summary }
        }))
    }

    /// Returns the error at a point; `None` if it does not see the scan.
    fn error_at(&self, map: &StoredMap<'_>, (point, seed): (Point, u32), known: &Known) -> Option<f32> {
        let stored = (map.value)(point.uv(self.low, 0));
        let ray = self.head_on(point, known.diagonal)?;
        let found = self.scan.project(&ray)?;
        let mesh = self.scan.mesh();
        let seen = Seen { scan: self.scan, among: ray.among.filter(|_| self.isolated) };
        let around = Around::of(seen, &found, (known.diagonal * OFFSET, seed));
        let position = found.point.position(mesh);
        match map.kind {
            MapKind::Normal | MapKind::WorldNormal => {
                Some(self.turn(map, (point, stored), self.scan.mapped_normal(&found, 0.0).normal))
            }
            MapKind::Bent => Some(self.turn(map, (point, stored), around.open(self.sky_distance)?.1)),
            MapKind::Bevel => {
                Some(self.turn(map, (point, stored), known.bevel.as_ref()?.normal(seen, &found, 0)))
            }
            MapKind::Occlusion => Some((stored.x - around.open(self.sky_distance)?.0).abs()),
            MapKind::Thickness => Some((stored.x - around.thickness()).abs()),
            MapKind::Curvature | MapKind::Convexity | MapKind::Concavity => {
                let curvature =
                    blend(each(found.point.vertices(mesh), |v| known.curvatures[v]), found.point.weights);
                Some((stored.x - map.kind.of_curvature(curvature)).abs())
            }
            MapKind::Position => Some(map.distance(stored, position)),
            MapKind::Height if ray.target != Target::OnRay => Some((stored.x - found.height).abs()),
            MapKind::Height => {
                let ray = self.cage.projection_ray(self.low, point);
                let at = ray.point + ray.direction * stored.x;
                Some(self.scan.bvh().closest(at, f32::INFINITY)?.distance)
            }
            MapKind::VectorDisplacement => {
                let expected = Axes::of(self.low, map.space, point).components(position - ray.point);
                Some(map.distance(stored, expected))
            }
            MapKind::Gradient => Some((stored.x - MapKind::gradient(position.y, known.extent)).abs()),
            MapKind::VertexColor => {
                let color = if mesh.colors().is_empty() { Vec3::default() } else { found.point.color(mesh) };
                Some(map.color_error(stored, color))
            }
            MapKind::MaterialId => {
                Some(is_other(stored, self.scan.surface().material_number(found.point.triangle)))
            }
            MapKind::ObjectId => Some(is_other(stored, self.scan.object_number(found.point.triangle))),
            MapKind::Albedo
            | MapKind::Emission
            | MapKind::Roughness
            | MapKind::MetallicRoughness
            | MapKind::Alpha
            | MapKind::OcclusionMap => self.material_error(map, stored, &found),
            MapKind::Wireframe => None,
        }
    }

    /// Returns the difference from the scan's material; `None` for the colour of an invisible point.
    fn material_error(&self, map: &StoredMap<'_>, stored: Vec3, found: &Correspondence) -> Option<f32> {
        let sample = self.scan.sample(LookupPoint::finest(found.point));
        let expected = match map.kind {
            MapKind::Albedo => return (sample.alpha > 0.0).then(|| map.color_error(stored, sample.color)),
            MapKind::Emission => return Some(map.distance(stored, sample.emission)),
            MapKind::Roughness => self.roughness.unwrap_or(sample.roughness),
            MapKind::MetallicRoughness => sample.metallic,
            MapKind::Alpha => sample.alpha,
            _ => sample.occlusion,
        };
        Some((stored.x - expected).abs())
    }

    /// Returns the angle between the direction that a renderer shows and a unit vector in world space, degrees; of a
    /// single component, the difference.
    fn turn(&self, map: &StoredMap<'_>, (point, stored): (Point, Vec3), expected: Vec3) -> f32 {
        let is_in_world = map.kind == MapKind::WorldNormal || map.space == NormalSpace::Object;
        let TangentFrame { normal, tangent, handedness } = point.frame(self.low);
        match map.component {
            Some(_) if is_in_world => map.distance(stored, expected),
            Some(_) => map.distance(stored, tangent_space_normal(normal, tangent, handedness, expected)),
            None => {
                let shown =
                    if is_in_world { stored } else { tangent_normal(normal, tangent, handedness, stored) };
                angle_deg(shown.to_f64(), expected.to_f64()) as f32
            }
        }
    }

    /// Returns the ray of a viewer who looks at a point along the normal of its triangle.
    fn head_on(&self, point: Point, diagonal: f32) -> Option<ProjectionRay<'_>> {
        let ray = self.cage.projection_ray(self.low, point);
        let facet = facet_normal(self.low.corners(point.triangle as usize))?;
        let direction = if facet.dot(ray.direction) < 0.0 { -facet } else { facet };
        let distance = ray.distance.max(diagonal * REACH);
        // That of the same uv lies in the direction in which heights are stored.
        let direction = if ray.target == Target::OnRay { direction } else { ray.direction };
        Some(ProjectionRay { direction, distance, ..ray })
    }
}

impl StoredMap<'_> {
    /// Returns the distance from another vector, or the difference of the component that is stored.
    fn distance(&self, stored: Vec3, expected: Vec3) -> f32 {
        match self.component {
            None => (stored - expected).length(),
            Some(0) => (stored.x - expected.x).abs(),
            Some(1) => (stored.x - expected.y).abs(),
            Some(_) => (stored.x - expected.z).abs(),
        }
    }

    /// Returns CIEDE2000 from another colour, linear RGB, or the difference of the component that is stored.
    fn color_error(&self, stored: Vec3, expected: Vec3) -> f32 {
        match self.component {
            None => color_difference(stored.to_array(), expected.to_array()) as f32,
            Some(_) => self.distance(stored, expected),
        }
    }
}

/// The axes of displacements at a point: those of the world, or of the low-poly mesh's frame, made orthonormal.
struct Axes([Vec3; 3]);

impl Axes {
    fn of(low: &Mesh, space: NormalSpace, point: Point) -> Self {
        if space == NormalSpace::Object {
            return Self([Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)]);
        }
        let TangentFrame { normal, tangent, handedness } = point.frame(low);
        let n = normal.normalize_or(Vec3::new(0.0, 0.0, 1.0));
        let t = (tangent - n * n.dot(tangent)).normalize_or(n.any_perpendicular());
        Self([t, n.cross(t) * handedness, n])
    }

    /// Returns the components of a vector in world space.
    fn components(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.0.map(|axis| axis.dot(v));
        Vec3::new(x, y, z)
    }
}

/// Returns 1 for a label other than `number`.
fn is_other(stored: Vec3, number: usize) -> f32 {
    f32::from(u8::from(stored.x != number as f32))
}

/// Returns `true` if a value of the map is an integral over directions.
fn needs_rays(kind: MapKind) -> bool {
    matches!(kind, MapKind::Occlusion | MapKind::Bent | MapKind::Thickness | MapKind::Bevel)
}

/// Values that all points share.
struct Known {
    /// The curvature at the scan's vertices, for maps of it.
    curvatures: Vec<f32>,
    bevel: Option<Bevel>,
    /// The scan's lowest and highest y.
    extent: [f32; 2],
    /// The scan's diagonal, in model units.
    diagonal: f32,
}

impl Known {
    fn of(check: &MapCheck<'_>, kind: MapKind) -> Self {
        let mesh = check.scan.mesh();
        let is_curvature = kind.planes() == MapKind::Curvature.planes();
        Self {
            curvatures: if is_curvature { mean_curvatures(mesh) } else { Vec::new() },
            extent: mesh.vertical_extent(),
            diagonal: mesh.diagonal() as f32,
            bevel: (kind == MapKind::Bevel).then(|| Bevel::of_scan(mesh, check.bevel_radius, (RAYS, 1))),
        }
    }
}

/// The surroundings of a point of the scan, along directions that are spread by the cosine to its normal.
struct Around<'a> {
    seen: Seen<'a>,
    position: Vec3,
    normal: Vec3,
    facet: Vec3,
    offset: f32,
    seed: u32,
}

impl<'a> Around<'a> {
    fn of(seen: Seen<'a>, found: &Correspondence, (offset, seed): (f32, u32)) -> Self {
        let facet = facet_of(seen.scan, found);
        let position = found.point.position(seen.scan.mesh());
        Self { seen, position, normal: found.normal, facet, offset, seed }
    }

    /// Returns directions around the normal whose density is their cosine.
    fn directions(&self) -> impl Iterator<Item = Vec3> {
        let points = integration::Sequence::new(self.seed);
        let tangent = self.normal.any_perpendicular();
        let bitangent = self.normal.cross(tangent);
        (0..RAYS).map(move |i| {
            let [u, v, ..] = points.four(i, 0);
            let local = cosine_direction([u, v]);
            tangent * local.x + bitangent * local.y + self.normal * local.z
        })
    }

    /// Returns the open share of the hemisphere and the sum of the open directions; `None` if all of it is below the
    /// triangle.
    fn open(&self, distance: Option<f32>) -> Option<(f32, Vec3)> {
        let origin = self.position + self.facet * self.offset;
        let (mut looked, mut open, mut sum) = (0u32, 0u32, Vec3::default());
        for direction in self.directions().filter(|direction| direction.dot(self.facet) > 0.0) {
            looked += 1;
            let ray = Ray::new(origin, direction);
            let reach = distance.unwrap_or(f32::INFINITY);
            if !self.seen.scan.bvh().occluded(&ray, reach, |hit| self.seen.has(hit)) {
                open += 1;
                sum += direction;
            }
        }
        let direction = sum.normalize_or(self.normal);
        (looked > 0).then(|| (open as f32 / looked as f32, direction))
    }

    /// Returns the mean distance to the surface behind the point; 0 if there is none.
    fn thickness(&self) -> f32 {
        let below = self.position - self.facet * self.offset;
        let (mut met, mut sum) = (0u32, 0.0f64);
        for direction in self.directions().filter(|direction| direction.dot(self.facet) > 0.0) {
            let ray = Ray::new(below, -direction);
            let hit = self.seen.scan.bvh().nearest_of(&ray, f32::INFINITY, |hit| self.seen.has(hit));
            if let Some(hit) = hit {
                met += 1;
                sum += f64::from(hit.distance + self.offset);
            }
        }
        if met == 0 { 0.0 } else { (sum / f64::from(met)) as f32 }
    }
}
