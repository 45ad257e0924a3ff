//! The bends of a surface at its edges: which of them are meant to be hard, and normals that part there.

use super::angles::unit;
use super::creases::{Corner, Splitter, Spot};
use super::edges::{Edge, Edges};
use super::normals::with_normals;
use crate::error::Result;
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, MeshData};
use crate::parallel;

/// The crease angle that is chosen for modelled shapes, degrees: between the steps of a cylinder of 16 segments, 22.5°,
/// and the chamfer of a nut, 30°.
pub(crate) const MODELLED_CREASE_DEG: f64 = 26.0;
/// Neighbours that bend by less than this beyond rounding lie in one plane, radians.
const FLAT: f64 = 3.5e-4;
/// The share of the length of sharp edges that has a flat face on at least one side in a modelled shape. Measured:
/// at least 0.91 in modelled parts; at most 0.07 in scans, and 0.37 in one with hardly any sharp edge.
const MODELLED: f64 = 0.75;
/// The share of edges that are neither flat nor sharp below which a shape is a polyhedron.
const POLYHEDRAL: f64 = 0.01;

/// Open edges at a position are each compared with this many others, so that a position with many of them does not take
/// long.
const COMPARED: usize = 32;

/// A mesh with its edges, and how far the surface bends at each.
pub(crate) struct Bends<'a> {
    mesh: &'a Mesh,
    edges: Edges,
    /// The distance by which rounding may have moved a corner, model units.
    rounding: f64,
}

/// The bends of a triangle at those of its edges that lead to triangles with higher numbers.
#[derive(Debug, Clone, Copy, Default)]
struct Sides {
    sharp: [bool; 3],
    /// The number of edges that are neither flat nor sharp.
    bent: u8,
    /// `true` if a neighbour, whatever its number, lies in the same plane.
    is_flat: bool,
}

impl<'a> Bends<'a> {
    /// Finds the edges of a mesh.
    pub fn of(mesh: &'a Mesh) -> Self {
        /// Four times the distance between neighbouring numbers, for the arithmetic before they were stored.
        const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
        let largest =
            |most: f64, p: &Vec3| p.to_array().into_iter().fold(most, |m, v| m.max(f64::from(v).abs()));
        let rounding = ROUNDING * mesh.positions().iter().fold(0.0, largest);
        Self { mesh, edges: Edges::of(mesh), rounding }
    }

    /// Returns the edges that are hard where no crease angle is given: those of [`MODELLED_CREASE_DEG`] or more if the
    /// shape looks modelled, and none otherwise. A shape looks modelled if its sharp edges bound flat faces, which scans
    /// do not have, or if it consists of flat faces alone.
    pub fn modelled(&self) -> Vec<Edge> {
        let crease = MODELLED_CREASE_DEG.to_radians();
        let sides = parallel::collect(self.mesh.triangles().len(), |t| self.sides(t, crease));
        let (mut sharp, mut all, mut beside_flat) = (Vec::new(), 0.0, 0.0);
        for edge in self.edges.iter().filter(|edge| sides[edge.triangle].sharp[edge.side]) {
            let length = self.length(edge);
            all += length;
            beside_flat +=
                if sides[edge.triangle].is_flat || sides[edge.other].is_flat { length } else { 0.0 };
            sharp.push(edge);
        }
        if beside_flat > MODELLED * all {
            return sharp;
        }
        let bent: usize = sides.iter().map(|sides| usize::from(sides.bent)).sum();
        let is_polyhedral =
            !sharp.is_empty() && (bent as f64) < POLYHEDRAL * self.edges.iter().count() as f64;
        if is_polyhedral { sharp } else { Vec::new() }
    }

    /// Returns the edges at which the surface bends by `crease` radians or more, beyond rounding.
    pub fn sharper_than(&self, crease: f64) -> Vec<Edge> {
        let sides = parallel::collect(self.mesh.triangles().len(), |t| self.sides(t, crease));
        self.edges.iter().filter(|edge| sides[edge.triangle].sharp[edge.side]).collect()
    }

    fn sides(&self, triangle: usize, crease: f64) -> Sides {
        let mut sides = Sides::default();
        for side in 0..3 {
            let Some(other) = self.edges.across(triangle, side) else { continue };
            let bend = self.bend(triangle, other);
            sides.is_flat |= bend < FLAT;
            sides.sharp[side] = other > triangle && bend >= crease;
            sides.bent += u8::from(other > triangle && (FLAT..crease).contains(&bend));
        }
        sides
    }

    /// Returns the angle between two facets, radians, less what rounding may have added; 0 for a facet without area.
    fn bend(&self, one: usize, other: usize) -> f64 {
        let [Some((one, doubt)), Some((other, doubt_of_other))] = [one, other].map(|t| self.facet(t)) else {
            return 0.0;
        };
        let angle = scalar::atan2(one.cross(other).length(), one.dot(other));
        (angle - doubt - doubt_of_other).max(0.0)
    }

    /// Returns the unit normal of a triangle and the angle by which rounding may have turned it, radians.
    fn facet(&self, triangle: usize) -> Option<(Vec3<f64>, f64)> {
        let [a, b, c] = self.mesh.corners(triangle).map(Vec3::to_f64);
        let cross = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        // The height over the longest side is its cross product by its length.
        Some((unit(cross)?, self.rounding * longest / cross.length()))
    }

    /// Returns the length of an edge, model units.
    pub fn length(&self, edge: Edge) -> f64 {
        let [a, b] = self.ends(edge);
        (b - a).length()
    }

    /// Returns both ends of an edge.
    pub fn ends(&self, edge: Edge) -> [Vec3<f64>; 2] {
        let corners = self.mesh.corners(edge.triangle);
        [edge.side, (edge.side + 1) % 3].map(|k| corners[k].to_f64())
    }

    /// Returns the length of all edges at which two triangles meet, model units.
    pub fn total_length(&self) -> f64 {
        self.edges.iter().map(|edge| self.length(edge)).sum()
    }

    /// Returns the mesh with vertex normals that part at `hard` edges, all those of `crease` radians or more. At vertices
    /// away from them normals are [`vertex_normals`](super::vertex_normals), to the bit. Copies of split vertices come
    /// after all others, and triangles keep their order.
    ///
    /// # Errors
    /// None can happen to a mesh that was checked.
    pub fn split_at(&self, hard: &[Edge], crease: f64) -> Result<Mesh> {
        let bare = MeshData { normals: Vec::new(), ..self.mesh.clone().into_data() };
        let smooth = with_normals(&Mesh::new(bare)?)?.into_owned();
        let places = &self.edges.places.of;
        let corners = self.corners_at(hard);
        let mut splitter = Splitter::new(smooth.clone().into_data());
        for around in corners.chunk_by(|a, b| a.place == b.place) {
            let spot = Spot::new(&smooth, places, around);
            let fans = spot.fans(|i, j| self.is_smooth(&around[i], &around[j], crease));
            let fans = self.joined_at_gaps(around, fans, crease);
            for (corner, (group, normal)) in around.iter().zip(spot.normals(fans)) {
                splitter.set(corner, group, normal);
            }
        }
        splitter.into_mesh()
    }

    fn is_smooth(&self, one: &Corner, other: &Corner, crease: f64) -> bool {
        self.bend(one.triangle as usize, other.triangle as usize) < crease
    }

    /// Joins fans that end at open edges and bend by less than the crease angle: modelled surfaces are often cut there,
    /// with a vertex in the middle of a neighbour's edge.
    fn joined_at_gaps(&self, around: &[Corner], mut fans: Vec<u32>, crease: f64) -> Vec<u32> {
        let is_open = |corner: &Corner| {
            let k = usize::from(corner.number);
            [k, (k + 2) % 3].iter().any(|side| self.edges.across(corner.triangle as usize, *side).is_none())
        };
        let open: Vec<usize> = (0..around.len()).filter(|i| is_open(&around[*i])).collect();
        for (n, i) in open.iter().enumerate() {
            for j in open[n + 1..].iter().take(COMPARED) {
                let [one, other] = [fans[*i], fans[*j]];
                if one != other && self.is_smooth(&around[*i], &around[*j], crease) {
                    let (low, high) = (one.min(other), one.max(other));
                    fans.iter_mut().filter(|fan| **fan == high).for_each(|fan| *fan = low);
                }
            }
        }
        fans
    }

    /// Returns all corners at the ends of some edges, sorted.
    fn corners_at(&self, hard: &[Edge]) -> Vec<Corner> {
        let places = &self.edges.places;
        let mut is_end = vec![false; places.firsts.len()];
        hard.iter().for_each(|edge| {
            self.edges.ends(self.mesh, *edge).iter().for_each(|p| is_end[*p as usize] = true)
        });
        let mut corners = Vec::new();
        for (triangle, vertices) in (0u32..).zip(self.mesh.triangles()) {
            for (number, vertex) in (0u8..).zip(vertices) {
                let place = places.of[*vertex as usize];
                if is_end[place as usize] {
                    corners.push(Corner { place, triangle, number });
                }
            }
        }
        corners.sort_unstable();
        corners
    }
}
