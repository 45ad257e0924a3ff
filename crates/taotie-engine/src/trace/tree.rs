//! Triangles packed eight by eight into boxes, in a given order: a tree without pointers.
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
