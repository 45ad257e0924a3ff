//! Triangles in boxes, up to eight in each, and up to eight boxes in each larger one: packed eight by eight along
//! Hilbert's curve, which is quick, or split by surface area, for many rays.
//!
//! Packed nodes take 4.1 bytes per triangle.
//! Source: Kamel and Faloutsos 1993, "On packing R-trees".

use super::by_area::{Branch, Corners, DEEP, WIDTH, split_by_area};
use crate::math::Vec3;
use crate::parallel;
use arrayvec::ArrayVec;
use rayon::prelude::*;
use std::ops::Range;

/// The maximum number of nodes that wait during a traversal: seven siblings on each level. Below [`DEEP`] levels, nodes
/// have equal halves, and 11 levels hold 2^32 triangles.
pub(super) const STACK: usize = (WIDTH - 1) * (DEEP + 11) + 1;

/// The boxes of up to eight children, coordinate by coordinate; those of absent ones are empty.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxes {
    pub min: [[f32; WIDTH]; 3],
    pub max: [[f32; WIDTH]; 3],
}

/// A node: its children, and their boxes. Boxes of absent children contain nothing, but rounding of huge coordinates
/// may suggest otherwise, so traversal only reads the first `count`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub boxes: Boxes,
    children: [Child; WIDTH],
    count: u32,
}

/// A child of a node, or the root of a tree: a leaf or a node, by its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
    }

    fn node(index: usize) -> Self {
        Self(index as u32)
    }

    /// Returns the index of a leaf; `None` for a node.
    #[inline(always)]
    pub fn as_leaf(self) -> Option<usize> {
        (self.0 & Self::LEAF != 0).then_some((self.0 & !Self::LEAF) as usize)
    }

    /// Returns the index of a node, or any other number for a leaf.
    #[inline(always)]
    fn index(self) -> usize {
        self.0 as usize
    }
}

impl Node {
    const EMPTY: Self = Self { boxes: Boxes::EMPTY, children: [Child(0); WIDTH], count: 0 };

    fn add(&mut self, child: Child, bounds: [[f32; 3]; 2]) {
        self.boxes.set(self.count as usize, bounds);
        self.children[self.count as usize] = child;
        self.count += 1;
    }

    /// Returns its children, one to eight.
    #[inline(always)]
    pub fn children(&self) -> &[Child] {
        &self.children[..self.count as usize]
    }

    /// Returns its child at a position of its boxes.
    #[inline(always)]
    pub fn child(&self, i: usize) -> Child {
        self.children[i]
    }

    /// Returns a bit for each child.
    #[inline(always)]
    pub fn present(&self) -> u64 {
        (1 << self.count) - 1
    }
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

/// The tree.
pub(super) struct Tree {
    /// The triangle in each slot of each leaf, in the order given; [`Tree::NONE`] in absent ones, which are the last.
    slots: Vec<u32>,
    pub leaves: Vec<Leaf>,
    nodes: Vec<Node>,
    /// `None` without triangles.
    root: Option<Child>,
}

impl Tree {
    /// The triangle of an absent slot.
    const NONE: u32 = u32::MAX;

    /// Returns the node or leaf that contains everything.
    pub fn root(&self) -> Option<Child> {
        self.root
    }

    /// Returns the number of nodes and leaves, and an upper bound of the number of triangles.
    pub fn counts(&self) -> (usize, usize) {
        (self.nodes.len() + self.leaves.len(), self.slots.len())
    }

    /// Returns a node that is not a leaf.
    #[inline(always)]
    pub fn node(&self, node: Child) -> &Node {
        &self.nodes[node.index()]
    }

    /// Returns the triangles of a leaf, one to eight. Its other slots are empty.
    #[inline(always)]
    pub fn triangles(&self, leaf: usize) -> &[u32] {
        let slots = &self.slots[leaf * WIDTH..][..WIDTH];
        &slots[..WIDTH - slots.iter().filter(|triangle| **triangle == Self::NONE).count()]
    }

    /// Returns the triangle in a slot: eight times the leaf, plus its position there. `None` in an absent one.
    #[inline(always)]
    pub fn triangle(&self, slot: usize) -> Option<u32> {
        Some(self.slots[slot]).filter(|triangle| *triangle != Self::NONE)
    }

    /// Builds the tree of triangles, at most 2^32 − 1, in which every eight in `order` share a leaf.
    pub fn packed(order: Vec<u32>, corners: Corners<'_>) -> Self {
        let mut slots = order;
        let count = slots.len().next_multiple_of(WIDTH);
        slots.reserve_exact(count - slots.len());
        slots.resize(count, Self::NONE);
        let (leaves, slack) = leaves(&slots, corners);
        let mut nodes =
            packed_level(0..leaves.len(), |i| (Child::leaf(i), widened(leaves[i].bounds(), slack)));
        nodes.reserve_exact(nodes.len() / (WIDTH - 1) + WIDTH);
        let mut level = 0..nodes.len();
        while level.len() > 1 {
            let next = packed_level(level, |i| (Child::node(i), nodes[i].boxes.around()));
            level = nodes.len()..nodes.len() + next.len();
            nodes.extend(next);
        }
        let root = nodes.len().checked_sub(1).map(Child::node);
        Self { slots, leaves, nodes, root }
    }

    /// Builds the tree of triangles, at most 2^32 − 1, for many rays: nodes are split so that the boxes around their
    /// children have a small surface area.
    ///
    /// This takes five to ten times as long as packing. Large triangles among small ones, such as the walls around a
    /// scan, get separate boxes, whereas packed along a curve, each would enlarge another box.
    pub fn by_area(count: usize, corners: Corners<'_>) -> Self {
        let mut lists = Lists::default();
        match split_by_area(count, corners) {
            Branch::Leaf(leaf) if leaf.is_empty() => {}
            Branch::Leaf(leaf) => _ = lists.add(Branch::Node(vec![Branch::Leaf(leaf)])),
            node => _ = lists.add(node),
        }
        let Lists { slots, children } = lists;
        let (leaves, slack) = leaves(&slots, corners);
        let mut nodes: Vec<Node> = Vec::with_capacity(children.len());
        // Children precede their parents.
        for children in children {
            let mut node = Node::EMPTY;
            for child in children {
                node.add(
                    child,
                    match child.as_leaf() {
                        Some(leaf) => widened(leaves[leaf].bounds(), slack),
                        None => nodes[child.index()].boxes.around(),
                    },
                );
            }
            nodes.push(node);
        }
        let root = nodes.len().checked_sub(1).map(Child::node);
        Self { slots, leaves, nodes, root }
    }
}

/// The level above some leaves or nodes, each of which is returned with its bounds by `child`.
fn packed_level(below: Range<usize>, child: impl Fn(usize) -> (Child, [[f32; 3]; 2]) + Sync) -> Vec<Node> {
    let mut nodes = vec![Node::EMPTY; below.len().div_ceil(WIDTH)];
    parallel::change(&mut nodes, |i, node| {
        let first = below.start + i * WIDTH;
        let children = first..below.end.min(first + WIDTH);
        children.map(&child).for_each(|(child, bounds)| node.add(child, bounds));
    });
    nodes
}

/// Returns the leaves of all slots, and the slack of their boxes.
fn leaves(slots: &[u32], corners: Corners<'_>) -> (Vec<Leaf>, f32) {
    // Most of the tree's memory: Rayon's collection is filled by all threads, starting from its first byte.
    let leaves: Vec<Leaf> = slots.par_chunks(WIDTH).map(|slots| leaf(slots, corners)).collect();
    let slack = slack(&leaves);
    (leaves, slack)
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
    for (i, triangle) in slots.iter().enumerate().filter(|(_, triangle)| **triangle != Tree::NONE) {
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

/// The slots and nodes of a tree; the children of each node precede it.
#[derive(Default)]
struct Lists {
    slots: Vec<u32>,
    children: Vec<ArrayVec<Child, WIDTH>>,
}

impl Lists {
    fn add(&mut self, branch: Branch) -> Child {
        match branch {
            Branch::Leaf(triangles) => {
                self.slots.extend(&triangles);
                self.slots.extend(std::iter::repeat_n(Tree::NONE, WIDTH - triangles.len()));
                Child::leaf(self.slots.len() / WIDTH - 1)
            }
            Branch::Node(branches) => {
                let children = branches.into_iter().map(|branch| self.add(branch)).collect();
                self.children.push(children);
                Child::node(self.children.len() - 1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

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

    /// Returns the triangles of all leaves, in the order of a traversal.
    fn triangles(tree: &Tree) -> Vec<Vec<u32>> {
        let (mut leaves, mut waiting) = (Vec::new(), Vec::from_iter(tree.root()));
        while let Some(child) = waiting.pop() {
            match child.as_leaf() {
                Some(leaf) => leaves.push(tree.triangles(leaf).to_vec()),
                None => waiting.extend(tree.node(child).children()),
            }
        }
        leaves
    }

    #[test]
    fn every_triangle_is_there_once() {
        for count in [0, 1, 8, 9, 64, 65, 1000, 5000] {
            for tree in
                [Tree::by_area(count, &triangle), Tree::packed(along_curve(count, &triangle), &triangle)]
            {
                let mut all = triangles(&tree).concat();
                all.sort_unstable();
                assert!(all.into_iter().eq(0..count as u32), "{count}");
            }
        }
    }

    #[test]
    fn leaves_are_more_than_half_full() {
        let ball = Mesh::sphere(1.0, 200, 100);
        let tree = Tree::by_area(ball.triangles().len(), &|t| ball.corners(t));
        let share = ball.triangles().len() as f64 / tree.counts().1 as f64;
        assert!(share > 0.6, "{share}");
    }

    #[test]
    fn large_triangles_share_leaves() {
        let has_large = |leaf: &&Vec<u32>| leaf.iter().any(|t| t.is_multiple_of(100));
        let tree = Tree::by_area(1000, &triangle);
        assert_eq!(triangles(&tree).iter().filter(has_large).count(), 2, "ten of them in leaves of eight");
    }

    #[test]
    fn equal_triangles_are_split_into_a_shallow_tree() {
        let corner = |t: usize| [Vec3::splat(f32::from(u8::from(t == 0))); 3];
        let tree = Tree::by_area(100_000, &corner);
        let mut waiting = vec![(tree.root().unwrap(), 1)];
        let mut deepest = 0;
        while let Some((child, depth)) = waiting.pop() {
            deepest = deepest.max(depth);
            if child.as_leaf().is_none() {
                waiting.extend(tree.node(child).children().iter().map(|child| (*child, depth + 1)));
            }
        }
        assert!(deepest <= 8, "{deepest}");
    }
}
