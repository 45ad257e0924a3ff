//! Splits triangles into a tree so that the boxes around the parts have a small surface area.
//!
//! Sources: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"; Wald, Benthin and Boulos 2008,
//! "Getting rid of packets".

use crate::math::Vec3;
use crate::parallel;
use arrayvec::ArrayVec;
use rayon::prelude::*;

/// The maximum number of children of a node, and of triangles in a leaf.
pub(super) const WIDTH: usize = 8;

/// The number of levels below which nodes are no longer split by surface area.
pub(super) const DEEP: usize = 11;

/// Returns the finite corners of a triangle. Called through a pointer, so that all trees share the same code.
pub(super) type Corners<'a> = &'a (dyn Fn(usize) -> [Vec3; 3] + Sync);

/// A triangle, represented by its box.
#[derive(Debug, Clone, Copy, Default)]
struct Item {
    min: [f32; 3],
    max: [f32; 3],
    number: u32,
}

impl Item {
    fn new(number: usize, corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::to_array);
        let each = |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|axis| pick(pick(a[axis], b[axis]), c[axis]));
        Self { min: each(f32::min), max: each(f32::max), number: number as u32 }
    }

    #[inline(always)]
    fn center(&self, axis: usize) -> f32 {
        self.min[axis] * 0.5 + self.max[axis] * 0.5
    }
}

/// A part of a tree before it is stored.
pub(super) enum Branch {
    Leaf(ArrayVec<u32, WIDTH>),
    Node(Vec<Self>),
}

/// Splits the triangles 0 to `count` − 1, whose finite corners are returned by `corners`.
pub(super) fn split_by_area(count: usize, corners: Corners<'_>) -> Branch {
    branch(&mut parallel::collect(count, |t| Item::new(t, corners(t))), 0)
}

/// Splits triangles into a tree; `depth` is the number of nodes above.
fn branch(items: &mut [Item], depth: usize) -> Branch {
    /// The parts of a node with at least this number of triangles are split in parallel.
    const APART: usize = 4096;
    if items.len() <= WIDTH {
        items.sort_unstable_by_key(|item| item.number);
        return Branch::Leaf(items.iter().map(|item| item.number).collect());
    }
    let is_large = items.len() >= APART;
    let parts = parts(items, depth);
    Branch::Node(match is_large {
        true => parts.into_par_iter().map(|part| branch(part, depth + 1)).collect(),
        false => parts.into_iter().map(|part| branch(part, depth + 1)).collect(),
    })
}

/// Splits the triangles of a node among its children: the part of the highest cost first, until there are eight.
fn parts(items: &mut [Item], depth: usize) -> Vec<&mut [Item]> {
    let cost = |items: &[Item]| match depth < DEEP {
        true => Part::of(items).cost(),
        false => items.len() as f32,
    };
    let mut parts = vec![(cost(items), items)];
    while parts.len() < WIDTH {
        let large = parts.iter().enumerate().filter(|(_, (_, items))| items.len() > WIDTH);
        let costly = large.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.len().cmp(&b.1.len())));
        let Some((costly, _)) = costly else { break };
        let (_, items) = parts.swap_remove(costly);
        let middle = if depth < DEEP { split(items) } else { items.len() / 2 };
        let (left, right) = items.split_at_mut(middle);
        parts.extend([left, right].map(|items| (cost(items), items)));
    }
    parts.into_iter().map(|(_, items)| items).collect()
}

/// Triangles of a node, by their number and box.
#[derive(Clone, Copy)]
struct Part {
    count: usize,
    min: [f32; 3],
    max: [f32; 3],
}

impl Part {
    const EMPTY: Self = Self { count: 0, min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn of(items: &[Item]) -> Self {
        let mut part = Self::EMPTY;
        items.iter().for_each(|item| part.add(1, item.min, item.max));
        part
    }

    #[inline(always)]
    fn add(&mut self, count: usize, min: [f32; 3], max: [f32; 3]) {
        self.count += count;
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(min[axis]);
            self.max[axis] = self.max[axis].max(max[axis]);
        }
    }

    /// Returns the cost for rays: half of the surface area of the box times the number of leaves that it needs.
    fn cost(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.max[axis] - self.min[axis]);
        let cost = (x * y + y * z + z * x) * self.count.div_ceil(WIDTH) as f32;
        // Huge coordinates: the same on every machine, unlike the sign of NaN.
        if cost.is_finite() { cost } else { f32::MAX }
    }
}

/// Moves triangles to the front, and returns their number, so that the costs of both parts are small: the best border
/// between a few bins along each axis. Source: MacDonald and Booth 1990, "Heuristics for ray tracing using space
/// subdivision".
fn split(items: &mut [Item]) -> usize {
    const BINS: usize = 16;
    let mut best: Option<(f32, usize, [f32; 2])> = None;
    for axis in 0..3 {
        let centers = items.iter().map(|item| item.center(axis));
        let [low, high] = centers.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], center| {
            [low.min(center), high.max(center)]
        });
        let scale = BINS as f32 / (high - low);
        if !scale.is_finite() {
            continue;
        }
        let mut bins = [Part::EMPTY; BINS];
        for item in &*items {
            let bin = ((item.center(axis) - low) * scale) as usize;
            bins[bin.min(BINS - 1)].add(1, item.min, item.max);
        }
        let (mut right, mut costs) = (Part::EMPTY, [f32::INFINITY; BINS]);
        for i in (1..BINS).rev() {
            right.add(bins[i].count, bins[i].min, bins[i].max);
            costs[i] = if right.count > 0 { right.cost() } else { f32::INFINITY };
        }
        let mut left = Part::EMPTY;
        for i in 1..BINS {
            left.add(bins[i - 1].count, bins[i - 1].min, bins[i - 1].max);
            let cost = costs[i] + if left.count > 0 { left.cost() } else { f32::INFINITY };
            if cost < best.map_or(f32::INFINITY, |(least, ..)| least) {
                best = Some((cost, axis, [low, i as f32 / scale]));
            }
        }
    }
    let Some((_, axis, [low, border])) = best else { return items.len() / 2 };
    let mut count = 0;
    for i in 0..items.len() {
        if items[i].center(axis) - low < border {
            items.swap(i, count);
            count += 1;
        }
    }
    if (1..items.len()).contains(&count) { count } else { items.len() / 2 }
}
