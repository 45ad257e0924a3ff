//! Growing UV islands beyond their borders.

use super::owner::{NONE, PADDING};
use rayon::prelude::*;

/// Grows every UV island by `steps` texels into free ones, across the map's borders too.
///
/// In each step a free texel takes the triangle of its first neighbour that has one: left, right, above, below.
pub(super) fn grow(texels: &mut [u32], width: usize, steps: u32) {
    let around = |i: usize| neighbors(i, width, texels.len());
    let is_front = |i: &usize| texels[*i] == NONE && around(*i).into_iter().any(|k| texels[k] != NONE);
    let mut front: Vec<usize> = match steps {
        0 => return,
        _ => (0..texels.len()).into_par_iter().filter(is_front).collect(),
    };
    for _ in 0..steps {
        front = step(texels, width, &front);
    }
}

/// Gives the front to its neighbours' triangles; returns the next front.
fn step(texels: &mut [u32], width: usize, front: &[usize]) -> Vec<usize> {
    let count = texels.len();
    let triangle = |i: usize| neighbors(i, width, count).into_iter().map(|k| texels[k]).find(|t| *t != NONE);
    let grown: Vec<(usize, u32)> =
        front.par_iter().filter_map(|i| triangle(*i).map(|t| (*i, t | PADDING))).collect();
    for (i, triangle) in &grown {
        texels[*i] = *triangle;
    }
    let mut next: Vec<usize> = grown
        .par_iter()
        .flat_map_iter(|(i, _)| neighbors(*i, width, count))
        .filter(|k| texels[*k] == NONE)
        .collect();
    next.par_sort_unstable();
    next.dedup();
    next
}

/// Returns the neighbours: left, right, above, below; wrapped.
fn neighbors(i: usize, width: usize, count: usize) -> [usize; 4] {
    let x = i % width;
    let left = if x == 0 { i + width - 1 } else { i - 1 };
    let right = if x + 1 == width { i + 1 - width } else { i + 1 };
    [left, right, (i + count - width) % count, (i + width) % count]
}
