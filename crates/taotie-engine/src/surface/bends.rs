//! How a surface bends: the angles at its edges, which of them are meant to be hard, and normals split at those; and
//! the mean curvature at its vertices.

use super::connectivity::{Edge, Edges};
use super::creases::{Corner, Splitter, Spot, sorted_corners};
use super::normals::{unit, with_normals};
use super::weld::{Classes, bits};
use crate::error::Result;
use crate::groups::DisjointSets;
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, MeshData};
use crate::parallel;

/// The default crease angle of modelled shapes in degrees: between the steps of a cylinder of 16 segments, 22.5°, and
/// the chamfer of a nut, 30°.
pub const MODELLED_CREASE_DEG: f64 = 26.0;
/// Neighbours whose angle exceeds rounding errors by less than this are coplanar, in radians.
const FLAT: f64 = 3.5e-4;
/// The minimum fraction of the length of sharp edges with a flat face on at least one side in a modelled shape.
/// Measured: at least 0.91 in modelled parts; at most 0.07 in scans, and 0.37 in one with hardly any sharp edge.
const MODELLED: f64 = 0.75;
/// The fraction of edges that are neither flat nor sharp below which a shape is a polyhedron.
const POLYHEDRAL: f64 = 0.01;

/// Each open edge at a position is compared with this many others at most, which bounds the time at positions with
/// many.
const COMPARED: usize = 32;

/// A mesh with its edges, and the angle of the surface at each.
pub struct Bends<'a> {
    mesh: &'a Mesh,
    edges: Edges,
    /// The unit normal of each triangle, and the angle by which rounding may have rotated it, in radians; infinite
    /// without area.
    facets: Vec<(Vec3, f32)>,
}

/// The angles of a triangle at its edges to triangles with higher indices.
#[derive(Debug, Clone, Copy, Default)]
struct Sides {
    sharp: [bool; 3],
    /// The number of edges that are neither flat nor sharp.
    bent: u8,
    /// `true` if a neighbour with any index is coplanar.
    is_flat: bool,
}

/// Returns true if a sample of a mesh of many triangles shows that it is a scan, so that the search of all edges for
/// hard ones can be skipped. The sample consists of runs of triangles, since neighbours in a file are usually
/// neighbours in space.
pub fn looks_scanned(mesh: &Mesh) -> Result<bool> {
    const RUNS: usize = 16;
    const RUN: usize = 2048;
    let count = mesh.triangles().len();
    if count < 4 * RUNS * RUN {
        return Ok(false);
    }
    let numbers = (0..RUNS).flat_map(|run| (0..RUN).map(move |i| run * (count - RUN) / (RUNS - 1) + i));
    let positions: Vec<Vec3> = numbers.flat_map(|t| mesh.corners(t)).collect();
    let triangles = (0..(RUNS * RUN) as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let sample = Mesh::new(MeshData { positions, triangles, ..MeshData::default() })?;
    Ok(Bends::of(&sample).looks_scanned())
}

/// Returns a mesh with normals that are split at its hard edges, if it has no normals and was modelled, such as one in an STL
/// file; otherwise the same.
///
/// # Errors
/// Those of [`Mesh::new`], none of which can occur.
pub fn with_hard_edges(mesh: Mesh) -> Result<Mesh> {
    if mesh.triangles().is_empty() || !mesh.normals().is_empty() || looks_scanned(&mesh)? {
        return Ok(mesh);
    }
    let bends = Bends::of(&mesh);
    let hard = bends.modelled();
    let split = (!hard.is_empty()).then(|| bends.split_at(&hard, MODELLED_CREASE_DEG.to_radians()));
    split.unwrap_or(Ok(mesh))
}

/// Returns the unit normal of a triangle and the angle by which rounding may have rotated it, in radians.
fn facet(corners: [Vec3; 3], rounding: f64) -> (Vec3, f32) {
    let [a, b, c] = corners.map(Vec3::to_f64);
    let cross = (b - a).cross(c - a);
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    // The height over the longest side is the cross product divided by its length.
    let doubt = |normal: Vec3<f64>| (normal.to_f32(), (rounding * longest / cross.length()) as f32);
    unit(cross).map_or((Vec3::default(), f32::INFINITY), doubt)
}

impl<'a> Bends<'a> {
    /// Finds the edges of a mesh.
    pub fn of(mesh: &'a Mesh) -> Self {
        /// Four times the distance between adjacent floats, for the arithmetic before they were stored.
        const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
        let largest =
            |most: f64, p: &Vec3| p.to_array().into_iter().fold(most, |m, v| m.max(f64::from(v).abs()));
        let rounding = ROUNDING * mesh.positions().iter().fold(0.0, largest);
        let facets = parallel::collect(mesh.triangles().len(), |t| facet(mesh.corners(t), rounding));
        Self { mesh, edges: Edges::of(mesh), facets }
    }

    /// Returns the hard edges in the absence of a crease angle: those of [`MODELLED_CREASE_DEG`] or more if the shape
    /// looks modelled, and none otherwise. A shape looks modelled if its sharp edges bound flat faces, which scans do
    /// not have, or if all its faces are flat.
    pub fn modelled(&self) -> Vec<Edge> {
        let crease = MODELLED_CREASE_DEG.to_radians();
        let sides = parallel::collect(self.mesh.triangles().len(), |t| self.sides(t, crease));
        let (sharp, beside_flat) = self.sharp(&sides);
        if beside_flat > MODELLED {
            return sharp;
        }
        let bent: usize = sides.iter().map(|sides| usize::from(sides.bent)).sum();
        let is_polyhedral =
            !sharp.is_empty() && (bent as f64) < POLYHEDRAL * self.edges.iter().count() as f64;
        if is_polyhedral { sharp } else { Vec::new() }
    }

    /// Returns the sharp edges, and the fraction of their length with a flat face on at least one side.
    fn sharp(&self, sides: &[Sides]) -> (Vec<Edge>, f64) {
        let (mut sharp, mut all, mut beside_flat) = (Vec::new(), 0.0, 0.0);
        for edge in self.edges.iter().filter(|edge| sides[edge.triangle].sharp[edge.side]) {
            let length = self.length(edge);
            all += length;
            if sides[edge.triangle].is_flat || sides[edge.other].is_flat {
                beside_flat += length;
            }
            sharp.push(edge);
        }
        (sharp, if all > 0.0 { beside_flat / all } else { 0.0 })
    }

    /// Returns true if a sample of a large mesh looks like a scan: it contains neighbours, and its sharp edges have
    /// no flat faces, or hardly any face is flat. Small meshes and doubtful ones are left to [`Bends::modelled`].
    fn looks_scanned(&self) -> bool {
        /// The minimum number of sharp edges for a conclusion.
        const ENOUGH: usize = 50;
        /// The fraction of flat faces in a sample below which a mesh is a scan.
        const FLAT_FACES: usize = 20;
        let count = self.mesh.triangles().len();
        let sides = parallel::collect(count, |t| self.sides(t, MODELLED_CREASE_DEG.to_radians()));
        let (sharp, beside_flat) = self.sharp(&sides);
        let flat = sides.iter().filter(|sides| sides.is_flat).count();
        // A run may be a single row of a grid, whose triangles have two neighbours each.
        let has_neighbours = 2 * self.edges.iter().count() > count;
        let is_rough = sharp.len() >= ENOUGH && beside_flat < 0.5 * MODELLED;
        has_neighbours && (is_rough || flat * FLAT_FACES < count)
    }

    /// Returns the edges with an angle of `crease` radians or more, beyond rounding errors.
    pub fn sharper_than(&self, crease: f64) -> Vec<Edge> {
        let sides = parallel::collect(self.mesh.triangles().len(), |t| self.sides(t, crease));
        self.edges.iter().filter(|edge| sides[edge.triangle].sharp[edge.side]).collect()
    }

    /// Returns the flat face of each triangle: connected triangles without an angle between neighbours beyond rounding
    /// errors, identified by the lowest of them. Small angles may add up across a face.
    pub fn flat_faces(&self) -> Vec<u32> {
        let mut faces = DisjointSets::new(self.mesh.triangles().len());
        // Triangles without area have no plane.
        let has_area = |t: usize| self.facets[t].1.is_finite();
        let is_flat = |edge: &Edge| {
            has_area(edge.triangle) && has_area(edge.other) && self.bend(edge.triangle, edge.other) < FLAT
        };
        let flat = self.edges.iter().filter(is_flat);
        flat.for_each(|edge| faces.join(edge.triangle as u32, edge.other as u32));
        faces.into_lowest()
    }

    /// Returns the borders of flat faces, each with its face: all sides of triangles without exactly one neighbour in the
    /// same face.
    pub fn borders(&self, faces: &[u32]) -> Vec<(usize, [Vec3; 2])> {
        let mut borders = Vec::new();
        for (triangle, side) in (0..faces.len()).flat_map(|t| (0..3).map(move |side| (t, side))) {
            let face = faces[triangle];
            if self.edges.across(triangle, side).is_none_or(|other| faces[other] != face) {
                let corners = self.mesh.corners(triangle);
                borders.push((face as usize, [corners[side], corners[(side + 1) % 3]]));
            }
        }
        borders
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

    /// Returns the angle between two facets in radians, minus the possible rounding error; 0 for a facet without
    /// area.
    fn bend(&self, one: usize, other: usize) -> f64 {
        let ((one, doubt), (other, doubt_of_other)) = (self.facets[one], self.facets[other]);
        let [one, other] = [one, other].map(Vec3::to_f64);
        let doubt = f64::from(doubt) + f64::from(doubt_of_other);
        // Most facets are nearly parallel, and the series is accurate to a millionth up to 20°.
        let chord = (one - other).length();
        let angle = match chord < 0.35 {
            true => chord * (1.0 + chord * chord * (1.0 / 24.0 + chord * chord * (3.0 / 640.0))),
            false => scalar::atan2(one.cross(other).length(), one.dot(other)),
        };
        (angle - doubt).max(0.0)
    }

    /// Returns the length of an edge in model units.
    pub fn length(&self, edge: Edge) -> f64 {
        let [a, b] = self.ends(edge);
        (b - a).length()
    }

    /// Returns both ends of an edge.
    pub fn ends(&self, edge: Edge) -> [Vec3<f64>; 2] {
        let corners = self.mesh.corners(edge.triangle);
        [edge.side, (edge.side + 1) % 3].map(|k| corners[k].to_f64())
    }

    /// Returns the length of all edges between two triangles, in model units.
    pub fn total_length(&self) -> f64 {
        self.edges.iter().map(|edge| self.length(edge)).sum()
    }

    /// Returns the mesh with vertex normals split at `hard` edges, all those of `crease` radians or more. At other
    /// vertices, normals are [`vertex_normals`](super::vertex_normals), bit for bit. Copies of split vertices follow
    /// all others, and triangles keep their order.
    ///
    /// # Errors
    /// None for a validated mesh.
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

    /// Joins fans that end at open edges with an angle below the crease angle: modelled surfaces are often cut there,
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
        sorted_corners(self.mesh, &places.of, |place| is_end[place as usize])
    }
}

/// Returns the mean curvature at each vertex, in 1 / model units: above 0 if the surface bulges, 1/r on a sphere of
/// radius r.
///
/// It is half the divergence of the normals, which are interpolated linearly over each triangle: div n = Σ nᵢ · (N × eᵢ) / 2A
/// over its corners, with its normal N, its area A and the edge eᵢ opposite to the corner. A vertex gets the mean over its
/// triangles, weighted by area. Copies of a vertex with the same normal count as one, as in files that store the corners
/// of each triangle separately; edges where normals are split do not count.
/// Source: Theisel et al. 2004, "Normal based estimation of the curvature tensor for triangular meshes".
pub(crate) fn mean_curvatures(mesh: &Mesh) -> Vec<f32> {
    /// The height of a triangle, as a fraction of its longest edge, below which its normal is noise.
    const THINNEST: f64 = 1e-5;
    let key = |v: usize| [mesh.positions()[v], mesh.normals()[v]].map(|vector| bits(vector.to_array()));
    let vertices = Classes::by(mesh.positions().len(), key);
    let mut sums = vec![(0.0f64, 0.0f64); vertices.firsts.len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let corners = mesh.corners(t).map(Vec3::to_f64);
        let [a, b, c] = corners;
        // Twice the area.
        let across = (b - a).cross(c - a);
        let area = across.length();
        let longest = [b - a, c - b, a - c].into_iter().fold(0.0, |most: f64, edge| most.max(edge.dot(edge)));
        if area <= longest * THINNEST {
            continue;
        }
        let spread = |k: usize| {
            let opposite = corners[(k + 2) % 3] - corners[(k + 1) % 3];
            let normal = mesh.normals()[triangle[k] as usize].to_f64();
            normal.dot(across.cross(opposite)) / area
        };
        // Twice the area times the curvature.
        let bend = (spread(0) + spread(1) + spread(2)) / 2.0;
        for v in triangle {
            let (sum, weight) = &mut sums[vertices.of[*v as usize] as usize];
            *sum += bend;
            *weight += area;
        }
    }
    let mean = |(sum, weight): (f64, f64)| if weight > 0.0 { (sum / weight) as f32 } else { 0.0 };
    vertices.of.iter().map(|class| mean(sums[*class as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_bends_by_one_over_its_radius_and_inside_out_by_as_much_less() {
        let sphere = Mesh::sphere(1.0, 64, 32);
        let radius = 2.5;
        let scaled = |sign: f32| {
            let data = sphere.clone().into_data();
            Mesh::new(MeshData {
                positions: data.positions.iter().map(|p| *p * radius).collect(),
                normals: data.normals.iter().map(|n| *n * sign).collect(),
                tangents: Vec::new(),
                ..data
            })
            .unwrap()
        };
        for sign in [1.0, -1.0] {
            let sphere = scaled(sign);
            let curvatures = mean_curvatures(&sphere);
            for v in sphere.triangles().as_flattened() {
                let curvature = curvatures[*v as usize];
                assert!((curvature * radius * sign - 1.0).abs() < 1e-3, "{curvature}");
            }
        }
    }

    /// Triangles that store their corners separately have the curvatures of those that share vertices, to the bit.
    #[test]
    fn copies_of_a_vertex_bend_like_one() {
        let shared = Mesh::sphere(1.0, 16, 8);
        let corners = || shared.triangles().as_flattened().iter().map(|v| *v as usize);
        let soup = Mesh::new(MeshData {
            positions: corners().map(|v| shared.positions()[v]).collect(),
            normals: corners().map(|v| shared.normals()[v]).collect(),
            triangles: (0..shared.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..MeshData::default()
        })
        .unwrap();
        let (of_shared, of_soup) = (mean_curvatures(&shared), mean_curvatures(&soup));
        assert!(corners().zip(&of_soup).all(|(v, curvature)| of_shared[v].to_bits() == curvature.to_bits()));
    }

    /// A tube with a lid: the rim of the tube bends like the rest of it, and that of the flat lid not at all.
    #[test]
    fn hard_edges_do_not_bend() {
        const SIDES: u32 = 12;
        let ring = |z: f32| {
            let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(SIDES);
            (0..SIDES).map(move |i| Vec3::new(scalar::cos(angle(i)) as f32, scalar::sin(angle(i)) as f32, z))
        };
        let up = Vec3::new(0.0, 0.0, 1.0);
        let (bottom, top, lid) = (0, SIDES, 2 * SIDES);
        let side = |i: u32| {
            let next = (i + 1) % SIDES;
            [[bottom + i, bottom + next, top + next], [bottom + i, top + next, top + i]]
        };
        let fan = (1..SIDES - 1).map(|i| [lid, lid + i, lid + i + 1]);
        let mesh = Mesh::new(MeshData {
            positions: ring(0.0).chain(ring(1.0)).chain(ring(1.0)).collect(),
            normals: ring(0.0).chain(ring(0.0)).chain((0..SIDES).map(|_| up)).collect(),
            triangles: (0..SIDES).flat_map(side).chain(fan).collect(),
            ..MeshData::default()
        })
        .unwrap();
        let curvatures = mean_curvatures(&mesh);
        let (tube, lid) = curvatures.split_at(lid as usize);
        assert!(tube.iter().all(|curvature| (curvature - 0.5).abs() < 0.02), "{tube:?}");
        assert!(lid.iter().all(|curvature| curvature.abs() < 1e-6), "{lid:?}");
    }
}
