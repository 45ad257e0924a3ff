//! The topology of a mesh before it is cut: triangles, their neighbours and the directions they face.

use crate::bake::simplify::{UnitCube, places};
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use rayon::prelude::*;

/// Marks the absence of a triangle or a UV island.
pub(super) const NONE: u32 = u32::MAX;
/// Triangles scaled into the unit cube, with their neighbours.
pub(super) struct Topology {
    pub corners: Vec<[Vec3<f64>; 3]>,
    /// The triangle across the edges from corner 0 to 1, 1 to 2 and 2 to 0, if it is the only one and runs along the
    /// edge in the other direction; else [`NONE`].
    pub neighbours: Vec<[u32; 3]>,
    pub areas: Vec<f64>,
    /// Unit, or zero without an area.
    pub normals: Vec<Vec3<f64>>,
    /// Normals averaged over the surroundings, so that relief does not obscure the direction the surface faces; zero
    /// if nothing around has an area.
    pub smooth: Vec<Vec3<f64>>,
    pub centres: Vec<Vec3<f64>>,
}

impl Topology {
    pub fn new(mesh: &Mesh) -> Self {
        let cube = UnitCube::of(mesh.positions());
        let places = places(mesh.positions());
        let on_places: Vec<[u32; 3]> =
            mesh.triangles().iter().map(|t| t.map(|v| places[v as usize])).collect();
        let corners: Vec<[Vec3<f64>; 3]> =
            (0..on_places.len()).map(|t| mesh.corners(t).map(|p| cube.unit(p))).collect();
        let vectors: Vec<Vec3<f64>> =
            corners.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a) * 0.5).collect();
        let areas: Vec<f64> = vectors.iter().map(|v| v.length()).collect();
        let unit = |v: &Vec3<f64>| v.normalize_or(Vec3::splat(0.0));
        let mut topology = Self {
            neighbours: neighbours(&on_places),
            areas,
            normals: vectors.iter().map(unit).collect(),
            smooth: Vec::new(),
            centres: corners.iter().map(|[a, b, c]| (*a + *b + *c) / 3.0).collect(),
            corners,
        };
        topology.smooth = topology.smoothed(vectors);
        topology
    }

    /// Returns the number of triangles.
    pub fn len(&self) -> usize {
        self.areas.len()
    }

    /// Returns `true` if a triangle can be laid out at all.
    pub fn is_flat_enough(&self, triangle: usize) -> bool {
        self.areas[triangle] > 1e-18
    }

    /// Returns the length of the edge from a corner to the next.
    pub fn edge(&self, triangle: usize, corner: usize) -> f64 {
        (self.corners[triangle][(corner + 1) % 3] - self.corners[triangle][corner]).length()
    }

    /// Returns the mean normals over surroundings whose width is about the same fraction of any model.
    fn smoothed(&self, mut vectors: Vec<Vec3<f64>>) -> Vec<Vec3<f64>> {
        let rounds = ((self.len() as f64).sqrt() / 25.0).clamp(2.0, 24.0) as usize;
        for _ in 0..rounds {
            let mean = |t: usize| {
                let around = self.neighbours[t].iter().filter(|s| **s != NONE).map(|s| vectors[*s as usize]);
                let mut sum = vectors[t];
                let mut count = 1.0;
                for vector in around {
                    sum += vector;
                    count += 1.0;
                }
                sum / count
            };
            vectors = parallel::collect(self.len(), mean);
        }
        let zero = Vec3::splat(0.0);
        vectors
            .into_iter()
            .zip(&self.normals)
            .map(|(v, n)| v.normalize_or(*n))
            .map(|v| if v.dot(v) > 0.5 { v } else { zero })
            .collect()
    }
}

/// An edge of a triangle: its two vertices in order, and three times the triangle plus the corner that it starts
/// from.
type Edge = (u32, u32, u32);

fn neighbours(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let ends = |half: u32| {
        let [triangle, corner] = [half as usize / 3, half as usize % 3];
        (triangles[triangle][corner], triangles[triangle][(corner + 1) % 3])
    };
    let edge = |half: u32| {
        let (a, b) = ends(half);
        (a != b).then_some((a.min(b), a.max(b), half))
    };
    let mut edges: Vec<Edge> = (0..3 * triangles.len() as u32).filter_map(edge).collect();
    edges.par_sort_unstable();
    let mut neighbours = vec![[NONE; 3]; triangles.len()];
    for around in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let [(_, _, one), (_, _, other)] = *around else { continue };
        if ends(one) != ends(other) && one / 3 != other / 3 {
            neighbours[one as usize / 3][one as usize % 3] = other / 3;
            neighbours[other as usize / 3][other as usize % 3] = one / 3;
        }
    }
    neighbours
}
