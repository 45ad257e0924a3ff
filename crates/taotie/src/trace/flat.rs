//! A bounding volume hierarchy as a list for stackless traversal.

use super::bvh::Bvh;
use super::tree::WIDTH;
use std::ops::Range;

/// A bounding volume hierarchy as a list, for GPUs that trace rays themselves: every box precedes those inside it.
///
/// Traversal continues with the next box if a ray hits one, and with [`FlatBox::skip`] if it does not.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlatBvh {
    /// The boxes.
    pub boxes: Vec<FlatBox>,
    /// The triangles as passed to [`Bvh::build`], those of a box side by side.
    pub order: Vec<u32>,
}

/// A box of a [`FlatBvh`].
#[derive(Debug, Clone, PartialEq)]
pub struct FlatBox {
    /// The minimum coordinates.
    pub low: [f32; 3],
    /// The maximum coordinates.
    pub high: [f32; 3],
    /// The index of the next box outside this one.
    pub skip: u32,
    /// The range of its triangles in [`FlatBvh::order`], at most eight; empty if it contains boxes.
    pub triangles: Range<u32>,
}

impl Bvh {
    /// Returns the hierarchy as a list of boxes.
    ///
    /// ```
    /// use taotie::math::Vec3;
    /// use taotie::trace::Bvh;
    ///
    /// let [x, y] = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    /// let flat = Bvh::build(&[[Vec3::default(), x, y]]).flat();
    /// assert_eq!((flat.boxes.len(), flat.boxes[0].triangles.clone(), flat.order), (1, 0..1, vec![0]));
    /// ```
    pub fn flat(&self) -> FlatBvh {
        let mut boxes = Vec::new();
        self.flatten(self.tree.levels.len(), 0, &mut boxes);
        FlatBvh { boxes, order: self.tree.order.clone() }
    }

    /// Adds the boxes in a node of a level above the leaves; 1 is the lowest.
    fn flatten(&self, level: usize, node: usize, boxes: &mut Vec<FlatBox>) {
        for child in 0..self.tree.children(level, node) {
            let around = &self.tree.levels[level - 1][node];
            let [low, high] = [&around.min, &around.max].map(|side| side.map(|axis| axis[child]));
            let (place, below) = (boxes.len(), node * WIDTH + child);
            boxes.push(FlatBox { low, high, skip: 0, triangles: 0..0 });
            if level == 1 {
                let first = (below * WIDTH) as u32;
                boxes[place].triangles = first..first + self.tree.triangles(below) as u32;
            } else {
                self.flatten(level - 1, below, boxes);
            }
            boxes[place].skip = boxes.len() as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    /// Thin triangles along a spiral.
    fn triangles(count: usize) -> Vec<[Vec3; 3]> {
        let corner = |i: usize| {
            let t = i as f32;
            Vec3::new((i % 17) as f32, (i % 29) as f32 * 0.5, t * 0.1)
        };
        (0..count).map(|i| [corner(i), corner(i + 1), corner(i + 3)]).collect()
    }

    #[test]
    fn every_triangle_lies_in_one_leaf_and_in_all_boxes_above() {
        for count in [1, 8, 9, 64, 65, 700] {
            let triangles = triangles(count);
            let FlatBvh { boxes, order } = Bvh::build(&triangles).flat();
            let mut seen = vec![0; count];
            for (i, outer) in boxes.iter().enumerate() {
                assert!(outer.skip as usize > i && outer.skip as usize <= boxes.len());
                outer.triangles.clone().for_each(|place| seen[order[place as usize] as usize] += 1);
                let inside = boxes[i..outer.skip as usize].iter().flat_map(|inner| inner.triangles.clone());
                for corner in inside.flat_map(|place| triangles[order[place as usize] as usize]) {
                    let p = corner.to_array();
                    assert!(
                        (0..3).all(|axis| (outer.low[axis]..=outer.high[axis]).contains(&p[axis])),
                        "{i}"
                    );
                }
            }
            assert!(seen.iter().all(|times| *times == 1), "{count}: {seen:?}");
        }
    }

    #[test]
    fn boxes_that_hold_boxes_have_no_triangles() {
        let boxes = Bvh::build(&triangles(700)).flat().boxes;
        assert!(boxes.len() > 88, "there are levels above the leaves");
        for (i, outer) in boxes.iter().enumerate() {
            assert_eq!(outer.triangles.is_empty(), outer.skip as usize > i + 1);
        }
    }

    #[test]
    fn nothing_has_no_box() {
        assert_eq!(Bvh::build(&[]).flat(), FlatBvh::default());
    }
}
