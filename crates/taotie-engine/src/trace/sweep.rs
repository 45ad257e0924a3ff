//! Visits all triangles in one direction.

use super::bvh::Bvh;
use super::by_area::WIDTH;
use super::tree::{Boxes, Child, Leaf};
use crate::math::Vec3;
use std::cmp::Ordering;

/// The corners of up to eight triangles, `corners[corner][axis][triangle]`.
pub(crate) type EightTriangles = [[[f32; WIDTH]; 3]; 3];

/// Receives the triangles of a [`Bvh::sweep`].
pub(crate) trait Sweep {
    /// Returns true if the triangles in a box, given by its minimum and maximum corner, are wanted.
    fn wants(&self, bounds: [Vec3; 2]) -> bool;

    /// Receives up to eight triangles, by their indices and corners.
    fn take(&mut self, triangles: &[u32], corners: &EightTriangles);
}

/// A node that waits to be visited.
struct Waiting {
    child: Child,
    bounds: [Vec3; 2],
}

impl Bvh {
    /// Visits the wanted boxes, those farthest along `toward` first, and passes on their triangles.
    pub(crate) fn sweep(&self, toward: Vec3, sweep: &mut impl Sweep) {
        self.descend(toward, |next, leaf| match leaf {
            None => sweep.wants(next),
            Some((triangles, leaf)) => {
                sweep.take(triangles, &leaf.corners);
                true
            }
        });
    }

    /// Returns the largest dot product of a direction and a corner of a triangle; −∞ without triangles.
    pub fn extent_along(&self, direction: Vec3) -> f32 {
        let mut most = f32::NEG_INFINITY;
        self.descend(direction, |[low, high], leaf| {
            let Some((triangles, leaf)) = leaf else {
                // Rounding keeps the order of numbers, so no corner in the box is farther.
                let pick = |d: f32, low: f32, high: f32| if d < 0.0 { low } else { high };
                let farthest = Vec3::new(
                    pick(direction.x, low.x, high.x),
                    pick(direction.y, low.y, high.y),
                    pick(direction.z, low.z, high.z),
                );
                return direction.dot(farthest) > most;
            };
            for i in 0..triangles.len() {
                most =
                    leaf.triangle(i).into_iter().fold(most, |most, corner| most.max(direction.dot(corner)));
            }
            true
        });
        most
    }

    /// Visits boxes, those farthest along `toward` first. `visit` decides whether to enter a box, and receives the
    /// triangles of an entered leaf.
    fn descend(&self, toward: Vec3, mut visit: impl FnMut([Vec3; 2], Option<(&[u32], &Leaf)>) -> bool) {
        let mut waiting = Vec::new();
        if let Some(root) = self.tree.root() {
            waiting.extend(self.children(root));
            sort(&mut waiting, toward);
        }
        while let Some(next) = waiting.pop() {
            if !visit(next.bounds, None) {
                continue;
            }
            if let Some(leaf) = next.child.as_leaf() {
                visit(next.bounds, Some((self.tree.triangles(leaf), &self.tree.leaves[leaf])));
                continue;
            }
            let first = waiting.len();
            waiting.extend(self.children(next.child));
            sort(&mut waiting[first..], toward);
        }
    }

    fn children(&self, node: Child) -> impl Iterator<Item = Waiting> {
        let node = self.tree.node(node);
        let children = node.children().iter().enumerate();
        children.map(|(i, child)| Waiting { child: *child, bounds: corners(&node.boxes, i) })
    }
}

/// Puts the node farthest along `toward` last.
fn sort(nodes: &mut [Waiting], toward: Vec3) {
    let depth = |node: &Waiting| (node.bounds[0] + node.bounds[1]).dot(toward);
    nodes.sort_by(|a, b| depth(a).partial_cmp(&depth(b)).unwrap_or(Ordering::Equal));
}

fn corners(boxes: &Boxes, child: usize) -> [Vec3; 2] {
    [&boxes.min, &boxes.max].map(|bound| Vec3::new(bound[0][child], bound[1][child], bound[2][child]))
}

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::*;

    struct Taken {
        triangles: Vec<u32>,
        least: f32,
    }

    impl Sweep for Taken {
        fn wants(&self, [_, high]: [Vec3; 2]) -> bool {
            high.x >= self.least
        }

        fn take(&mut self, triangles: &[u32], _: &EightTriangles) {
            self.triangles.extend(triangles);
        }
    }

    #[test]
    fn all_triangles_that_are_wanted_are_taken_once() {
        let mut next = numbers(3);
        let mut point = || Vec3::new(next(), next(), next());
        for count in [0, 1, 8, 9, 500] {
            let triangles: Vec<[Vec3; 3]> = (0..count).map(|_| [point(), point(), point()]).collect();
            let bvh = Bvh::build(&triangles);
            let taken = |least: f32| {
                let mut taken = Taken { triangles: Vec::new(), least };
                bvh.sweep(Vec3::new(0.6, 0.0, 0.8), &mut taken);
                taken.triangles.sort_unstable();
                taken.triangles
            };
            assert_eq!(taken(0.0), (0..count).collect::<Vec<u32>>());
            let some = taken(0.9);
            let reaches = |t: &[Vec3; 3]| t.iter().any(|p| p.x >= 0.9);
            let expected = triangles.iter().filter(|t| reaches(t)).count();
            assert!(some.len() >= expected && some.windows(2).all(|pair| pair[0] < pair[1]));
            let direction = point() - Vec3::splat(0.5);
            let most =
                triangles.iter().flatten().map(|p| direction.dot(*p)).fold(f32::NEG_INFINITY, f32::max);
            assert_eq!(bvh.extent_along(direction), most);
        }
    }

    /// Those nearer to the viewer come first, as far as boxes show.
    #[test]
    fn the_farthest_come_first() {
        let sheet = |z: f32| [Vec3::new(0.0, 0.0, z), Vec3::new(1.0, 0.0, z), Vec3::new(0.0, 1.0, z)];
        let bvh = Bvh::build(&(0..64).map(|i| sheet(i as f32)).collect::<Vec<_>>());
        let mut taken = Taken { triangles: Vec::new(), least: 0.0 };
        bvh.sweep(Vec3::new(0.0, 0.0, 1.0), &mut taken);
        let leaves: Vec<u32> =
            taken.triangles.chunks(8).map(|leaf| leaf.iter().copied().max().unwrap()).collect();
        assert!(leaves.windows(2).all(|pair| pair[0] > pair[1]), "{leaves:?}");
    }
}
