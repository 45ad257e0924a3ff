//! Triangles packed eight by eight into boxes: a tree without pointers; and the orders in which they are packed,
//! along Hilbert's curve or by surface area.
//!
//! Boxes take 3 bytes per triangle.
//! Source: Kamel and Faloutsos 1993, "On packing R-trees".

use crate::math::Vec3;
use crate::parallel;
use rayon::prelude::*;

/// The number of children of a node, and of triangles in a leaf.
pub(super) const WIDTH: usize = 8;

/// The boxes of up to eight children, coordinate by coordinate; those of absent ones are empty.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxes {
    pub min: [[f32; WIDTH]; 3],
    pub max: [[f32; WIDTH]; 3],
}

impl Boxes {
    pub const EMPTY: Self = Self { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3] };

    /// The bounding box of all children.
    fn around(&self) -> [[f32; 3]; 2] {
        [self.min.map(|v| extent(&v)[0]), self.max.map(|v| extent(&v)[1])]
    }

    pub fn set(&mut self, child: usize, [min, max]: [[f32; 3]; 2]) {
        for axis in 0..3 {
            self.min[axis][child] = min[axis];
            self.max[axis][child] = max[axis];
        }
    }
}

/// The corners of up to eight triangles, `corners[corner][axis][triangle]`; those of absent ones are NaN.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    pub corners: [[[f32; WIDTH]; 3]; 3],
}

/// Minimum and maximum, ignoring NaN; (∞, −∞) if empty.
#[inline(always)]
fn extent(numbers: &[f32; WIDTH]) -> [f32; 2] {
    numbers.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[least, most], v| {
        [if *v < least { *v } else { least }, if *v > most { *v } else { most }]
    })
}

impl Leaf {
    /// The bounding box of all triangles.
    fn bounds(&self) -> [[f32; 3]; 2] {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for corner in &self.corners {
            for (axis, numbers) in corner.iter().enumerate() {
                let [least, most] = extent(numbers);
                bounds[0][axis] = bounds[0][axis].min(least);
                bounds[1][axis] = bounds[1][axis].max(most);
            }
        }
        bounds
    }

    #[inline]
    pub fn triangle(&self, i: usize) -> [Vec3; 3] {
        // Written out: closures over arrays of arrays are not inlined at moderate optimisation levels.
        let [a, b, c] = &self.corners;
        [
            Vec3::new(a[0][i], a[1][i], a[2][i]),
            Vec3::new(b[0][i], b[1][i], b[2][i]),
            Vec3::new(c[0][i], c[1][i], c[2][i]),
        ]
    }
}

/// Returns the finite corners of a triangle. Called through a pointer, so that all trees share the same code.
pub(super) type Corners<'a> = &'a (dyn Fn(usize) -> [Vec3; 3] + Sync);

/// The tree: leaves, and levels of boxes above them, the last of which has one node.
pub(super) struct Tree {
    /// The triangle in each slot of each leaf, in the order given.
    pub order: Vec<u32>,
    pub leaves: Vec<Leaf>,
    /// Node j of level 0 contains the boxes of leaves 8j to 8j + 7; of level k those of level k − 1.
    pub levels: Vec<Vec<Boxes>>,
}

impl Tree {
    /// Returns the number of children of a node of a level above the leaves, with 1 as the lowest; 1 to 8. Boxes of
    /// others contain nothing, but rounding of huge coordinates may suggest otherwise, so traversal never reads them.
    pub fn children(&self, level: usize, node: usize) -> usize {
        let below = match level {
            0 | 1 => self.leaves.len(),
            level => self.levels[level - 2].len(),
        };
        below.saturating_sub(node * WIDTH).min(WIDTH)
    }

    /// Returns the number of triangles of a leaf, 1 to 8. The other slots are empty.
    pub fn triangles(&self, leaf: usize) -> usize {
        self.order.len().saturating_sub(leaf * WIDTH).min(WIDTH)
    }

    /// Builds the tree of triangles, at most 2^32, in which every eight in `order` share a leaf.
    pub fn new(order: Vec<u32>, corners: Corners<'_>) -> Self {
        // Most of the tree's memory: Rayon's collection is filled by all threads, starting from its first byte.
        let leaves: Vec<Leaf> = order.par_chunks(WIDTH).map(|slots| leaf(slots, corners)).collect();
        let slack = slack(&leaves);
        let mut levels = vec![above(leaves.len(), |i| widened(leaves[i].bounds(), slack))];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let next = above(below.len(), |i| below[i].around());
            levels.push(next);
        }
        Self { order, leaves, levels }
    }
}

/// The level above `children` nodes, whose boxes are returned by `around`.
fn above(children: usize, around: impl Fn(usize) -> [[f32; 3]; 2] + Sync) -> Vec<Boxes> {
    let mut nodes = vec![Boxes::EMPTY; children.div_ceil(WIDTH)];
    parallel::change(&mut nodes, |node, boxes| {
        let first = node * WIDTH;
        for child in first..children.min(first + WIDTH) {
            boxes.set(child - first, around(child));
        }
    });
    nodes
}

/// Boxes are slightly wider than their triangles, so that a flat one is entered in spite of rounding.
fn widened([min, max]: [[f32; 3]; 2], slack: f32) -> [[f32; 3]; 2] {
    [min.map(|v| v - slack), max.map(|v| v + slack)]
}

/// A few rounding errors of the largest coordinate.
fn slack(leaves: &[Leaf]) -> f32 {
    let largest = |leaf: &Leaf| {
        leaf.corners.as_flattened().as_flattened().iter().fold(0.0f32, |most, v| most.max(v.abs()))
    };
    let parts = parallel::fold(leaves.len(), |most: &mut f32, i| *most = most.max(largest(&leaves[i])));
    parts.into_iter().fold(0.0, f32::max) * 5e-7 + f32::MIN_POSITIVE
}

fn leaf(slots: &[u32], corners: Corners<'_>) -> Leaf {
    let mut leaf = Leaf { corners: [[[f32::NAN; WIDTH]; 3]; 3] };
    for (i, triangle) in slots.iter().enumerate() {
        for (corner, point) in corners(*triangle as usize).into_iter().enumerate() {
            for (axis, v) in point.to_array().into_iter().enumerate() {
                leaf.corners[corner][axis][i] = v;
            }
        }
    }
    leaf
}

/// Bits per coordinate of a cell.
const BITS: u32 = 10;

/// The number of cells processed side by side.
const CELLS: usize = 8;

/// The coordinates of cells, axis by axis.
type Cells = [[u32; CELLS]; 3];

/// Bits of a sort key that contain the triangle's index.
const INDEX_BITS: u32 = 64 - 3 * BITS;

/// Triangles whose keys are computed per task.
const PIECE: usize = 4096;

/// Returns the triangles in the order of their centres along Hilbert's curve; of equal ones, the lower index first.
///
/// The triangles of a scan are small and of similar size, so this order is nearly as good a hierarchy as one based on
/// surface areas, and costs one sort.
pub(super) fn along_curve(count: usize, corners: Corners<'_>) -> Vec<u32> {
    let middle = |t: usize| {
        let [a, b, c] = corners(t);
        a * (1.0 / 3.0) + b * (1.0 / 3.0) + c * (1.0 / 3.0)
    };
    let none = [Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY)];
    let lower = |a: Vec3, b: Vec3| Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
    let upper = |a: Vec3, b: Vec3| Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z));
    let join = |a: [Vec3; 2], b: [Vec3; 2]| [lower(a[0], b[0]), upper(a[1], b[1])];
    let parts = parallel::fold(count, |part: &mut Option<[Vec3; 2]>, t| {
        *part = Some(join(part.unwrap_or(none), [middle(t); 2]));
    });
    let [low, high] = parts.into_iter().flatten().fold(none, join);
    let size = high - low;
    let side = size.x.max(size.y).max(size.z).max(f32::MIN_POSITIVE);
    let scale = |v: f32| ((v / side * (1u32 << BITS) as f32) as u32).min((1 << BITS) - 1);
    let mut keys = vec![0u64; count];
    parallel::pieces(&mut keys, PIECE, &|piece, keys| {
        for (block, keys) in keys.chunks_mut(CELLS).enumerate() {
            let first = piece * PIECE + block * CELLS;
            let mut cells: Cells = [[0; CELLS]; 3];
            let triangles = first..first + keys.len();
            for (i, triangle) in triangles.enumerate() {
                let cell = (middle(triangle) - low).to_array().map(scale);
                cells.iter_mut().zip(cell).for_each(|(axis, cell)| axis[i] = cell);
            }
            for ((i, key), index) in keys.iter_mut().enumerate().zip(hilbert_indices(&cells)) {
                *key = index << INDEX_BITS | (first + i) as u64;
            }
        }
    });
    keys.par_sort_unstable();
    parallel::collect(count, |i| (keys[i] & ((1 << INDEX_BITS) - 1)) as u32)
}

/// Returns the positions along Hilbert's curve of cells in a cube of 2^[`BITS`] cells per side; neighbours on the
/// curve are neighbours in space. Branchless loops over all cells, which compilers vectorise.
///
/// Source: Skilling 2004, "Programming the Hilbert curve".
#[inline]
fn hilbert_indices(cells: &Cells) -> [u64; CELLS] {
    let mut x = *cells;
    for bit in (1..BITS).rev() {
        let low = (1 << bit) - 1;
        let [first, second, third] = &mut x;
        // The first is swapped with itself, which has no effect.
        first.iter_mut().for_each(|first| *first ^= low & all_ones(*first >> bit & 1));
        for (first, other) in first.iter_mut().zip(second) {
            turn(first, other, bit);
        }
        for (first, other) in first.iter_mut().zip(third) {
            turn(first, other, bit);
        }
    }
    let mut indices = [0; CELLS];
    for (i, index) in indices.iter_mut().enumerate() {
        let [a, b, c] = [x[0][i], x[1][i] ^ x[0][i], x[2][i] ^ x[1][i] ^ x[0][i]];
        let flips = (1..BITS).fold(0, |flips, bit| flips ^ all_ones(c >> bit & 1) & ((1 << bit) - 1));
        let [a, b, c] = [a, b, c].map(|v| spread_bits(v ^ flips));
        *index = a << 2 | b << 1 | c;
    }
    indices
}

/// If a bit of `other` is set, flips the lower ones of `first`; otherwise swaps those of both.
#[inline(always)]
fn turn(first: &mut u32, other: &mut u32, bit: u32) {
    let (low, set) = ((1 << bit) - 1, all_ones(*other >> bit & 1));
    let swapped = (*first ^ *other) & low & !set;
    *first ^= low & set | swapped;
    *other ^= swapped;
}

/// All ones for 1, none for 0.
#[inline(always)]
fn all_ones(bit: u32) -> u32 {
    0u32.wrapping_sub(bit)
}

/// The lowest 21 bits of a number, with two zeros between consecutive bits.
fn spread_bits(v: u32) -> u64 {
    let mut v = u64::from(v);
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// A triangle, represented by its box.
#[derive(Debug, Clone, Copy, Default)]
struct Item {
    min: [f32; 3],
    max: [f32; 3],
    number: u32,
}

/// The keys by which halves are separated: the centre of the box along each axis, or its longest side.
const KEYS: [usize; 4] = [0, 1, 2, LONGEST];
const LONGEST: usize = 3;

impl Item {
    fn new(number: usize, corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::to_array);
        let each = |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|axis| pick(pick(a[axis], b[axis]), c[axis]));
        Self { min: each(f32::min), max: each(f32::max), number: number as u32 }
    }

    #[inline(always)]
    fn key(&self, key: usize) -> f32 {
        match key {
            LONGEST => (0..3).fold(0.0, |most: f32, axis| most.max(self.max[axis] - self.min[axis])),
            axis => self.min[axis] * 0.5 + self.max[axis] * 0.5,
        }
    }
}

/// Returns the triangles in an order for many rays: split so that the boxes around the halves have a small surface
/// area.
///
/// Finding it takes seventeen times as long as the order along a curve, and tracing takes a fifth less time. Large
/// triangles among small ones, such as the walls around a scan, are grouped, whereas on a curve each would enlarge a
/// separate box.
/// Source: MacDonald and Booth 1990, "Heuristics for ray tracing using space subdivision".
pub(super) fn by_area(count: usize, corners: Corners<'_>) -> Vec<u32> {
    let mut items = parallel::collect(count, |t| Item::new(t, corners(t)));
    let mut child = WIDTH;
    while child.saturating_mul(WIDTH) < count {
        child *= WIDTH;
    }
    arrange(&mut items, child);
    parallel::collect(count, |i| items[i].number)
}

/// Arranges the triangles of a node whose children contain `child` triangles each.
fn arrange(items: &mut [Item], child: usize) {
    /// Two halves with at least this number of triangles are arranged in parallel.
    const APART: usize = 4096;
    if items.len() <= WIDTH {
        items.sort_unstable_by_key(|item| item.number);
        return;
    }
    if items.len() <= child {
        return arrange(items, child / WIDTH);
    }
    let half = items.len().div_ceil(child) / 2 * child;
    let costs = KEYS.map(|key| {
        halve(items, half, key);
        cost(&items[..half]) + cost(&items[half..])
    });
    let best = KEYS.into_iter().fold(0, |best, key| if costs[key] < costs[best] { key } else { best });
    halve(items, half, best);
    let both = items.len();
    let (left, right) = items.split_at_mut(half);
    if both < APART {
        arrange(left, child);
        arrange(right, child);
    } else {
        rayon::join(|| arrange(left, child), || arrange(right, child));
    }
}

/// Moves the triangles with the lower keys to the front.
fn halve(items: &mut [Item], half: usize, key: usize) {
    items
        .select_nth_unstable_by(half, |a, b| a.key(key).total_cmp(&b.key(key)).then(a.number.cmp(&b.number)));
}

/// Returns the cost of a box around triangles for rays: half of its surface area times the number of triangles.
fn cost(items: &[Item]) -> f32 {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in items {
        for axis in 0..3 {
            min[axis] = min[axis].min(item.min[axis]);
            max[axis] = max[axis].max(item.max[axis]);
        }
    }
    let [x, y, z] = [0, 1, 2].map(|axis| max[axis] - min[axis]);
    (x * y + y * z + z * x) * items.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_space() {
        // A cube of 8 cells per side at the origin is the first part of the curve.
        let side = 8u32;
        let mut cells: Vec<[u32; 3]> =
            (0..side.pow(3)).map(|i| [i % side, i / side % side, i / side / side]).collect();
        let index = |cell: [u32; 3]| {
            let mut cells = [[0; CELLS]; 3];
            (0..3).for_each(|axis| cells[axis][3] = cell[axis]);
            hilbert_indices(&cells)[3]
        };
        cells.sort_by_key(|cell| index(*cell));
        for (i, cell) in cells.iter().enumerate() {
            assert_eq!(index(*cell), i as u64);
        }
        for pair in cells.windows(2) {
            let steps: u32 = (0..3).map(|k| pair[0][k].abs_diff(pair[1][k])).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }

    /// Small triangles along a diagonal, and every hundredth one as large as all of them together.
    fn triangle(t: usize) -> [Vec3; 3] {
        let size = if t.is_multiple_of(100) { 1000.0 } else { 1.0 };
        let at = Vec3::splat(t as f32);
        [at, at + Vec3::new(size, 0.0, 0.0), at + Vec3::new(0.0, size, 0.0)]
    }

    #[test]
    fn every_triangle_is_there_once() {
        for count in [0, 1, 8, 9, 64, 65, 1000, 5000] {
            let mut order = by_area(count, &triangle);
            order.sort_unstable();
            assert!(order.into_iter().eq(0..count as u32), "{count}");
        }
    }

    #[test]
    fn large_triangles_share_leaves() {
        let order = by_area(1000, &triangle);
        let has_large = |leaf: &&[u32]| leaf.iter().any(|t| t.is_multiple_of(100));
        assert_eq!(order.chunks(WIDTH).filter(has_large).count(), 2, "ten of them in leaves of eight");
    }
}
