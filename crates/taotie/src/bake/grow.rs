//! Dilation of UV islands.

use super::owner::{NONE, PADDING};
use crate::parallel;
use rayon::prelude::*;

/// Dilates every UV island by `steps` texels into free ones, across the map's borders too.
///
/// In each step a free texel takes the triangle of its first neighbour that has one: left, right, above, below.
pub(super) fn grow(texels: &mut [u32], width: usize, steps: u32) {
    let around = |i: usize| neighbors(i, width, texels.len());
    let is_front = |i: usize| texels[i] == NONE && around(i).into_iter().any(|k| texels[k] != NONE);
    let mut front: Vec<usize> = match steps {
        0 => return,
        _ => parallel::filter(texels.len(), is_front),
    };
    for _ in 0..steps {
        front = step(texels, width, &front);
    }
}

/// Assigns the front, each texel of which has a neighbour with a triangle, to these triangles; returns the next
/// front.
fn step(texels: &mut [u32], width: usize, front: &[usize]) -> Vec<usize> {
    let count = texels.len();
    let triangle = |i: usize| neighbors(i, width, count).into_iter().map(|k| texels[k]).find(|t| *t != NONE);
    let grown = parallel::collect(front.len(), |i| triangle(front[i]).unwrap_or(NONE) | PADDING);
    for (i, triangle) in front.iter().zip(grown) {
        texels[*i] = triangle;
    }
    let free = parallel::fold(front.len(), |free: &mut Vec<usize>, i| {
        free.extend(neighbors(front[i], width, count).into_iter().filter(|k| texels[*k] == NONE));
    });
    let mut next = free.concat();
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
