//! Shortens borders between UV islands.

use super::merge::Limits;
use super::topology::{NONE, Topology};
use crate::math::Vec3;

/// The number of passes over all triangles.
const ROUNDS: usize = 4;

/// Moves triangles that stick into another UV island to that island, if they face its axis well enough. UV islands
/// stay connected: a triangle that is moved is attached to its old UV island by at most one edge.
pub(super) fn shorten(topology: &Topology, labels: &mut [u32], axes: &[Vec3<f64>], limits: &Limits) {
    for _ in 0..ROUNDS {
        for t in 0..labels.len() {
            if let Some(better) = better(topology, labels, t) {
                let axis = axes[better as usize];
                let [smooth, own] = [topology.smooth[t], topology.normals[t]].map(|n| n.dot(axis));
                if smooth >= limits.smooth && own >= limits.own {
                    labels[t] = better;
                }
            }
        }
    }
}

/// Returns the UV island with which a triangle has a longer border than with its own.
fn better(topology: &Topology, labels: &[u32], t: usize) -> Option<u32> {
    let adjacent = topology.neighbours[t].map(|side| if side == NONE { NONE } else { labels[side as usize] });
    let own = labels[t];
    if own == NONE || adjacent.iter().filter(|label| **label == own).count() > 1 {
        return None;
    }
    let length =
        |label: u32| -> f64 { (0..3).filter(|k| adjacent[*k] == label).map(|k| topology.edge(t, k)).sum() };
    let others = adjacent.into_iter().filter(|label| *label != NONE && *label != own);
    let best = others.max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    (length(best) > length(own)).then_some(best)
}
