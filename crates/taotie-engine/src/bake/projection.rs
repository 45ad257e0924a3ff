//! The projection of a low-poly mesh onto the high-poly surface: point by point, for all samples of a triangle in a tile
//! in one pass, or for those of many triangles on a device other than the CPU.

use super::layout::{Sample, TriangleSamples};
use super::scan::{CastRay, RayCaster, Scan};
use super::texture_lookup::{LookupPoint, MappedNormal};
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point, blend};
use crate::names::Named;
use crate::trace::{Bvh, Hit, Nearest, PacketView, Ray, RayInterval, RayPacket};
use std::fmt;

/// A correspondence: the point of the high-poly surface onto which a point of the low-poly mesh is projected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correspondence {
    /// The height along the projection ray: above 0 outside the low-poly surface, in model units.
    pub height: f32,
    /// The interpolated normal there, without maps: unit, world space.
    pub normal: Vec3,
    /// The point itself, on the scan's mesh.
    pub point: Point,
}

/// A ray through a point of the low-poly mesh along which its correspondence is searched.
#[derive(Debug, Clone, Copy)]
pub struct ProjectionRay<'a> {
    /// A point of the low-poly surface, world space.
    pub point: Vec3,
    /// Outward, unit.
    pub direction: Vec3,
    /// The ray distance, both into and out of the low-poly surface, in model units.
    pub distance: f32,
    /// The objects of the scan on which its correspondence may be; `None` for all.
    pub among: Option<Among<'a>>,
    /// Finds parts of the scan that float above the low-poly surface; `None` for none.
    pub floating: Option<&'a Floating>,
    /// Where its correspondence is.
    pub target: Target,
}

/// How points of a low-poly mesh find those of the scan that they show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MatchRule {
    /// Along rays; objects named `X_low` show only objects of the scan named `X_high`, with any X.
    #[default]
    ByName,
    /// The same, and rays for occlusion, bent normals, thickness and rounded edges see only these objects, too.
    Isolated,
    /// Along rays, whatever the names of objects.
    Nearest,
    /// By the same uv.
    Uv,
}

impl Named for MatchRule {
    const WHAT: &'static str = "rule of matching";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("by-name", Self::ByName),
        ("isolated", Self::Isolated),
        ("nearest", Self::Nearest),
        ("uv", Self::Uv),
    ];
}

impl MatchRule {
    /// Returns `true` if names of objects matter.
    pub const fn reads_names(self) -> bool {
        matches!(self, Self::ByName | Self::Isolated)
    }
}

/// The place of a correspondence.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Target {
    /// Where the projection ray meets the scan.
    #[default]
    OnRay,
    /// The point of the scan with the same uv; `None` if it has none there.
    SameUv(Option<Point>),
}

/// Finds parts of a scan that float above a low-poly surface, such as bolts: separate shells, close above another
/// one, that the low-poly mesh lacks.
pub struct Floating {
    low: Bvh,
    /// The height up to which they are found beyond a projection ray, in model units.
    reach: f32,
}

impl fmt::Debug for Floating {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Floating").field("reach", &self.reach).finish_non_exhaustive()
    }
}

impl Floating {
    /// Finds what floats above a low-poly mesh, within the projection rays and up to the height `reach`, in model units.
    pub fn above(low: &Mesh, reach: f32) -> Self {
        Self { low: Bvh::of(low.triangles().len(), |t| low.corners(t)), reach }
    }

    /// Returns `true` if the low-poly mesh has another surface between its point on a projection ray and a height
    /// above it, or slightly higher.
    fn is_modelled(&self, projection: &ProjectionRay<'_>, height: f32) -> bool {
        /// The start of the search, as a fraction of the height: the surface itself does not count.
        const START: f32 = 1e-2;
        let end = height * 1.25 + projection.distance * 0.5;
        let start = height * START;
        let ray = Ray::new(projection.point + projection.direction * start, projection.direction);
        self.low.occluded(&ray, end - start, |_| true)
    }
}

/// The objects of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Among<'a> {
    /// The group of each part of the scan.
    pub groups: &'a [Option<u32>],
    /// The group that counts.
    pub group: u32,
}

impl ProjectionRay<'_> {
    /// Returns the ray from its inner end, and its relevant interval.
    #[inline]
    fn ray(&self) -> (Ray, RayInterval) {
        let ray = Ray::new(self.point - self.direction * self.distance, self.direction);
        (ray, RayInterval { from: 0.0, center: self.distance, to: self.distance + self.distance })
    }

    /// Returns the correspondence of a hit of [`ProjectionRay::ray`] on a surface with this normal.
    #[inline]
    fn found(&self, hit: &Hit, normal: Vec3) -> Correspondence {
        Correspondence { height: hit.distance - self.distance, normal, point: hit.point() }
    }
}

impl Scan {
    /// Returns the nearest point on the ray at which the scan's normal points along the ray and that can be seen: a
    /// surface facing the other way is the far side of something else, and hidden walls and ghost layers do not count.
    /// If none of the points can be seen, the nearest one is used.
    pub fn project(&self, projection: &ProjectionRay<'_>) -> Option<Correspondence> {
        if let Target::SameUv(found) = projection.target {
            return found.map(|point| self.fixed(projection, point));
        }
        let (ray, interval) = projection.ray();
        let nearest = self.bvh().nearest_to(&ray, interval, |hit| self.facing(hit, projection));
        self.visible_of(projection, nearest)
    }

    /// Returns the same as [`Scan::project`], given the triangles of the two hits nearest to the low-poly surface.
    fn project_onto(
        &self,
        projection: &ProjectionRay<'_>,
        named: [Option<u32>; 2],
    ) -> Option<Correspondence> {
        let (ray, interval) = projection.ray();
        let mut nearest = Nearest::on(interval);
        for triangle in named.into_iter().flatten() {
            let is_known = (triangle as usize) < self.mesh().triangles().len();
            let met = is_known.then(|| ray.intersect(self.mesh().corners(triangle as usize))).flatten();
            let hit = met.map(|(distance, weights)| Hit { triangle, weights, distance });
            let faced = hit.and_then(|hit| Some((hit, self.facing(&hit, projection)?)));
            let Some((hit, normal)) = faced else { return self.project(projection) };
            nearest.offer(hit, |_| Some(normal));
        }
        match nearest.best() {
            Some(_) => self.visible_of(projection, nearest),
            None => self.project(projection),
        }
    }

    /// Returns the correspondence at a point of the scan, whichever way it faces.
    fn fixed(&self, projection: &ProjectionRay<'_>, point: Point) -> Correspondence {
        let way = point.position(self.mesh()) - projection.point;
        Correspondence { height: way.dot(projection.direction), normal: point.normal(self.mesh()), point }
    }

    /// Returns the correspondence among the nearest hits to a position on its ray. Visibility is checked only if
    /// there are several.
    fn visible_of(&self, projection: &ProjectionRay<'_>, nearest: Nearest<Vec3>) -> Option<Correspondence> {
        let (hit, normal) = nearest.best()?;
        let is_visible = |hit: &Hit| self.is_visible(hit.point(), projection.direction);
        let found = match nearest.second() {
            None => (hit, normal),
            // Parts of other groups may hide it.
            Some(_) if projection.among.is_some() => (hit, normal),
            Some(_) if is_visible(&hit) => (hit, normal),
            Some((second, normal)) if is_visible(&second) => (second, normal),
            Some(_) => {
                let (ray, interval) = projection.ray();
                let facing = |hit: &Hit| self.facing(hit, projection).filter(|_| is_visible(hit));
                self.bvh().nearest_to(&ray, interval, facing).best().unwrap_or((hit, normal))
            }
        };
        let found = projection.found(&found.0, found.1);
        Some(self.floating_above(projection, &found).unwrap_or(found))
    }

    /// Returns the outermost visible point on a projection ray that floats above a correspondence.
    fn floating_above(
        &self,
        projection: &ProjectionRay<'_>,
        found: &Correspondence,
    ) -> Option<Correspondence> {
        let floating = projection.floating?;
        let (ray, _) = projection.ray();
        let from = (found.height + projection.distance).next_up();
        let to = projection.distance + projection.distance.max(floating.reach);
        if from >= to {
            return None;
        }
        let is_apart = |hit: &Hit| self.are_apart(hit.triangle, found.point.triangle);
        let outer = |hit: &Hit| self.facing(hit, projection).filter(|_| is_apart(hit));
        let (hit, normal) =
            self.bvh().nearest_to(&ray, RayInterval { from, center: to, to }, outer).best()?;
        let outermost = projection.found(&hit, normal);
        let counts = projection.among.is_some() || self.is_visible(hit.point(), projection.direction);
        (counts && !floating.is_modelled(projection, outermost.height)).then_some(outermost)
    }

    /// Returns the normal of a correspondence with the relief of the scan's normal and height maps, sampled at the
    /// lookup width `width`, in model units; at their finest level if it is 0. Without a map it is the normal itself.
    pub fn mapped_normal(&self, found: &Correspondence, width: f32) -> MappedNormal {
        self.surface().normal(LookupPoint { point: found.point, width }, found.normal)
    }

    /// Returns the scan's normal at a hit, if it points along the ray.
    #[inline]
    fn facing(&self, hit: &Hit, projection: &ProjectionRay<'_>) -> Option<Vec3> {
        let normal = hit.point().normal(self.mesh());
        (normal.dot(projection.direction) > 0.0 && self.may_show(projection, hit.triangle)).then_some(normal)
    }

    /// Returns `true` if a triangle belongs to an object on which the correspondence may be.
    #[inline]
    fn may_show(&self, projection: &ProjectionRay<'_>, triangle: u32) -> bool {
        self.is_among(projection.among, triangle)
    }

    /// Returns `true` if a triangle belongs to one of some objects; `None` is all of them.
    #[inline]
    pub(crate) fn is_among(&self, among: Option<Among<'_>>, triangle: u32) -> bool {
        among.is_none_or(|among| {
            among.groups.get(self.surface().part_number(triangle)) == Some(&Some(among.group))
        })
    }

    /// Returns the distance from the start of a projection ray to the closest point of the scan within `most`.
    pub(super) fn distance_to(&self, projection: &ProjectionRay<'_>, most: f32) -> Option<f32> {
        let counts = |triangle| self.may_show(projection, triangle);
        Some(self.bvh().closest_of(projection.point, most, counts)?.distance)
    }

    /// Returns the point of the scan closest to the start of a projection ray, within `most`, if its normal points along
    /// the ray.
    pub fn closest(&self, projection: &ProjectionRay<'_>, most: f32) -> Option<Correspondence> {
        let ProjectionRay { point, direction, .. } = *projection;
        let counts = |triangle| self.may_show(projection, triangle);
        let closest = self.bvh().closest_of(point, most, counts)?;
        let there = closest.point();
        let normal = there.normal(self.mesh());
        let side = if (there.position(self.mesh()) - point).dot(direction) < 0.0 { -1.0 } else { 1.0 };
        let found = Correspondence { height: closest.distance * side, normal, point: there };
        (normal.dot(direction) > 0.0).then_some(found)
    }
}

/// Up to this number, samples are faster to find one by one.
const FEW: usize = 6;

/// Directions that diverge more than this from the triangle's own do not form a packet: each ray would pass many
/// others.
const LEAST_COSINE: f32 = 0.9;

/// Returns the correspondence of each projection ray of a triangle in a tile, as [`Scan::project`] finds it.
///
/// Neighbouring samples look in nearly the same direction, so their projections form a packet: columns and rows are
/// those of the tile, and depths run along the mean direction.
pub(super) fn search(
    scan: &Scan,
    group: &TriangleSamples,
    corners: [Vec3; 3],
    projections: &[ProjectionRay<'_>],
) -> Vec<Option<Correspondence>> {
    let one_by_one = || projections.iter().map(|projection| scan.project(projection)).collect();
    let is_on_ray = |projection: &ProjectionRay<'_>| projection.target == Target::OnRay;
    if projections.len() <= FEW || !projections.iter().all(is_on_ray) {
        return one_by_one();
    }
    let Some(view) = view(group, corners, projections) else { return one_by_one() };
    let (rays, mut nearest): (Vec<Ray>, Vec<Nearest<Vec3>>) = projections
        .iter()
        .map(|projection| {
            let (ray, interval) = projection.ray();
            (ray, Nearest::on(interval))
        })
        .unzip();
    let middle = middle(group).at.map(f32::from);
    let place = |sample: &Sample| [0, 1].map(|axis| f32::from(sample.at[axis]) - middle[axis]);
    let places: Vec<[f32; 2]> = group.samples.iter().map(place).collect();
    let Some(mut packet) = RayPacket::new(&rays, &places, view) else { return one_by_one() };
    scan.bvh().meet_all(&mut packet, |i, hit| {
        nearest[i].offer(hit, |hit| scan.facing(hit, &projections[i]));
        true
    });
    let found =
        |(projection, nearest): (&ProjectionRay<'_>, Nearest<Vec3>)| scan.visible_of(projection, nearest);
    projections.iter().zip(nearest).map(found).collect()
}

/// Returns the correspondence of each projection ray, as [`Scan::project`] finds it, with the hits found by a device.
///
/// The device only names triangles, which are intersected again here. If that fails, or if it named none, the ray is
/// cast here too: so rays do not pass between the triangles of a single sheet, and heights and normals do not depend on
/// how the device rounds. Where two sheets face the same way within the ray's length, a device that misses the nearer one
/// at an edge names the other.
///
/// # Errors
/// Those of the device.
pub(super) fn search_by(
    caster: &dyn RayCaster,
    scan: &Scan,
    projections: &[ProjectionRay<'_>],
) -> Result<Vec<Option<Correspondence>>> {
    let cast = |projection: &ProjectionRay<'_>| CastRay {
        middle: projection.point,
        direction: projection.direction,
        distance: projection.distance,
        group: projection.among.map(|among| among.group),
    };
    let is_on_ray = |projection: &&ProjectionRay<'_>| projection.target == Target::OnRay;
    let rays: Vec<CastRay> = projections.iter().filter(is_on_ray).map(cast).collect();
    let mut named = caster.nearest(&rays, groups(projections))?.into_iter();
    let found = |projection: &ProjectionRay<'_>| {
        let named = if is_on_ray(&projection) { named.next() } else { None };
        scan.project_onto(projection, named.unwrap_or_default())
    };
    Ok(projections.iter().map(found).collect())
}

/// Returns the groups of the scan's parts that some projection rays of a cage refer to; none if they see all parts.
pub(super) fn groups<'a>(projections: &[ProjectionRay<'a>]) -> &'a [Option<u32>] {
    projections.iter().find_map(|projection| projection.among).map_or(&[], |among| among.groups)
}

/// Returns the sample at which columns and rows are zero: near all others, so that coordinates have small rounding
/// errors.
fn middle(group: &TriangleSamples) -> &Sample {
    &group.samples[group.samples.len() / 2]
}

/// Returns the view of a ray packet along the projection rays of a triangle; `None` if it is seen edge-on.
///
/// A sample at column x and row y looks along origin + x · across + y · down + depth · direction.
fn view(
    group: &TriangleSamples,
    corners: [Vec3; 3],
    projections: &[ProjectionRay<'_>],
) -> Option<PacketView> {
    let [corner, across, down] = group.weights.map(|weights| blend(corners, weights));
    let (across, down) = (across - corner, down - corner);
    let origin = blend(corners, middle(group).weights);
    let sum = projections.iter().fold(Vec3::default(), |sum, projection| sum + projection.direction);
    let mean = sum.normalize_or(projections[0].direction);
    let scale = 1.0 / across.cross(down).dot(mean);
    let axes = [down.cross(mean) * scale, mean.cross(across) * scale, across.cross(down) * scale];
    let parts =
        |projection: &ProjectionRay<'_>| projection.direction.dot(axes[2].normalize_or(mean)) < LEAST_COSINE;
    if !axes.iter().all(|axis| axis.is_finite()) || projections.iter().any(parts) {
        return None;
    }
    let mut slack = [0.0f32; 2];
    let mut depths = [f32::INFINITY, f32::NEG_INFINITY];
    let mut farthest = 0.0f32;
    for projection in projections {
        for way in [-projection.distance, projection.distance] {
            let end = projection.point + projection.direction * way;
            farthest = farthest.max((end - origin).length()).max(end.length());
            for k in 0..2 {
                slack[k] = slack[k].max((axes[k].dot(projection.direction) * way).abs());
            }
            let depth = axes[2].dot(end - origin);
            depths = [depths[0].min(depth), depths[1].max(depth)];
        }
    }
    // A generous bound on the rounding of positions and of their projections.
    let rounding = axes.map(|axis| axis.length() * farthest * 2e-6);
    Some(PacketView {
        origin,
        axes,
        slack: [slack[0] + rounding[0] + 1e-3, slack[1] + rounding[1] + 1e-3],
        depths: [depths[0] - rounding[2], depths[1] + rounding[2]],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Cage;
    use crate::bake::layout::Layout;
    use crate::math::Mat4;
    use crate::mesh::{Mesh, MeshData};
    use crate::scene::{Instance, Material, Scene, SceneData};

    /// Returns two squares, one above the other, the lower facing up, the upper down.
    fn sheets() -> Scan {
        let square = |z: f32, order: [u32; 6]| {
            let corner = |x: f32, y: f32| Vec3::new(x, y, z);
            let positions = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            let triangles = vec![[order[0], order[1], order[2]], [order[3], order[4], order[5]]];
            Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
        };
        let meshes = vec![square(0.0, [0, 1, 2, 0, 2, 3]), square(1.0, [0, 2, 1, 0, 3, 2])];
        let instances =
            (0..2).map(|mesh| Instance { mesh, material: 0, world_from_object: Mat4::IDENTITY }).collect();
        let materials = vec![Material::default()];
        let data = SceneData { meshes, instances, materials, ..SceneData::default() };
        Scan::new(Scene::new(data).unwrap()).unwrap()
    }

    #[test]
    fn finds_the_nearest_sheet_that_faces_the_same_way() {
        let scan = sheets();
        let up = Vec3::new(0.0, 0.0, 1.0);
        let projection = |z: f32, direction: Vec3, distance: f32| ProjectionRay {
            point: Vec3::new(0.3, 0.4, z),
            direction,
            distance,
            among: None,
            floating: None,
            target: Target::OnRay,
        };
        let at = |z: f32, distance: f32| scan.project(&projection(z, up, distance));
        let below = at(0.2, 0.5).unwrap();
        assert!((below.height + 0.2).abs() < 1e-6 && (below.normal - up).length() < 1e-6);
        assert!((at(-0.1, 0.5).unwrap().height - 0.1).abs() < 1e-6);
        let on = at(0.0, 0.5).unwrap();
        assert!(on.height.abs() < 1e-6 && (on.normal - up).length() < 1e-6);
        assert!(at(0.3, 0.2).is_none(), "beyond the ray distance");
        assert!(
            at(0.9, 0.5).is_none(),
            "the nearer sheet faces the other way, the other is beyond the ray distance"
        );
        assert!(
            (at(0.9, 1.0).unwrap().height + 0.9).abs() < 1e-6,
            "surfaces facing the other way are passed through"
        );
        let down = scan.project(&projection(0.9, -up, 0.5)).unwrap();
        assert!((down.height + 0.1).abs() < 1e-6);
        // Objects that do not belong to the ray are passed through, and are not close to it.
        let groups = [Some(7), None];
        let far = |group| {
            let among = Some(Among { groups: &groups, group });
            ProjectionRay { among, ..projection(0.9, up, 2.0) }
        };
        assert!((scan.project(&far(7)).unwrap().height + 0.9).abs() < 1e-6);
        assert!(scan.project(&far(8)).is_none() && scan.distance_to(&far(8), 2.0).is_none());
        assert!((scan.distance_to(&far(7), 2.0).unwrap() - 0.9).abs() < 1e-6);
        let above = |groups| {
            let among = Some(Among { groups, group: 1 });
            scan.distance_to(&ProjectionRay { among, ..projection(0.9, up, 2.0) }, 2.0)
        };
        assert!((above(&[None, Some(1)]).unwrap() - 0.1).abs() < 1e-6);
    }

    #[test]
    fn the_closest_point_counts_where_it_faces_the_same_way() {
        let scan = sheets();
        let up = Vec3::new(0.0, 0.0, 1.0);
        let outside = Vec3::new(-0.3, 0.5, 0.1);
        let closest = |direction: Vec3, most: f32| {
            let projection = ProjectionRay {
                point: outside,
                direction,
                distance: 0.0,
                among: None,
                floating: None,
                target: Target::OnRay,
            };
            scan.closest(&projection, most)
        };
        let found = closest(up, 1.0).unwrap();
        assert!((found.height + 0.1f32.hypot(0.3)).abs() < 1e-6 && (found.normal - up).length() < 1e-6);
        assert!(closest(-up, 1.0).is_none());
        assert!(closest(up, 0.1).is_none());
    }

    /// Returns a plate whose middle a smaller one covers: `apart` or connected by walls.
    fn plate(apart: bool) -> Scan {
        let square = |half: f32, z: f32| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, y]: [f32; 2]| Vec3::new(x * half, y * half, z))
        };
        let positions = [square(1.0, 0.0), square(0.2, 0.01)].concat();
        let mut triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        if !apart {
            triangles.extend(
                (0..4).flat_map(|i| [[i, (i + 1) % 4, 4 + i], [(i + 1) % 4, 4 + (i + 1) % 4, 4 + i]]),
            );
        }
        let mesh = Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap();
        Scan::new(Scene::of_mesh(mesh, Material::default()).unwrap()).unwrap()
    }

    #[test]
    fn what_floats_above_the_low_poly_mesh_is_found() {
        let plate_of = |z: f32| {
            let corner = |x: f32, y: f32| Vec3::new(x, y, z);
            let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            let triangles = vec![[0, 1, 2], [0, 2, 3]];
            Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
        };
        let (below, above) = (plate_of(0.0), plate_of(0.01));
        let both = Mesh::joined([&below, &above]).unwrap();
        let height = |scan: &Scan, floating: Option<&Floating>, (x, distance): (f32, f32)| {
            let (point, direction) = (Vec3::new(x, 0.05, 0.0), Vec3::new(0.0, 0.0, 1.0));
            let ray =
                ProjectionRay { point, direction, distance, among: None, floating, target: Target::OnRay };
            scan.project(&ray).unwrap().height
        };
        let scan = plate(true);
        let is_near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
        let far = Floating::above(&below, 0.02);
        is_near(height(&scan, Some(&far), (0.05, 0.001)), 0.01);
        is_near(height(&scan, Some(&far), (0.5, 0.001)), 0.0);
        is_near(height(&scan, None, (0.05, 0.001)), 0.0);
        // A ray that is long enough finds it, a shorter one does not.
        let within = Floating::above(&below, 0.0);
        is_near(height(&scan, Some(&within), (0.05, 0.02)), 0.01);
        is_near(height(&scan, Some(&within), (0.05, 0.009)), 0.0);
        // The low-poly mesh has it itself.
        is_near(height(&scan, Some(&Floating::above(&both, 0.02)), (0.05, 0.001)), 0.0);
        // A step of the same surface does not float.
        is_near(height(&plate(false), Some(&far), (0.05, 0.001)), 0.0);
    }

    /// Returns a sphere with bumps as fine as its triangles, and a smaller one inside that also faces outward.
    fn rough() -> Scan {
        let mut data = MeshData::default();
        for (radius, bumps) in [(1.0, 0.02), (0.9, 0.0)] {
            let sphere = Mesh::sphere(radius, 90, 60).into_data();
            let first = data.positions.len() as u32;
            let bump = |i: usize| 1.0 + bumps * ((i * 7919 % 13) as f32 / 13.0 - 0.5);
            data.positions.extend(sphere.positions.iter().enumerate().map(|(i, p)| *p * bump(i)));
            data.triangles.extend(sphere.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        let data = SceneData {
            meshes: vec![Mesh::new(data).unwrap()],
            materials: vec![Material::default()],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        };
        Scan::new(Scene::new(data).unwrap()).unwrap()
    }

    #[test]
    fn triangles_find_what_samples_would_have_found() {
        let scan = rough();
        for (columns, rows, size) in [(6, 4, 64), (24, 12, 128), (60, 40, 64)] {
            let low = Mesh::sphere(1.0, columns, rows);
            for distance in [0.02, 0.15] {
                let cage = Cage::uniform(&low, distance).unwrap();
                let layout = Layout::new(&low, &low.uvs()[0], [size; 2], 2).unwrap();
                let (mut met, mut missed) = (0, 0);
                for band in 0..layout.band_count() {
                    layout.triangle_samples(band, |group| {
                        let corners = low.corners(group.triangle as usize);
                        let projection =
                            |weights| cage.projection_ray(&low, Point { triangle: group.triangle, weights });
                        let projections: Vec<ProjectionRay> =
                            group.samples.iter().map(|s| projection(s.weights)).collect();
                        let all = search(&scan, group, corners, &projections);
                        for (projection, found) in projections.iter().zip(all) {
                            let single = scan.project(projection);
                            // Rays of a packet are intersected in the packet's coordinates, which round differently.
                            let apart = match (single, found) {
                                (Some(a), Some(b)) => (a.height - b.height).abs(),
                                (None, None) => 0.0,
                                _ => f32::INFINITY,
                            };
                            let at_end = |m: Option<Correspondence>| {
                                m.is_some_and(|m| m.height.abs() > distance * 0.9999)
                            };
                            assert!(apart < 1e-5 || at_end(single) || at_end(found), "{single:?} {found:?}");
                            *(if found.is_some() { &mut met } else { &mut missed }) += 1;
                        }
                    });
                }
                assert!(met > 1000, "{met} met, {missed} missed");
            }
        }
    }
}
