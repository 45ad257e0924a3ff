//! Edge collapses: on all triangles as a whole, and block by block on large surfaces, so that they are limited
//! neither by memory nor by a single thread.

use super::part::{Components, Part, adapter, triples};
use crate::error::Result;
use crate::math::Vec3;
use crate::parallel;
use crate::progress::Progress;
use meshopt::SimplifyOptions as Choices;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The options of simplification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimplifyOptions {
    /// The requested number of triangles, at least 1.
    pub triangles: usize,
    /// The weight of changes in vertex normals relative to distances: 0 is none, 1 is high. With higher values,
    /// creases and fine waves keep more triangles and flat parts fewer.
    pub normal_weight: f32,
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self { triangles: 10_000, normal_weight: 0.0 }
    }
}

/// The method that reached a number of triangles, from mild to rough.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimplifyMethod {
    /// The surface had no more triangles than requested.
    Kept,
    /// Edges were collapsed; connectivity, holes and handles are preserved.
    Collapsed,
    /// Edges were also collapsed across places where more than two triangles meet, or small disconnected parts were
    /// left out.
    Pruned,
    /// Nearby vertices were merged, whatever they belong to: holes may close, and parts may touch. Used only for a
    /// soup of loose triangles, which nothing else can simplify.
    Clustered,
}

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
pub(super) fn is_near(found: usize, wanted: usize) -> bool {
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

/// Triangles per block. Its border, which cannot change, is about one vertex in fifty.
const BLOCK: usize = 1 << 16;
/// Blocks leave this many triangles for each one in the result, so that the final collapses can choose freely.
const FOR_ONE: usize = 8;
/// Blocks leave at least this many.
const LEAST: usize = 300_000;
/// Blocks keep at least one triangle in this many: otherwise they would consist of their borders.
const OF_MANY: usize = 16;
/// Blocks leave at most this many, unless more are requested: the remainder is simplified as a whole.
const MOST: usize = 3_000_000;

/// Returns the part with fewer triangles, and the error in fractions of the unit cube; unchanged if small enough.
///
/// A large component that would vanish is kept unchanged.
pub(super) fn lighten(
    part: Part,
    components: &Components,
    wanted: usize,
    progress: Progress<'_>,
) -> Result<(Part, f32)> {
    let total = part.triangles.len();
    let left = wanted.saturating_mul(FOR_ONE).max(total / OF_MANY).clamp(LEAST, MOST);
    let left = left.max(wanted.saturating_add(wanted / 4));
    if total < left.saturating_mul(2) {
        return Ok((part, 0.0));
    }
    let locks = shared_vertices(&part);
    let done = AtomicUsize::new(0);
    let blocks: Vec<&[[u32; 3]]> = part.triangles.chunks(BLOCK).collect();
    let simplified = parallel::try_tasks(blocks.len(), &|i| {
        let target = (blocks[i].len() as u128 * left as u128 / total as u128) as usize;
        let result = simplified_block(&part, blocks[i], &locks, target);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.at(done as f64 / blocks.len() as f64).map(|()| result)
    })?;
    let error = simplified.iter().fold(0.0, |most: f32, (_, error)| most.max(*error));
    let mut triangles: Vec<[u32; 3]> = simplified.into_iter().flat_map(|(triangles, _)| triangles).collect();
    let lost = lost(&part, components, &triangles);
    triangles.extend(lost);
    Ok((Part { triangles, ..part }.compacted(), error))
}

/// Returns the triangles of large components that have none in `left`.
fn lost(part: &Part, components: &Components, left: &[[u32; 3]]) -> Vec<[u32; 3]> {
    if components.len() < 2 {
        return Vec::new();
    }
    let counts = components.counts(part, left);
    let is_lost = |i: usize| counts[i] == 0 && components.large[i];
    part.triangles.iter().filter(|triangle| is_lost(part.component(triangle))).copied().collect()
}

/// Returns a flag per vertex: `true` if triangles of more than one block share it.
fn shared_vertices(part: &Part) -> Vec<bool> {
    const NOBODY: u32 = u32::MAX;
    let mut owners = vec![NOBODY; part.points.len()];
    let mut shared = vec![false; part.points.len()];
    for (block, triangles) in part.triangles.chunks(BLOCK).enumerate() {
        for vertex in triangles.as_flattened().iter().map(|v| *v as usize) {
            match owners[vertex] {
                NOBODY => owners[vertex] = block as u32,
                owner => shared[vertex] |= owner != block as u32,
            }
        }
    }
    shared
}

fn simplified_block(part: &Part, block: &[[u32; 3]], locks: &[bool], target: usize) -> (Vec<[u32; 3]>, f32) {
    let mut error = 0.0;
    let choices = Choices::Sparse | Choices::ErrorAbsolute;
    let corners = meshopt::simplify_with_locks(
        block.as_flattened(),
        &adapter(&part.points),
        locks,
        3 * target,
        f32::MAX,
        choices,
        Some(&mut error),
    );
    (triples(corners), error)
}
