//! Small compact regions that face one way, from which UV islands are built.

use super::topology::{NONE, Topology};
use crate::bake::simplify::morton;
use crate::math::Vec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

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
