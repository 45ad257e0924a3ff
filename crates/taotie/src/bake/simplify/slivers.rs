//! Removal of slivers in a simplified surface: triangles so thin that their normals are rounding and their uvs a
//! line.
//!
//! A cap has a corner near the middle of its longest edge: that edge is flipped, or the cap removed if no other
//! triangle has the edge. A needle has one short edge, which is collapsed. No change may bend the surface, make
//! another sliver as thin, or change the connectivity; so a wire keeps its long triangles.

use super::fan::{Fans, Shape};
use crate::math::Vec3;

/// A sliver's height is less than this fraction of its longest edge.
pub(super) const THIN: f64 = 1e-3;
/// Number of rounds, since one sliver may block another.
const ROUNDS: usize = 4;
/// If more than one triangle in this many is a sliver, the surface itself is that thin.
const OF_MANY: usize = 2;
/// A flip must increase the height of the thinner triangle by this factor, so that none is flipped back and forth.
const BETTER: f64 = 1.1;
/// Below this height, as a fraction of the unit cube, a normal is rounding.
const ROUNDING: f64 = 1e-6;
/// The minimum cosine between normals before and after: that of 20°.
const STEADY: f64 = 0.94;

/// Returns the triangles with fewer slivers; unchanged if there are none.
pub(super) fn repaired(points: &[[f32; 3]], mut triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    for round in 0..ROUNDS {
        let slivers = slivers(points, &triangles);
        if slivers.is_empty() || round == 0 && slivers.len() * OF_MANY > triangles.len() {
            break;
        }
        let mut mender = Mender { fans: Fans::new(points, triangles), changed: false };
        slivers.iter().for_each(|t| mender.repair(*t));
        let changed = mender.changed;
        triangles = mender.fans.into_triangles();
        if !changed {
            break;
        }
    }
    triangles
}

/// Returns the triangles that are slivers.
fn slivers(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<usize> {
    (0..triangles.len()).filter(|t| Shape::of(points, triangles[*t]).height() < THIN).collect()
}

/// The surface while slivers are removed one after the other.
struct Mender<'a> {
    fans: Fans<'a>,
    changed: bool,
}

impl Mender<'_> {
    fn repair(&mut self, t: usize) {
        if !self.fans.is_touched(t) {
            self.changed |= self.flip(t) || self.collapse(t);
        }
    }

    /// Flips the longest edge of a triangle, or removes the triangle if no other has that edge.
    fn flip(&mut self, t: usize) -> bool {
        let corners @ [a, b, _] = self.fans.longest_first(t);
        match self.fans.at_edge(a, b).len() {
            1 => self.fans.are_untouched(&corners) && self.take_off(t, corners),
            _ => self.flip_longest(t, corners),
        }
    }

    /// Removes a triangle whose other edges are each shared with one more triangle.
    fn take_off(&mut self, t: usize, [a, b, c]: [u32; 3]) -> bool {
        let is_inner = |a: u32, b: u32| self.fans.at_edge(a, b).len() == 2;
        let is_possible = is_inner(b, c) && is_inner(c, a);
        if is_possible {
            self.fans.remove(t);
        }
        is_possible
    }

    fn flip_longest(&mut self, t: usize, corners: [u32; 3]) -> bool {
        let Some(flip) = self.fans.flip(t, corners) else { return false };
        let [old, new] = [flip.before, flip.after].map(|pair| pair.map(|triangle| self.fans.shape(triangle)));
        let normal = old[0].vector + old[1].vector;
        let thinnest = |pair: &[Shape; 2]| pair[0].height().min(pair[1].height());
        let is_possible =
            thinnest(&new) > BETTER * thinnest(&old) && new.iter().all(|shape| shape.cosine(normal) > STEADY);
        if is_possible {
            self.fans.take(&flip);
        }
        is_possible
    }

    /// Collapses the shortest edge of a triangle, in the direction that leaves the triangles around less thin.
    fn collapse(&mut self, t: usize) -> bool {
        let [a, b, _] = self.fans.shortest_first(t);
        if !self.fans.are_untouched(&[a, b]) || !self.fans.can_collapse(a, b) {
            return false;
        }
        let [to_a, to_b] = [self.thinnest_after(b, a), self.thinnest_after(a, b)];
        let (from, to) = if to_b > to_a { (a, b) } else { (b, a) };
        let is_possible = to_a.max(to_b) > 0.0;
        if is_possible {
            self.fans.collapse(from, to);
        }
        is_possible
    }

    /// Returns the height of the thinnest triangle after moving a vertex to another one; 0 if that is not allowed.
    fn thinnest_after(&self, from: u32, to: u32) -> f64 {
        if !self.fans.keeps_border(from, to) {
            return 0.0;
        }
        let shapes = |pair: [[u32; 3]; 2]| pair.map(|triangle| self.fans.shape(triangle));
        let moved: Vec<[Shape; 2]> = self.fans.moved(from, to).into_iter().map(shapes).collect();
        let whole = moved.iter().fold(Vec3::<f64>::splat(0.0), |sum, [old, _]| sum + old.vector);
        let after = |[old, new]: &[Shape; 2]| {
            let direction = if old.altitude() > ROUNDING { old.vector } else { whole };
            let is_possible = new.cosine(direction) > STEADY && new.height() >= old.height().min(THIN);
            if is_possible { new.height() } else { 0.0 }
        };
        moved.iter().map(after).reduce(f64::min).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thin(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> usize {
        slivers(points, triangles).len()
    }

    /// The corners of a square, and points in it.
    fn around(inner: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        corners.into_iter().chain(inner.iter().copied()).collect()
    }

    fn area(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| Shape::of(points, *t).vector.length() * 0.5).sum()
    }

    /// Two triangles with a cap between them, whose corner is next to the middle of the diagonal.
    #[test]
    fn a_cap_is_flipped() {
        let points = around(&[[0.5, 0.50001, 0.0]]);
        let triangles = vec![[0, 1, 2], [0, 2, 4], [2, 3, 4], [3, 0, 4]];
        assert_eq!(thin(&points, &triangles), 1);
        let found = repaired(&points, triangles.clone());
        assert_eq!((found.len(), thin(&points, &found)), (4, 0), "{found:?}");
        assert!((area(&points, &found) - area(&points, &triangles)).abs() < 1e-9);
        assert_eq!(repaired(&points, found.clone()), found, "nothing is left to fix");
    }

    #[test]
    fn a_cap_at_the_border_is_taken_off() {
        let points = around(&[[0.5, 0.00001, 0.0]]);
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let found = repaired(&points, triangles);
        assert_eq!(found, [[1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    }

    /// Two points next to each other in the middle.
    #[test]
    fn a_needle_is_collapsed() {
        let points = around(&[[0.5, 0.5, 0.0], [0.5002, 0.5001, 0.0]]);
        let triangles = vec![[0, 1, 4], [1, 5, 4], [1, 2, 5], [2, 3, 5], [3, 4, 5], [3, 0, 4]];
        assert_eq!(thin(&points, &triangles), 2);
        let found = repaired(&points, triangles);
        assert_eq!((found.len(), thin(&points, &found)), (4, 0), "{found:?}");
        assert!((area(&points, &found) - 1.0).abs() < 1e-9);
    }

    /// A wire with three sides: long triangles whose short edges are the width of the wire.
    #[test]
    fn a_wire_stays() {
        let ring = |x: f32| [[x, 0.0, 0.0], [x, 4e-4, 0.0], [x, 0.0, 4e-4]];
        let points: Vec<[f32; 3]> = ring(0.0).into_iter().chain(ring(1.0)).collect();
        let mut triangles = Vec::new();
        for i in 0..3 {
            let j = (i + 1) % 3;
            triangles.extend([[i, i + 3, j], [j, i + 3, j + 3]]);
        }
        let mut mender = Mender { fans: Fans::new(&points, triangles.clone()), changed: false };
        assert_eq!(thin(&points, &triangles), 6);
        (0..6).for_each(|t| mender.repair(t));
        assert!(!mender.changed);
        assert_eq!(repaired(&points, triangles.clone()), triangles);
    }

    /// A surface that consists of a sliver, or is connected by one, is unchanged.
    #[test]
    fn nothing_vanishes() {
        let points = around(&[[0.5, 1e-5, 0.0], [1e-5, 0.0, 0.0]]);
        for triangle in [[0, 1, 4], [0, 5, 2]] {
            let mut mender = Mender { fans: Fans::new(&points, vec![triangle]), changed: false };
            mender.repair(0);
            assert_eq!(mender.fans.into_triangles(), [triangle]);
        }
    }
}
