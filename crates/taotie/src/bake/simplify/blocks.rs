//! Simplifies large surfaces block by block, so that they are limited neither by memory nor by a single thread.

use super::components::Components;
use super::part::{Part, adapter, triples};
use crate::error::Result;
use crate::parallel;
use crate::progress::Progress;
use meshopt::SimplifyOptions as Choices;
use std::sync::atomic::{AtomicUsize, Ordering};

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
