//! Edge collapses on all triangles as a whole.

use super::options::{SimplifyMethod, SimplifyOptions};
use super::part::{Part, triples};
use crate::math::Vec3;
use meshopt::SimplifyOptions as Choices;

/// The maximum deviation from the requested number of triangles, as a fraction of it.
const NEAR: f64 = 0.02;
/// The largest component that may be left out, as a fraction of the whole.
const LARGEST_LEFT_OUT: f32 = 0.05;

/// A part with fewer triangles, on points that moved.
pub(super) struct Reduced {
    /// The same number of points as in the part, in the unit cube.
    pub points: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// As a fraction of the unit cube.
    pub error: f32,
    pub method: SimplifyMethod,
}

/// Returns `true` if a number of triangles is the requested one, or nearly.
pub(in crate::bake) fn is_near(found: usize, wanted: usize) -> bool {
    found.abs_diff(wanted) as f64 <= (NEAR * wanted as f64).max(1.0)
}

/// Returns `true` if more triangles are left than requested, beyond the tolerance.
pub(super) fn is_too_many(reduced: &Reduced, wanted: usize) -> bool {
    reduced.triangles.len() > wanted && !is_near(reduced.triangles.len(), wanted)
}

impl Reduced {
    /// Returns a part unchanged.
    pub fn kept(part: &Part, method: SimplifyMethod) -> Self {
        Self { points: part.points.clone(), triangles: part.triangles.clone(), error: 0.0, method }
    }
}

/// Returns the collapsed part: if many triangles share an edge, a collapse removes more than requested; the target is
/// then raised.
pub(super) fn collapsed_exactly(part: &Part, options: &SimplifyOptions) -> Reduced {
    let collapsed_to = |triangles: usize| {
        let options = SimplifyOptions { triangles, ..*options };
        collapsed(Reduced::kept(part, SimplifyMethod::Kept), &options, Choices::empty())
    };
    let wanted = options.triangles;
    let first = collapsed_to(wanted);
    let found = first.triangles.len();
    if found > wanted || is_near(found, wanted) {
        return first;
    }
    let second = collapsed_to(wanted + (wanted - found));
    if is_near(second.triangles.len(), wanted) { second } else { first }
}

/// Collapses edges, and moves the remaining points to the positions nearest to the surface.
pub(super) fn collapsed(from: Reduced, options: &SimplifyOptions, more: Choices) -> Reduced {
    let Reduced { mut points, triangles, .. } = from;
    let pruning = more.contains(Choices::Prune);
    let limit = if pruning { LARGEST_LEFT_OUT } else { f32::MAX };
    let mut normals: Vec<[f32; 3]> = match options.normal_weight > 0.0 {
        true => normals(&points, &triangles).into_iter().map(Vec3::to_array).collect(),
        false => Vec::new(),
    };
    let weights = vec![options.normal_weight; if normals.is_empty() { 0 } else { 3 }];
    let mut error = 0.0;
    let mut corners = triangles.into_flattened();
    let target = (3 * options.triangles).min(corners.len());
    let count = meshopt::simplify_with_update(
        &mut corners,
        &mut points,
        normals.as_flattened_mut(),
        &weights,
        size_of_val(weights.as_slice()),
        None,
        target,
        limit,
        more | Choices::ErrorAbsolute,
        Some(&mut error),
    );
    corners.truncate(count);
    Reduced { points, triangles: triples(corners), error, method: SimplifyMethod::Collapsed }
}

/// Continues after collapses have stalled, across edges shared by many triangles and dropping the smallest
/// components.
pub(super) fn pruned(from: Reduced, options: &SimplifyOptions) -> Reduced {
    let earlier = from.error;
    let free = collapsed(from, options, Choices::Permissive);
    let found = match is_too_many(&free, options.triangles) {
        true => collapsed(free, options, Choices::Permissive | Choices::Prune),
        false => free,
    };
    Reduced { error: earlier + found.error, method: SimplifyMethod::Pruned, ..found }
}

/// Returns one normal per point, weighted by triangle area; 0 if triangles cancel out.
pub(super) fn normals(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::splat(0.0f32); points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| Vec3::from_array(points[v as usize]));
        let doubled_area = (b - a).cross(c - a);
        triangle.iter().for_each(|v| sums[*v as usize] += doubled_area);
    }
    sums.into_iter().map(|sum| sum.normalize_or(Vec3::splat(0.0))).collect()
}
