//! Splits vertices at creases: where a common normal would leave some facet facing away from it, and where the
//! normals of neighbouring facets diverge.

use super::normals::{corner_angles, facet_normal, unit, with_normals};
use super::weld;
use crate::error::Result;
use crate::groups::DisjointSets;
use crate::math::Vec3;
use crate::mesh::{Mesh, MeshData};
use crate::parallel;
use std::collections::BTreeMap;

/// The minimum cosine between a facet and the normals at its corners.
const LEAST: f64 = 0.1;
/// The minimum cosine between neighbours in one fan: that of about 73°.
const SMOOTH: f64 = 0.3;
/// The minimum cosine between a cone's axis and its facets: that of 40°. Two of them differ by 80° at most, so the
/// mean of all has a cosine of 0.17 or more to each, above [`LEAST`].
const CONE: f64 = 0.767;
/// A facet with a smaller fraction of the area around a position is narrow there.
const NARROW: f64 = 0.2;
/// Each facet at an edge is compared with this many after it, which bounds the time at an edge of many facets.
const COMPARED: usize = 8;

/// Returns the mesh with normals from which no facet faces away: each has a cosine of at least 0.1 to the normals at
/// its corners. Narrow facets folded over on a continuous surface are ignored, since their neighbours are better
/// evidence of the outward direction.
///
/// Otherwise, the facets around that position are sorted into fans across edges of less than 73°, and each fan takes
/// the mean of its facets, weighted by their angles. A fan that winds back on itself is sorted into cones of 40°
/// instead. Vertices are split between fans; the copies follow all other vertices, and triangles keep their order.
/// Elsewhere, not a bit changes. Missing normals are [`vertex_normals`](super::vertex_normals). Tangents are dropped
/// if a normal changed.
///
/// # Errors
/// None for a validated mesh.
pub fn creased(mesh: &Mesh) -> Result<Mesh> {
    let mesh = with_normals(mesh)?.into_owned();
    let turned = turned_facets(&mesh);
    if turned.is_empty() {
        return Ok(mesh);
    }
    let places = weld::by_position(mesh.positions()).of;
    let corners = corners_at_creases(&mesh, &places, &turned);
    let mut splitter = Splitter::new(mesh.clone().into_data());
    for around in corners.chunk_by(|a, b| a.place == b.place) {
        let spot = Spot::new(&mesh, &places, around);
        let fans = spot.fans(|i, j| is_smooth(spot.parts[i], spot.parts[j]));
        if spot.is_folded(&fans) {
            continue;
        }
        for (corner, (group, normal)) in around.iter().zip(spot.normals(fans)) {
            splitter.set(corner, group, normal);
        }
    }
    splitter.into_mesh()
}

/// Returns true if more than a hundredth of the facets face away from a normal at their corners: more than remain
/// folded in a [`creased`] mesh.
pub(crate) fn has_turned_facets(mesh: &Mesh) -> bool {
    let count = mesh.triangles().len();
    !mesh.normals().is_empty() && parallel::count(count, |t| is_turned(mesh, t)) * 100 > count
}

fn turned_facets(mesh: &Mesh) -> Vec<usize> {
    parallel::filter(mesh.triangles().len(), |t| is_turned(mesh, t))
}

fn is_turned(mesh: &Mesh, t: usize) -> bool {
    (0..3).any(|k| is_turned_at(mesh, t, k))
}

fn is_turned_at(mesh: &Mesh, t: usize, k: usize) -> bool {
    let normal = mesh.normals()[mesh.triangles()[t][k] as usize];
    facet_normal(mesh.corners(t)).is_some_and(|facet| facet.to_f64().dot(normal.to_f64()) < LEAST)
}

/// The normals of neighbouring facets diverge at a vertex if they differ by more than 45°, and the facets by more
/// than 25°.
const SAME_NORMAL: f32 = 0.707;
const SAME_FACET: f32 = 0.906;

/// Splits the vertices of a mesh where the unit normals in `corners`, one per corner of each triangle, diverge across
/// an edge. Each side gets the mean of its normals; all other vertices keep theirs. Tangents are dropped.
///
/// # Errors
/// None for a validated mesh.
///
/// # Panics
/// If the mesh has no normals, or there are fewer corners than triangles.
pub(crate) fn parted(mesh: &Mesh, corners: &[[Vec3; 3]]) -> Result<Mesh> {
    let places = weld::by_position(mesh.positions()).of;
    let corners_around = sorted_corners(mesh, &places, |_| true);
    let normal = |corner: &Corner| corners[corner.triangle as usize][usize::from(corner.number)];
    let facet = |corner: &Corner| facet_normal(mesh.corners(corner.triangle as usize));
    let is_smooth = |a: &Corner, b: &Corner| {
        let bend = facet(a).zip(facet(b)).map_or(1.0, |(a, b)| a.dot(b));
        bend > SAME_FACET || normal(a).dot(normal(b)) > SAME_NORMAL
    };
    let mut splitter = Splitter::new(mesh.clone().into_data());
    for around in corners_around.chunk_by(|a, b| a.place == b.place) {
        let fans = Spot::new(mesh, &places, around).fans(|i, j| is_smooth(&around[i], &around[j]));
        if fans.iter().all(|fan| *fan == fans[0]) {
            continue;
        }
        let mean = |fan: u32| {
            let own = around.iter().zip(&fans).filter(|(_, other)| **other == fan);
            own.fold(Vec3::splat(0.0), |sum, (corner, _)| sum + normal(corner))
        };
        for (corner, fan) in around.iter().zip(&fans) {
            splitter.set(corner, *fan, mean(*fan).normalize_or(normal(corner)));
        }
    }
    splitter.into_mesh()
}

/// A corner of a triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Corner {
    /// Equal for all vertices at one position.
    pub place: u32,
    pub triangle: u32,
    /// 0 to 2.
    pub number: u8,
}

/// Returns all corners at the positions where a facet faces away, sorted.
fn corners_at_creases(mesh: &Mesh, places: &[u32], turned: &[usize]) -> Vec<Corner> {
    let mut is_crease = vec![false; mesh.positions().len()];
    for t in turned {
        for k in (0..3).filter(|k| is_turned_at(mesh, *t, *k)) {
            is_crease[places[mesh.triangles()[*t][k] as usize] as usize] = true;
        }
    }
    sorted_corners(mesh, places, |place| is_crease[place as usize])
}

/// Returns all corners at the requested positions, grouped by position. `places` is the position index of each
/// vertex.
pub(super) fn sorted_corners(mesh: &Mesh, places: &[u32], is_wanted: impl Fn(u32) -> bool) -> Vec<Corner> {
    let mut corners = Vec::new();
    for (triangle, vertices) in (0u32..).zip(mesh.triangles()) {
        for (number, vertex) in (0u8..).zip(vertices) {
            let place = places[*vertex as usize];
            if is_wanted(place) {
                corners.push(Corner { place, triangle, number });
            }
        }
    }
    corners.sort_unstable();
    corners
}

/// A position with all corners around it.
pub(super) struct Spot<'a> {
    mesh: &'a Mesh,
    places: &'a [u32],
    around: &'a [Corner],
    /// For each corner; `None` if its facet has no area.
    parts: Vec<Option<Part>>,
}

/// The contribution of a corner to the normal of its group.
#[derive(Clone, Copy)]
struct Part {
    /// Unit.
    facet: Vec3<f64>,
    /// Radians.
    angle: f64,
}

impl Part {
    fn of(mesh: &Mesh, corner: &Corner) -> Option<Self> {
        let corners = mesh.corners(corner.triangle as usize).map(Vec3::to_f64);
        let [a, b, c] = corners;
        let facet = unit((b - a).cross(c - a))?;
        Some(Self { facet, angle: corner_angles(corners)[usize::from(corner.number)] })
    }
}

/// A connected group of facets at a position.
#[derive(Clone, Copy, Default)]
struct Fan {
    facets: usize,
    /// Twice the area.
    area: f64,
    /// `true` if one of them faces away from its normal.
    turned: bool,
}

impl<'a> Spot<'a> {
    pub fn new(mesh: &'a Mesh, places: &'a [u32], around: &'a [Corner]) -> Self {
        Self { mesh, places, around, parts: around.iter().map(|corner| Part::of(mesh, corner)).collect() }
    }

    /// Returns true if all facets that face away are narrow and isolated, next to a continuous surface:
    /// simplification folded them over, and the surface is better evidence of the outward direction.
    fn is_folded(&self, fan_of: &[u32]) -> bool {
        let mut fans = vec![Fan::default(); self.around.len()];
        for (corner, fan) in self.around.iter().zip(fan_of) {
            let [a, b, c] = self.mesh.corners(corner.triangle as usize).map(Vec3::to_f64);
            let fan = &mut fans[*fan as usize];
            fan.facets += 1;
            fan.area += (b - a).cross(c - a).length();
            fan.turned |= is_turned_at(self.mesh, corner.triangle as usize, usize::from(corner.number));
        }
        let area: f64 = fans.iter().map(|fan| fan.area).sum();
        let is_narrow = |fan: &Fan| fan.facets == 1 && fan.area < NARROW * area;
        fans.iter().any(|fan| fan.facets >= 3) && fans.iter().filter(|fan| fan.turned).all(is_narrow)
    }

    /// Returns the group of each corner, formed from these fans, and the group's normal. Facets without area keep
    /// their previous normal.
    pub fn normals(&self, fans: Vec<u32>) -> Vec<(u32, Vec3)> {
        let (groups, parts) = (self.groups(fans), &self.parts);
        let mut sums = vec![Vec3::<f64>::splat(0.0); self.around.len()];
        for (part, group) in parts.iter().zip(&groups) {
            sums[*group as usize] += part.map_or(Vec3::splat(0.0), |part| part.facet * part.angle);
        }
        let old = |i: usize| self.mesh.normals()[self.vertex(&self.around[i]) as usize];
        let normal = |i: usize| match (unit(sums[groups[i] as usize]), parts[groups[i] as usize]) {
            (Some(mean), _) => mean.to_f32(),
            (None, Some(first)) => first.facet.to_f32(),
            (None, None) => old(i),
        };
        (0..groups.len()).map(|i| (groups[i], normal(i))).collect()
    }

    fn vertex(&self, corner: &Corner) -> u32 {
        self.mesh.triangles()[corner.triangle as usize][usize::from(corner.number)]
    }

    /// Returns the group of each corner, as the index of one of its corners: its fan, sorted into cones if it winds
    /// back.
    fn groups(&self, mut fans: Vec<u32>) -> Vec<u32> {
        for fan in members(&fans) {
            if winds_back(&fan, &self.parts) {
                sort_into_cones(fan, &self.parts, &mut fans);
            }
        }
        fans
    }

    /// Returns for each corner the first one of its fan, which continues across edges whose facets are joined by
    /// `is_smooth`, called with the indices of their corners.
    pub fn fans(&self, is_smooth: impl Fn(usize, usize) -> bool) -> Vec<u32> {
        let mut fans = DisjointSets::new(self.around.len());
        let edges = self.edges();
        for edge in edges.chunk_by(|a, b| a.0 == b.0) {
            for (i, (_, one)) in edge.iter().enumerate() {
                for (_, other) in edge[i + 1..].iter().take(COMPARED) {
                    if is_smooth(*one as usize, *other as usize) {
                        fans.join(*one, *other);
                    }
                }
            }
        }
        fans.into_lowest()
    }

    /// Returns the edges that end here: the position of their other end and an adjacent corner, sorted.
    fn edges(&self) -> Vec<(u32, u32)> {
        let mut edges = Vec::with_capacity(2 * self.around.len());
        for (i, corner) in (0u32..).zip(self.around) {
            let vertices = self.mesh.triangles()[corner.triangle as usize];
            for step in [1, 2] {
                edges.push((self.places[vertices[(usize::from(corner.number) + step) % 3] as usize], i));
            }
        }
        edges.sort_unstable();
        edges
    }
}

fn is_smooth(one: Option<Part>, other: Option<Part>) -> bool {
    one.zip(other).is_some_and(|(one, other)| one.facet.dot(other.facet) > SMOOTH)
}

/// Returns the corners of each group that has more than one.
fn members(groups: &[u32]) -> Vec<Vec<u32>> {
    let mut members: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (i, group) in (0u32..).zip(groups) {
        members.entry(*group).or_default().push(i);
    }
    members.into_values().filter(|group| group.len() > 1).collect()
}

/// Returns true if a facet of a fan faces away from the fan's mean.
fn winds_back(fan: &[u32], parts: &[Option<Part>]) -> bool {
    let own: Vec<Part> = fan.iter().filter_map(|i| parts[*i as usize]).collect();
    let sum = own.iter().fold(Vec3::<f64>::splat(0.0), |sum, part| sum + part.facet * part.angle);
    // Slightly above the minimum, since normals are rounded.
    unit(sum).is_none_or(|mean| own.iter().any(|part| part.facet.dot(mean) < LEAST + 1e-3))
}

/// Sorts the corners of a fan into cones, each around the remaining facet with the widest angle.
fn sort_into_cones(mut fan: Vec<u32>, parts: &[Option<Part>], groups: &mut [u32]) {
    let angle = |i: u32| parts[i as usize].map_or(0.0, |part| part.angle);
    fan.sort_by(|a, b| angle(*b).total_cmp(&angle(*a)).then(a.cmp(b)));
    while let Some(seed) = fan.first().copied() {
        let is_near = |i: u32| {
            i == seed
                || parts[seed as usize]
                    .zip(parts[i as usize])
                    .is_some_and(|(axis, part)| axis.facet.dot(part.facet) >= CONE)
        };
        fan.iter().filter(|i| is_near(**i)).for_each(|i| groups[*i as usize] = seed);
        fan.retain(|i| !is_near(*i));
    }
}

/// Splits vertices between groups.
pub(super) struct Splitter {
    data: MeshData,
    /// The new vertex for an old one in a group.
    numbers: BTreeMap<(u32, u32), u32>,
}

impl Splitter {
    /// Starts from a mesh with normals. Its tangents are dropped.
    pub fn new(data: MeshData) -> Self {
        Self { data: MeshData { tangents: Vec::new(), ..data }, numbers: BTreeMap::new() }
    }

    /// Returns the mesh with split vertices.
    ///
    /// # Errors
    /// None for a validated mesh.
    pub fn into_mesh(self) -> Result<Mesh> {
        Mesh::new(self.data)
    }

    /// Gives a corner the normal of its group.
    pub fn set(&mut self, corner: &Corner, group: u32, normal: Vec3) {
        let Corner { triangle, number, .. } = *corner;
        let old = self.data.triangles[triangle as usize][usize::from(number)];
        let new = match self.numbers.get(&(old, group)) {
            Some(new) => *new,
            None => self.split(old, group),
        };
        self.data.normals[new as usize] = normal;
        self.data.triangles[triangle as usize][usize::from(number)] = new;
    }

    /// Returns the vertex for another group: the old one itself for the first.
    fn split(&mut self, old: u32, group: u32) -> u32 {
        let is_first = self.numbers.range((old, 0)..=(old, u32::MAX)).next().is_none();
        let new = if is_first { old } else { self.copied(old as usize) };
        self.numbers.insert((old, group), new);
        new
    }

    fn copied(&mut self, old: usize) -> u32 {
        fn copy<T: Copy>(values: &mut Vec<T>, old: usize) {
            if let Some(value) = values.get(old).copied() {
                values.push(value);
            }
        }
        copy(&mut self.data.positions, old);
        copy(&mut self.data.normals, old);
        copy(&mut self.data.colors, old);
        self.data.uvs.iter_mut().for_each(|uvs| copy(uvs, old));
        self.data.positions.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;
    use crate::surface::vertex_normals;

    fn bare(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
    }

    fn check(mesh: &Mesh) {
        for t in 0..mesh.triangles().len() {
            let facet = facet_normal(mesh.corners(t)).unwrap().to_f64();
            for v in mesh.triangles()[t] {
                let normal = mesh.normals()[v as usize].to_f64();
                assert!(facet.dot(normal) >= LEAST && (normal.length() - 1.0).abs() < 1e-6, "{t}");
            }
        }
        assert!(!has_turned_facets(mesh));
    }

    #[test]
    fn a_smooth_surface_keeps_every_bit() {
        let ball = bare(
            Mesh::sphere(1.0, 40, 20).positions().to_vec(),
            Mesh::sphere(1.0, 40, 20).triangles().to_vec(),
        );
        let found = creased(&ball).unwrap();
        assert_eq!(found.normals(), vertex_normals(&ball));
        assert_eq!((found.positions(), found.triangles()), (ball.positions(), ball.triangles()));
    }

    /// Two long facets that meet at an edge of a few degrees: their mean points along both.
    #[test]
    fn the_sides_of_a_blade_part() {
        let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let positions = vec![p(0.0, 0.0, 0.0), p(0.0, 1.0, 0.0), p(1.0, 0.5, 0.02), p(1.0, 0.5, -0.02)];
        let blade = bare(positions, vec![[1, 0, 2], [0, 1, 3]]);
        assert!(has_turned_facets(&with_normals(&blade).unwrap()), "otherwise nothing is tested");
        let found = creased(&blade).unwrap();
        check(&found);
        assert_eq!(found.positions().len(), 6, "the two corners of the edge are split");
        assert_eq!(found.positions()[4..], [found.positions()[0], found.positions()[1]]);
    }

    #[test]
    fn both_sides_of_one_triangle_part() {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let found =
            creased(&bare(vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0)], vec![[0, 1, 2], [0, 2, 1]])).unwrap();
        check(&found);
        assert_eq!(found.positions().len(), 6);
    }

    /// The tip of a needle, whose facets differ by 30°: one fan goes all the way around it.
    #[test]
    fn a_fan_that_winds_back_is_cut() {
        let at = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / 12.0;
            Vec3::new(1.0, 0.02 * scalar::cos(angle), 0.02 * scalar::sin(angle)).to_f32()
        };
        let positions = std::iter::once(Vec3::default()).chain((0..12).map(at)).collect();
        let needle = bare(positions, (0..12).map(|i| [0, 1 + i, 1 + (i + 1) % 12]).collect());
        let found = creased(&needle).unwrap();
        check(&found);
        assert_eq!(found.triangles().len(), 12);
        let copies = found.positions().len() - needle.positions().len();
        assert!((3..12).contains(&copies), "cones, not individual facets: {copies}");
    }

    #[test]
    fn uvs_and_colours_go_with_the_copies() {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let mut data =
            bare(vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0)], vec![[0, 1, 2], [0, 2, 1]]).into_data();
        data.colors = vec![[0.1; 4], [0.2; 4], [0.3; 4]];
        data.uvs = vec![[0.0, 0.5, 1.0].map(|u| crate::math::Vec2::new(u, u)).to_vec()];
        let found = creased(&Mesh::new(data).unwrap()).unwrap();
        for (v, p) in found.positions().iter().enumerate() {
            let first = found.positions().iter().position(|q| q == p).unwrap();
            assert_eq!(found.colors()[v], found.colors()[first]);
            assert_eq!(found.uvs()[0][v], found.uvs()[0][first]);
        }
    }

    /// Two squares that share an edge, the second one turned up by an angle in degrees, with smooth normals.
    fn book(degrees: f64) -> Mesh {
        let (sin, cos) = {
            let angle = degrees.to_radians();
            (crate::math::scalar::sin(angle) as f32, crate::math::scalar::cos(angle) as f32)
        };
        let [left, spine, right] = [[-1.0, 0.0], [0.0, 0.0], [cos, sin]];
        let at = |[x, z]: [f32; 2]| [0.0, 1.0].map(|y| Vec3::new(x, y, z));
        let positions = [left, spine, right].into_iter().flat_map(at).collect();
        let triangles = vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
        with_normals(&Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap())
            .unwrap()
            .into_owned()
    }

    /// The normals of the facets at all their corners.
    fn flat(mesh: &Mesh) -> Vec<[Vec3; 3]> {
        (0..mesh.triangles().len()).map(|t| [facet_normal(mesh.corners(t)).unwrap(); 3]).collect()
    }

    #[test]
    fn an_edge_is_hard_where_normals_part_and_facets_bend() {
        let sharp = book(60.0);
        let split = parted(&sharp, &flat(&sharp)).unwrap();
        assert_eq!((sharp.positions().len(), split.positions().len()), (6, 8));
        for (t, facet) in flat(&sharp).iter().enumerate() {
            let normals = split.triangles()[t].map(|v| split.normals()[v as usize]);
            assert!(normals.iter().all(|normal| normal.dot(facet[0]) > 0.999), "{t}");
        }
        // A round spine has the same normal on both sides, a shallow one hardly a different one.
        let round = vec![[Vec3::new(0.0, 0.0, 1.0); 3]; 4];
        assert_eq!(parted(&sharp, &round).unwrap().positions().len(), 6);
        let shallow = book(40.0);
        assert_eq!(parted(&shallow, &flat(&shallow)).unwrap().positions().len(), 6);
    }
}
