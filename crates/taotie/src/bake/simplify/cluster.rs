//! Simplifies unconnected triangles by merging vertices that are near one another.

use super::collapse::{Reduced, collapsed, is_too_many};
use super::options::{SimplifyMethod, SimplifyOptions};
use super::part::{Part, adapter, triples};
use crate::math::Vec3;
use crate::trace::Bvh;
use meshopt::SimplifyOptions as Choices;

/// The number of triangles that clustering leaves per requested triangle, so that edges can be collapsed afterwards.
const CLUSTERED_FOR_ONE: usize = 4;
/// A triangle spans a gap if its centroid or the midpoint of an edge is farther from the surface than this multiple
/// of the error...
const FAR: f32 = 4.0;
/// ... and than this fraction of the unit cube.
const LEAST_GAP: f32 = 0.01;

/// Merges nearby vertices down to a few times the target, collapses edges from there, and drops triangles that span
/// gaps.
pub(super) fn clustered(part: &Part, options: &SimplifyOptions) -> Reduced {
    let joined = joined(part, options);
    let near = without_bars(part, &joined);
    if near.is_empty() { joined } else { Reduced { triangles: near, ..joined } }
}

/// Returns the triangles that are on the part's surface.
fn without_bars(part: &Part, joined: &Reduced) -> Vec<[u32; 3]> {
    let surface = Bvh::of(part.triangles.len(), |t| corners(&part.points, &part.triangles[t]));
    let far = (FAR * joined.error).max(LEAST_GAP);
    let is_near = |triangle: &&[u32; 3]| {
        middles(corners(&joined.points, triangle)).into_iter().all(|p| surface.closest(p, far).is_some())
    };
    joined.triangles.iter().filter(is_near).copied().collect()
}

fn corners(points: &[[f32; 3]], triangle: &[u32; 3]) -> [Vec3; 3] {
    triangle.map(|v| Vec3::from_array(points[v as usize]))
}

/// Returns the centroid of a triangle and the midpoints of its edges.
fn middles([a, b, c]: [Vec3; 3]) -> [Vec3; 4] {
    [(a + b + c) * (1.0 / 3.0), (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5]
}

/// Merges nearby vertices down to a few times the target, and collapses edges from there.
fn joined(part: &Part, options: &SimplifyOptions) -> Reduced {
    let wanted = options.triangles;
    let plenty = wanted.saturating_mul(CLUSTERED_FOR_ONE).min(part.triangles.len());
    let rough = sloppy(part, plenty);
    let rough_error = rough.error;
    let fine = collapsed(rough, options, Choices::Permissive);
    if fine.triangles.is_empty() || is_too_many(&fine, wanted) {
        return sloppy(part, wanted);
    }
    Reduced { error: rough_error + fine.error, method: SimplifyMethod::Clustered, ..fine }
}

fn sloppy(part: &Part, target: usize) -> Reduced {
    let mut error = 0.0;
    let corners = meshopt::simplify_sloppy(
        part.triangles.as_flattened(),
        &adapter(&part.points),
        3 * target,
        1.0,
        Some(&mut error),
    );
    Reduced { triangles: triples(corners), error, ..Reduced::kept(part, SimplifyMethod::Clustered) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles with a gap between them, one with the same corners, and two that bridge the gap.
    #[test]
    fn triangles_over_gaps_are_left_out() {
        let points = vec![
            [0.0, 0.0, 0.0],
            [0.3, 0.0, 0.0],
            [0.0, 0.3, 0.0],
            [0.4, 0.0, 0.0],
            [0.7, 0.0, 0.0],
            [0.4, 0.3, 0.0],
        ];
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        let part = Part { points, sources: Vec::new(), triangles, labels: Vec::new() };
        let joined = |error: f32| {
            let triangles = vec![[0, 2, 1], [1, 3, 2], [0, 4, 5]];
            Reduced { triangles, error, ..Reduced::kept(&part, SimplifyMethod::Clustered) }
        };
        assert_eq!(without_bars(&part, &joined(1e-3)), [[0, 2, 1]]);
        assert_eq!(
            without_bars(&part, &joined(0.1)).len(),
            3,
            "the error is the distance that vertices moved"
        );
    }
}
