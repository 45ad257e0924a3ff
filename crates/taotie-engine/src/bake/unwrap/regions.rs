//! The triangles of a mesh before it is cut, with their neighbours and the directions they face; and small compact
//! regions of them that face one way, from which UV islands are built.

use crate::bake::simplify::{UnitCube, morton, places};
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

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

/// Rounds of growth from improved seeds.
const ROUNDS: usize = 4;
/// The cosine of the maximum angle between a region's axis and its smooth normals: 40°.
const SMOOTH_COSINE: f64 = 0.766;
/// The same for the triangles' own normals: 70°.
const OWN_COSINE: f64 = 0.342;
/// The factor by which a path is lengthened if the surface faces elsewhere.
const DETOUR: f64 = 8.0;

/// The seed of a region: a triangle, and the axis that its triangles face.
#[derive(Clone, Copy)]
struct Seed {
    triangle: u32,
    axis: Vec3<f64>,
}

/// Returns the region of each triangle, [`NONE`] for those without area, and the number of regions.
///
/// Regions grow in parallel, nearest triangles first, as in Lloyd's method; new ones grow from triangles that none
/// reaches.
/// Source: Cohen-Steiner, Alliez and Desbrun 2004, "Variational shape approximation".
pub(super) fn regions(topology: &Topology) -> (Vec<u32>, usize) {
    let mut seeds = first_seeds(topology);
    for _ in 1..ROUNDS {
        let labels = grow(topology, &mut seeds);
        seeds = centred(topology, &labels, seeds.len());
    }
    let labels = grow(topology, &mut seeds);
    (labels, seeds.len())
}

/// Triangles at equal steps of area along a Morton curve.
fn first_seeds(topology: &Topology) -> Vec<Seed> {
    let mut order: Vec<u32> =
        (0..topology.len() as u32).filter(|t| topology.is_flat_enough(*t as usize)).collect();
    order.sort_by_key(|t| (morton(topology.centres[*t as usize].to_f32().to_array()), *t));
    let total: f64 = topology.areas.iter().sum();
    let step = total / (order.len() as f64 / 20.0).clamp(1.0, 500.0);
    let (mut seeds, mut passed) = (Vec::new(), step / 2.0);
    for t in order {
        passed += topology.areas[t as usize];
        if passed >= step {
            passed -= step;
            // A triangle larger than a step is one seed.
            passed = passed.min(step);
            seeds.push(seed_at(topology, t));
        }
    }
    seeds
}

/// Makes the seed for a triangle, with an axis that the triangle can have.
fn seed_at(topology: &Topology, triangle: u32) -> Seed {
    let t = triangle as usize;
    let smooth = topology.smooth[t];
    Seed { triangle, axis: if faces(topology, t, smooth) { smooth } else { topology.normals[t] } }
}

/// Costs in a heap: bits of a non-negative number, which sort like the number; then triangle and region.
type Claim = Reverse<(u64, u32, u32)>;

/// Grows all regions together; then, in order, new ones from triangles that none has reached.
fn grow(topology: &Topology, seeds: &mut Vec<Seed>) -> Vec<u32> {
    let mut labels = vec![NONE; topology.len()];
    let mut claims: BinaryHeap<Claim> =
        seeds.iter().enumerate().map(|(i, seed)| Reverse((0, seed.triangle, i as u32))).collect();
    flood(topology, seeds, &mut labels, &mut claims);
    for t in 0..topology.len() {
        if labels[t] == NONE && topology.is_flat_enough(t) {
            claims.push(Reverse((0, t as u32, seeds.len() as u32)));
            seeds.push(seed_at(topology, t as u32));
            flood(topology, seeds, &mut labels, &mut claims);
        }
    }
    labels
}

/// Assigns triangles to the regions that claim them at the lowest cost, until no claim is left.
fn flood(topology: &Topology, seeds: &[Seed], labels: &mut [u32], claims: &mut BinaryHeap<Claim>) {
    while let Some(Reverse((cost, triangle, label))) = claims.pop() {
        let t = triangle as usize;
        if labels[t] != NONE {
            continue;
        }
        labels[t] = label;
        let axis = seeds[label as usize].axis;
        for side in topology.neighbours[t].into_iter().filter(|side| *side != NONE) {
            let s = side as usize;
            if labels[s] == NONE && faces(topology, s, axis) {
                let away = 1.0 - topology.smooth[s].dot(axis);
                let way = (topology.centres[s] - topology.centres[t]).length() * (1.0 + DETOUR * away);
                claims.push(Reverse(((f64::from_bits(cost) + way).to_bits(), side, label)));
            }
        }
    }
}

/// Returns `true` if a triangle may belong to a region with this axis.
fn faces(topology: &Topology, triangle: usize, axis: Vec3<f64>) -> bool {
    topology.is_flat_enough(triangle)
        && topology.smooth[triangle].dot(axis) >= SMOOTH_COSINE
        && topology.normals[triangle].dot(axis) >= OWN_COSINE
}

/// Recomputes the seeds of regions, each the triangle nearest to its centre. Drops regions without a triangle.
fn centred(topology: &Topology, labels: &[u32], count: usize) -> Vec<Seed> {
    let zero = Vec3::splat(0.0);
    let mut sums = vec![(0.0, zero, zero); count];
    for (t, label) in labels.iter().enumerate().filter(|(_, label)| **label != NONE) {
        let (area, middle, axis) = &mut sums[*label as usize];
        *area += topology.areas[t];
        *middle += topology.centres[t] * topology.areas[t];
        *axis += topology.smooth[t] * topology.areas[t];
    }
    let mut best = vec![(f64::INFINITY, NONE); count];
    for (t, label) in labels.iter().enumerate().filter(|(_, label)| **label != NONE) {
        let (area, middle, axis) = sums[*label as usize];
        let axis = axis.normalize_or(topology.smooth[t]);
        let off = (topology.centres[t] - middle / area).length()
            + area.sqrt() * (1.0 - topology.smooth[t].dot(axis));
        // A triangle that could not have the axis is not chosen.
        if off < best[*label as usize].0 && (faces(topology, t, axis) || best[*label as usize].1 == NONE) {
            best[*label as usize] = (off, t as u32);
        }
    }
    let recentred = |(i, (_, seed)): (usize, &(f64, u32))| {
        let axis = sums[i].2.normalize_or(topology.smooth[*seed as usize]);
        let fits = faces(topology, *seed as usize, axis);
        if fits { Seed { triangle: *seed, axis } } else { seed_at(topology, *seed) }
    };
    best.iter().enumerate().filter(|(_, (_, seed))| *seed != NONE).map(recentred).collect()
}
