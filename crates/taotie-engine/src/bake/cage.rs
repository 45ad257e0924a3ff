//! The directions and distances used to search for the high-poly surface.

use super::projection::{Among, Correspondence, Floating, ProjectionRay, Target};
use super::scan::Scan;
use super::skew::{Evidence, Skew};
use super::texel_surface::UvIndex;
use crate::error::{Error, Result};
use crate::image::Texture;
use crate::math::{Vec3, integration};
use crate::mesh::{Mesh, MeshData, Point, blend, each, sample_area, triangle_weights};
use crate::parallel;
use crate::surface;
use crate::trace::Bvh;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

/// The search direction for the scan at each vertex of a low-poly mesh, and the ray distance.
///
/// Directions are the mean of the mesh's normals at a position, so that they do not split at hard edges and uv seams
/// and no gap opens between the projection rays of neighbouring texels.
#[derive(Debug, Clone)]
pub struct Cage {
    /// Outward, unit.
    directions: Vec<Vec3>,
    /// The ray distances, both into and out of the low-poly surface, in model units.
    distances: Vec<f32>,
    /// The longest of these.
    longest: f32,
    /// Which objects of the scan each triangle shows; `None` for all.
    groups: Option<Arc<CageGroups>>,
    /// Where rays follow the normals of triangles instead.
    skew: Skew,
    /// The scan's triangles by their uvs, if points of the same uv correspond; `None` if the rays find them.
    uvs: Option<Arc<UvIndex>>,
    /// Finds what floats above the mesh; `None` for nothing.
    floating: Option<Arc<Floating>>,
}

/// The objects of a scan that each triangle of a low-poly mesh shows: those of the same group.
#[derive(Debug, Clone)]
pub struct CageGroups {
    /// The group of each triangle; `None` if it shows all objects.
    pub of_triangle: Vec<Option<u32>>,
    /// The group of each object of the scan; `None` if no group shows it.
    pub of_object: Arc<[Option<u32>]>,
}

impl CageGroups {
    fn among(&self, triangle: u32) -> Option<Among<'_>> {
        let group = (*self.of_triangle.get(triangle as usize)?)?;
        Some(Among { groups: &self.of_object, group })
    }

    /// Returns those of a mesh of some of the triangles.
    pub fn of_triangles(&self, which: &[usize]) -> Self {
        let of_triangle = which.iter().map(|t| self.of_triangle.get(*t).copied().flatten()).collect();
        Self { of_triangle, of_object: Arc::clone(&self.of_object) }
    }

    /// Returns those of several meshes as one, given with their numbers of triangles; `None` if none has any.
    pub fn joined<'g>(all: impl IntoIterator<Item = (Option<&'g Arc<Self>>, usize)>) -> Option<Self> {
        let (mut of_triangle, mut of_object) = (Vec::new(), None);
        for (groups, triangles) in all {
            match groups {
                Some(groups) => {
                    of_triangle.extend_from_slice(&groups.of_triangle);
                    of_object.get_or_insert_with(|| Arc::clone(&groups.of_object));
                }
                None => of_triangle.extend(std::iter::repeat_n(None, triangles)),
            }
        }
        Some(Self { of_triangle, of_object: of_object? })
    }

    /// Returns those for a copy of their mesh with other triangles: each has the group of the closest one.
    pub fn carried_over(&self, own: &Mesh, copy: &Mesh) -> Self {
        let surface = Bvh::of(own.triangles().len(), |t| own.corners(t));
        let group = |t: usize| {
            let closest = surface.closest(blend(copy.corners(t), [1.0 / 3.0; 3]), f32::INFINITY)?;
            *self.of_triangle.get(closest.triangle as usize)?
        };
        let of_triangle = parallel::collect(copy.triangles().len(), group);
        Self { of_triangle, of_object: Arc::clone(&self.of_object) }
    }
}

/// The ray distance as a multiple of the measured gap.
const GAPS: f32 = 2.0;
/// The shortest ray distance, as a fraction of the mesh's diagonal.
const LEAST: f64 = 2e-4;
/// The gap is searched up to this fraction of the mesh's diagonal.
const MOST: f64 = 0.1;
/// A point hit along the direction and farther away than this fraction of the mesh's diagonal counts towards the gap
/// only if it is at most [`OBLIQUE`] times as far as the closest point; otherwise the line passed the scan and hit
/// another part.
const NEAR: f64 = 1e-2;
const OBLIQUE: f32 = 4.0;

/// The farthest closest point of the scan, as a multiple of the longest ray distance, for projection rays that hit
/// nothing.
const FALLBACK: f32 = 4.0;

impl Cage {
    fn new(directions: Vec<Vec3>, distances: Vec<f32>) -> Self {
        let longest = distances.iter().fold(0.0, |most: f32, v| most.max(*v));
        Self { directions, distances, longest, groups: None, skew: Skew::Kept, uvs: None, floating: None }
    }

    /// Makes each triangle show only the objects of its group.
    #[must_use]
    pub fn with_groups(self, groups: Option<Arc<CageGroups>>) -> Self {
        Self { groups, ..self }
    }

    /// Makes points of the mesh correspond to those of the scan with the same uv, instead of those on their rays.
    #[must_use]
    pub fn with_uvs(self, uvs: Option<Arc<UvIndex>>) -> Self {
        Self { uvs, ..self }
    }

    /// Makes the rays find what floats above the mesh.
    #[must_use]
    pub fn with_floating(self, floating: Option<Arc<Floating>>) -> Self {
        Self { floating, ..self }
    }

    /// Returns the distance above a mesh up to which [`Cage::automatic`] measures gaps, in model units.
    pub fn reach(low: &Mesh) -> f32 {
        (low.diagonal() * NEAR) as f32
    }

    /// Returns the cage of a part of its mesh: some of the vertices, and the triangles between them.
    #[must_use]
    pub fn part(&self, (vertices, triangles): (Range<usize>, Range<usize>)) -> Self {
        let (directions, distances) =
            (self.directions[vertices.clone()].to_vec(), self.distances[vertices].to_vec());
        let part = Self::new(directions, distances);
        let which: Vec<usize> = triangles.clone().collect();
        let groups = self.groups.as_ref().map(|groups| Arc::new(groups.of_triangles(&which)));
        let (uvs, floating) = (self.uvs.clone(), self.floating.clone());
        Self { groups, skew: self.skew.beginning_at(triangles.start), uvs, floating, ..part }
    }

    /// Returns `true` if points of the same uv correspond.
    pub fn matches_uvs(&self) -> bool {
        self.uvs.is_some()
    }

    /// Finds the distances: from points all over each triangle, searches for the scan along the directions and for
    /// its closest point; each vertex gets twice the largest gap of the triangles around it.
    pub fn automatic(low: &Mesh, scan: &Scan) -> Self {
        Self::automatic_in(low, scan, None)
    }

    /// The same for a mesh whose triangles show only the objects of their groups.
    pub fn automatic_in(low: &Mesh, scan: &Scan, groups: Option<Arc<CageGroups>>) -> Self {
        let directions = directions(low, groups.as_deref());
        let diagonal = low.diagonal();
        let search = GapSearch { low, directions: &directions, scan, diagonal, groups: groups.as_deref() };
        let evidence = parallel::collect(low.triangles().len(), |t| search.examine(t));
        let mut distances = vec![(diagonal * LEAST) as f32; directions.len()];
        for (triangle, found) in low.triangles().iter().zip(&evidence) {
            for v in triangle {
                distances[*v as usize] = distances[*v as usize].max(found.gap * GAPS);
            }
        }
        surface::shared_by_position(low, &mut distances);
        let skew = Skew::of_flat_faces(low, (&directions, &distances), &evidence);
        Self { skew, ..Self::new(directions, distances).with_groups(groups) }
    }

    /// Makes the rays on flat faces follow the face, away from its borders, if the scan does: rays along averaged
    /// normals would shift its relief there. [`Cage::automatic`] already does.
    #[must_use]
    pub fn straightened(self, low: &Mesh, scan: &Scan) -> Self {
        let (diagonal, groups) = (low.diagonal(), self.groups.as_deref());
        let search = GapSearch { low, directions: &self.directions, scan, diagonal, groups };
        let evidence = parallel::collect(low.triangles().len(), |t| search.examine(t));
        let skew = Skew::of_flat_faces(low, (&self.directions, &self.distances), &evidence);
        Self { skew, ..self }
    }

    /// Makes rays follow the normals of the mesh's triangles where the red channel of a mask on its first uv set is 1,
    /// and the averaged normals where it is 0.
    #[must_use]
    pub fn straightened_by(self, mask: Arc<Texture>) -> Self {
        Self { skew: Skew::Mask(mask), ..self }
    }

    /// Multiplies the ray distance at each vertex by a factor, at least 0; no factors leave it unchanged. A distance of 0
    /// finds only the closest point of the scan.
    #[must_use]
    pub fn scaled(self, factors: &[f32]) -> Self {
        let mut distances = self.distances;
        distances.iter_mut().zip(factors).for_each(|(distance, factor)| *distance *= factor);
        let longest = distances.iter().fold(0.0, |most: f32, v| most.max(*v));
        Self { distances, longest, ..self }
    }

    /// Makes all rays follow the normals averaged at vertices.
    #[must_use]
    pub fn skewed(self) -> Self {
        Self { skew: Skew::Kept, ..self }
    }

    /// Makes a cage with the same ray distance everywhere, both ways.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is not above 0 and finite.
    pub fn uniform(low: &Mesh, distance: f32) -> Result<Self> {
        Self::uniform_in(low, distance, None)
    }

    /// The same for a mesh whose triangles show only the objects of their groups.
    ///
    /// # Errors
    /// As [`Cage::uniform`].
    pub fn uniform_in(low: &Mesh, distance: f32, groups: Option<Arc<CageGroups>>) -> Result<Self> {
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(Error::invalid(
                format!("a ray distance of {distance}"),
                "use a value in model units above 0, or `auto`",
            ));
        }
        let directions = directions(low, groups.as_deref());
        let distances = vec![distance; directions.len()];
        Ok(Self::new(directions, distances).with_groups(groups))
    }

    /// Makes a cage from a cage mesh: the low-poly mesh with its vertices moved outward and its triangles in the same
    /// order. The vertices may be numbered differently, since hard edges and uv seams split them in one file and not
    /// in the other. Projection rays end at the cage, and reach equally far inward.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the cage has different triangles, or touches the mesh or is inside it.
    pub fn from_mesh(low: &Mesh, cage: &Mesh) -> Result<Self> {
        let places = places(low, cage)?;
        let normals = surface::vertex_normals(low);
        let way = |i: usize| places[i].map(|place| place - low.positions()[i]);
        let count = places.len();
        let inside = (0..count).filter(|i| way(*i).is_some_and(|way| way.dot(normals[*i]) <= 0.0)).count();
        if inside > 0 {
            let why = format!(
                "{inside} of its {count} vertices are not outside the low-poly mesh; move them outward"
            );
            return Err(Error::invalid("the cage", why));
        }
        let ways: Vec<Vec3> = (0..count).map(|i| way(i).unwrap_or(Vec3::splat(0.0))).collect();
        let distances = ways.iter().map(|way| way.length()).collect();
        let directions = ways.iter().zip(normals).map(|(way, normal)| way.normalize_or(normal)).collect();
        Ok(Self::new(directions, distances))
    }

    /// Returns the longest of the search distances for the scan, in model units.
    pub fn longest(&self) -> f32 {
        self.longest
    }

    /// Returns the projection ray through a point of the low-poly mesh.
    #[inline]
    pub fn projection_ray(&self, low: &Mesh, point: Point) -> ProjectionRay<'_> {
        let vertices = point.vertices(low);
        let directions = each(vertices, |v| self.directions[v]);
        let blended = blend(directions, point.weights).normalize_or(directions[0]);
        let start = point.position(low);
        let by_uv = self.uvs.as_ref().filter(|_| !low.uvs().is_empty());
        ProjectionRay {
            point: start,
            direction: self.skew.turned(low, point, blended),
            distance: blend(each(vertices, |v| self.distances[v]), point.weights),
            among: self.groups.as_ref().and_then(|groups| groups.among(point.triangle)),
            floating: self.floating.as_deref(),
            target: by_uv.map_or(Target::OnRay, |uvs| Target::SameUv(uvs.closest(point.uv(low, 0), start))),
        }
    }

    /// Returns the correspondence of a projection ray that hit nothing: the closest point of the scan, if it faces
    /// the same way; none if that of the same uv is wanted.
    pub(super) fn fallback(&self, scan: &Scan, projection: &ProjectionRay<'_>) -> Option<Correspondence> {
        let is_on_ray = projection.target == Target::OnRay;
        is_on_ray.then(|| scan.closest(projection, self.longest * FALLBACK)).flatten()
    }

    /// Returns the cage for a copy of its mesh whose vertices are reordered, fewer or slightly displaced: each takes
    /// the values of the cage at the closest point of the original mesh.
    pub fn carried_over(&self, own: &Mesh, copy: &Mesh) -> Self {
        let surface = Bvh::of(own.triangles().len(), |t| own.corners(t));
        let at = |v: usize| {
            let closest = surface.closest(copy.positions()[v], f32::INFINITY)?;
            let projection = self.projection_ray(own, closest.point());
            Some((projection.direction, projection.distance))
        };
        // A mesh without triangles has no line to follow.
        let lines = parallel::collect(copy.positions().len(), |v| at(v).unwrap_or_default());
        let (directions, distances) = lines.into_iter().unzip();
        let groups = self.groups.as_ref().map(|groups| Arc::new(groups.carried_over(own, copy)));
        let copy = Self::new(directions, distances).with_groups(groups);
        copy.with_uvs(self.uvs.clone()).with_floating(self.floating.clone())
    }
}

/// Returns the position in a cage mesh of each vertex of the low-poly mesh, matched by triangle corners; `None` if no
/// triangle uses the vertex.
fn places(low: &Mesh, cage: &Mesh) -> Result<Vec<Option<Vec3>>> {
    let [count, cage_count] = [low, cage].map(|mesh| mesh.triangles().len());
    let refused = |what: String| {
        Error::invalid("the cage", format!("{what}; use the low-poly mesh with its vertices moved"))
    };
    if count != cage_count {
        return Err(refused(format!("it has {cage_count} triangles, the low-poly mesh {count}")));
    }
    let mut places = vec![None; low.positions().len()];
    let mut torn = 0;
    for (own, outer) in low.triangles().iter().zip(cage.triangles()) {
        for (v, w) in own.iter().zip(outer) {
            let place = cage.positions()[*w as usize];
            torn += usize::from(*places[*v as usize].get_or_insert(place) != place);
        }
    }
    match torn {
        0 => Ok(places),
        _ => Err(refused(format!(
            "{torn} corners of its triangles are apart but share a vertex in the low-poly mesh: it is torn or its \
            triangles are in another order"
        ))),
    }
}

/// Projection rays to look at: from their inner to their outer ends, world space.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RayPreview {
    /// Those that find the scan.
    pub met: Vec<[Vec3; 2]>,
    /// Those that do not.
    pub missed: Vec<[Vec3; 2]>,
}

impl RayPreview {
    /// Follows `count` rays from points spread evenly over a low-poly mesh; none if it has no area. If points of the same
    /// uv correspond, a ray leads to that point.
    pub fn of(low: &Mesh, cage: &Cage, (scan, count): (&Scan, usize)) -> Self {
        let Ok(point) = sample_area(low, count.max(1)) else { return Self::default() };
        let rays = parallel::collect(count, |i| {
            let ray = cage.projection_ray(low, point(i));
            let found = scan.project(&ray);
            let reach = ray.direction * ray.distance;
            let ends = match (ray.target, &found) {
                (Target::SameUv(_), Some(found)) => [ray.point, found.point.position(scan.mesh())],
                _ => [ray.point - reach, ray.point + reach],
            };
            (ends, found.is_some())
        });
        let (met, missed): (Vec<_>, Vec<_>) = rays.into_iter().partition(|(_, is_met)| *is_met);
        let ends = |rays: Vec<([Vec3; 2], bool)>| rays.into_iter().map(|(ends, _)| ends).collect();
        Self { met: ends(met), missed: ends(missed) }
    }

    /// Returns an equal share of the rays of each of several meshes: together as many as of one.
    pub fn shared(all: &[&Self]) -> Self {
        let of = |ends: fn(&Self) -> &[[Vec3; 2]]| {
            all.iter().flat_map(|rays| ends(rays).iter().step_by(all.len())).copied().collect()
        };
        Self { met: of(|rays| &rays.met), missed: of(|rays| &rays.missed) }
    }
}

/// Returns the mean of all vertex normals at each vertex's position; if they cancel out or are missing, the mean of
/// the triangle normals around it. Parts of different groups that touch are separate.
fn directions(low: &Mesh, groups: Option<&CageGroups>) -> Vec<Vec3> {
    let mut of_groups: BTreeMap<Option<u32>, Vec<[u32; 3]>> = BTreeMap::new();
    for (triangle, group) in low.triangles().iter().zip(groups.iter().flat_map(|groups| &groups.of_triangle))
    {
        of_groups.entry(*group).or_default().push(*triangle);
    }
    let mut all = joint_directions(low);
    if of_groups.len() > 1 {
        for triangles in of_groups.into_values() {
            let used: Vec<u32> =
                BTreeSet::from_iter(triangles.as_flattened().iter().copied()).into_iter().collect();
            let of = |all: &[Vec3]| used.iter().filter_map(|v| all.get(*v as usize).copied()).collect();
            let number = |v: u32| used.partition_point(|own| *own < v) as u32;
            let triangles = triangles.into_iter().map(|triangle| triangle.map(number)).collect();
            let part = MeshData {
                positions: of(low.positions()),
                normals: of(low.normals()),
                triangles,
                ..MeshData::default()
            };
            // A part of a valid mesh is valid.
            let own = Mesh::new(part).map_or_else(|_| Vec::new(), |part| joint_directions(&part));
            used.iter().zip(own).for_each(|(v, direction)| all[*v as usize] = direction);
        }
    }
    all
}

/// Returns the same of one part.
fn joint_directions(low: &Mesh) -> Vec<Vec3> {
    let around = surface::vertex_normals(low);
    if low.normals().is_empty() {
        return around;
    }
    let means = surface::mean_by_position(low, low.normals());
    means.into_iter().zip(around).map(|(mean, around)| mean.normalize_or(around)).collect()
}

/// The positions where gaps between a mesh and its scan are measured.
struct GapSearch<'a> {
    low: &'a Mesh,
    /// Of the mesh's vertices.
    directions: &'a [Vec3],
    scan: &'a Scan,
    /// Of the mesh, model units.
    diagonal: f64,
    groups: Option<&'a CageGroups>,
}

impl GapSearch<'_> {
    /// Searches for the scan from a few points of a triangle.
    fn examine(&self, t: usize) -> Evidence {
        /// Approximate number of points examined over the whole mesh.
        const POINTS: usize = 60_000;
        let count = (POINTS / self.low.triangles().len()).clamp(2, 64) as u32;
        let points = integration::Sequence::new(t as u32);
        let corners = self.low.corners(t);
        let [a, b, c] = corners;
        let area = (b - a).cross(c - a).length() / count as f32;
        let normal = surface::facet_normal(corners);
        let mut all = Evidence::default();
        for i in 0..count {
            let [u, v, ..] = points.four(i, 0);
            let point = Point { triangle: t as u32, weights: triangle_weights(u, v) };
            let start = self.start(point);
            match self.nearest(&start) {
                Gap::Along(found) => {
                    let off = |to: Vec3| (1.0 - found.normal.dot(to)) * area;
                    let gap = found.height.abs();
                    let off_face = off(normal.unwrap_or(start.direction));
                    all = all.and(Evidence { gap, off_face, off_directions: off(start.direction), area });
                }
                Gap::Closest(gap) => all.gap = all.gap.max(gap),
                Gap::None => {}
            }
        }
        all
    }

    /// Returns the projection ray through a point, as long as the scan is [`NEAR`].
    fn start(&self, at: Point) -> ProjectionRay<'_> {
        let directions = at.vertices(self.low).map(|v| self.directions[v]);
        ProjectionRay {
            point: at.position(self.low),
            direction: blend(directions, at.weights).normalize_or(self.directions[0]),
            distance: (self.diagonal * NEAR) as f32,
            among: self.groups.and_then(|groups| groups.among(at.triangle)),
            floating: None,
            target: Target::OnRay,
        }
    }

    /// Finds the scan from the start of a ray: along its direction, or the closest point.
    fn nearest(&self, start: &ProjectionRay<'_>) -> Gap {
        if let Some(found) = self.scan.project(start) {
            return Gap::Along(found);
        }
        let most = (self.diagonal * MOST) as f32;
        let Some(closest) = self.scan.distance_to(start, most) else { return Gap::None };
        let longer = ProjectionRay { distance: (closest * OBLIQUE).max(start.distance), ..*start };
        self.scan.project(&longer).map_or(Gap::Closest(closest), Gap::Along)
    }
}

/// The scan as found from a point of the low-poly mesh.
enum Gap {
    /// Along the direction there.
    Along(Correspondence),
    /// Only at this distance of its closest point, model units.
    Closest(f32),
    None,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_different_groups_do_not_bend_the_rays_of_one_another() {
        let corners = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        let [up, aside] = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 0.0)];
        let low = Mesh::new(MeshData {
            positions: [corners, corners].concat(),
            normals: [[up; 3], [aside; 3]].concat(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            ..MeshData::default()
        })
        .expect("it is valid");
        let along = |of_triangle: [Option<u32>; 2]| {
            let groups = CageGroups { of_triangle: of_triangle.to_vec(), of_object: Arc::new([]) };
            directions(&low, Some(&groups))
        };
        let joint = (up + aside).normalize();
        assert!(along([Some(0); 2]).iter().all(|found| (*found - joint).length() < 1e-6));
        assert_eq!(along([Some(0), Some(1)]), [[up; 3], [aside; 3]].concat());
        assert_eq!(along([Some(0), None]), [[up; 3], [aside; 3]].concat());
    }
}
