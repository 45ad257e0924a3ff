//! Borders between UV islands made shorter.

use super::merge::Limits;
use super::topology::{NONE, Topology};
use crate::math::Vec3;

/// The number of times that all triangles are looked at.
const ROUNDS: usize = 4;

/// Gives triangles that stick into another UV island to it, where it sees them well enough. UV islands stay connected:
/// what is given away hangs on its UV island by one edge at most.
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

/// Returns the UV island that a triangle has a longer border with than with its own.
fn better(topology: &Topology, labels: &[u32], t: usize) -> Option<u32> {
    let beside = topology.neighbours[t].map(|side| if side == NONE { NONE } else { labels[side as usize] });
    let own = labels[t];
    if own == NONE || beside.iter().filter(|label| **label == own).count() > 1 {
        return None;
    }
    let length =
        |label: u32| -> f64 { (0..3).filter(|k| beside[*k] == label).map(|k| topology.edge(t, k)).sum() };
    let others = beside.into_iter().filter(|label| *label != NONE && *label != own);
    let best = others.max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    (length(best) > length(own)).then_some(best)
}
