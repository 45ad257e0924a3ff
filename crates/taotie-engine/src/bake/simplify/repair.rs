//! Removal of slivers and folds in a simplified surface.
//!
//! A sliver is a triangle so thin that its normal is rounding and its uvs are a line. A cap has a corner near the
//! middle of its longest edge: that edge is flipped, or the cap removed if no other triangle has the edge. A needle
//! has one short edge, which is collapsed. No change may bend the surface, make another sliver as thin, or change the
//! connectivity; so a wire keeps its long triangles.
//!
//! A fold is a facet that faces away from the surface normals at its corners: collapses near one another can turn a
//! small facet over. One of its edges is flipped or collapsed if that leaves fewer facets facing away and makes none
//! thinner than a sliver. A fin, two facets back to back on an edge of the surface, is removed.

use super::collapse::Reduced;
use super::fan::{Fans, Shape};
use crate::math::Vec3;

/// A sliver's height is less than this fraction of its longest edge.
const THIN: f64 = 1e-3;
/// Number of rounds, since one sliver may block another, and one fold may be on top of another.
const ROUNDS: usize = 4;
/// If more than one triangle in this many is a sliver, the surface itself is that thin.
const SLIVER_OF_MANY: usize = 2;
/// A flip must increase the height of the thinner triangle by this factor, so that none is flipped back and forth.
const BETTER: f64 = 1.1;
/// Below this height, as a fraction of the unit cube, a normal is rounding.
const ROUNDING: f64 = 1e-6;
/// The minimum cosine between normals before and after: that of 20°.
const STEADY: f64 = 0.94;

/// Returns the triangles with fewer slivers; unchanged if there are none.
pub(super) fn without_slivers(points: &[[f32; 3]], mut triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    for round in 0..ROUNDS {
        let slivers = slivers(points, &triangles);
        if slivers.is_empty() || round == 0 && slivers.len() * SLIVER_OF_MANY > triangles.len() {
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

/// If more than one triangle in this many faces away, the high-poly surface has no consistent outside there.
const FOLD_OF_MANY: usize = 20;
/// A changed facet must face the normals of its corners by at least this cosine: that of 78°.
const FACING: f64 = 0.2;

/// Returns the triangles with fewer folds; unchanged if there is none. `normals` are those of the high-poly surface
/// at the points, of any length.
pub(super) fn unfolded(points: &[[f32; 3]], normals: &[Vec3], mut triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    for _ in 0..ROUNDS {
        let mut folds = Folds { fans: Fans::new(points, triangles), normals, changed: false };
        let found = folds.found();
        if found.len() * FOLD_OF_MANY <= folds.fans.len() {
            found.into_iter().for_each(|t| folds.unfold(t));
        }
        let changed = folds.changed;
        triangles = folds.fans.into_triangles();
        if !changed {
            break;
        }
    }
    triangles
}

/// Moves points back to their original positions on the high-poly surface if a facet faces away from its normals.
pub(super) fn take_back(own: &[[f32; 3]], normals: &[Vec3], reduced: &mut Reduced) {
    let point = |v: u32, points: &[[f32; 3]]| Vec3::from_array(points[v as usize]).to_f64();
    let faces = |triangle: &[u32; 3], points: &[[f32; 3]]| {
        let [a, b, c] = triangle.map(|v| point(v, points));
        let facet = (b - a).cross(c - a).normalize_or(Vec3::splat(0.0));
        triangle.iter().all(|v| facet.dot(normals[*v as usize].to_f64()) >= FACING)
    };
    let turned: Vec<[u32; 3]> =
        reduced.triangles.iter().filter(|triangle| !faces(triangle, &reduced.points)).copied().collect();
    turned.as_flattened().iter().for_each(|v| reduced.points[*v as usize] = own[*v as usize]);
}

/// The surface while folds are removed one after the other.
struct Folds<'a> {
    fans: Fans<'a>,
    normals: &'a [Vec3],
    changed: bool,
}

impl Folds<'_> {
    /// Returns the facets that face away.
    fn found(&self) -> Vec<usize> {
        (0..self.fans.len()).filter(|t| self.cosine(self.fans.corners(*t)) < 0.0).collect()
    }

    /// Returns the cosine between a facet's normal and the mean of those at its corners; 0 if either is zero.
    fn cosine(&self, corners: [u32; 3]) -> f64 {
        let [a, b, c] = corners.map(|v| self.normals[v as usize].to_f64());
        self.fans.shape(corners).cosine(a + b + c)
    }

    fn unfold(&mut self, t: usize) {
        if self.fans.is_touched(t) {
            return;
        }
        let [a, b, c] = self.fans.longest_first(t);
        let turned = [[a, b, c], [b, c, a], [c, a, b]];
        self.changed |= turned.iter().any(|corners| self.take_fin_off(t, *corners))
            || turned.iter().any(|corners| self.flip(t, *corners))
            || turned.iter().any(|[a, b, _]| self.collapse(*a, *b) || self.collapse(*b, *a));
    }

    /// Returns `true` if a facet faces the normals of its corners and is not a sliver.
    fn is_sound(&self, corners: [u32; 3]) -> bool {
        self.cosine(corners) > FACING && self.fans.shape(corners).height() >= THIN
    }

    fn flip(&mut self, t: usize, corners: [u32; 3]) -> bool {
        let Some(flip) = self.fans.flip(t, corners) else { return false };
        let is_possible = flip.after.iter().all(|corners| self.is_sound(*corners));
        if is_possible {
            self.fans.take(&flip);
        }
        is_possible
    }

    /// Removes a facet that is back to back with another if nothing else is attached at their tip: the surface
    /// continues below them, at the opposite edge.
    fn take_fin_off(&mut self, t: usize, [a, b, tip]: [u32; 3]) -> bool {
        let &[one, other] = self.fans.around(tip) else { return false };
        let back = if one as usize == t { other } else { one } as usize;
        let is_possible = self.fans.opposite(back, b, a) == Some(tip)
            && self.fans.at_edge(a, b).len() > 2
            && self.fans.are_untouched(&[a, b])
            && self.fans.shape([b, a, tip]).cosine(self.normals[tip as usize].to_f64()) > FACING;
        if is_possible {
            self.fans.remove(t);
            self.fans.remove(back);
        }
        is_possible
    }

    /// Moves a vertex of a facet along an edge to another one, so that both facets at the edge vanish.
    fn collapse(&mut self, from: u32, to: u32) -> bool {
        let is_possible = self.fans.are_untouched(&[from, to])
            && self.fans.can_collapse(from, to)
            && self.fans.keeps_border(from, to)
            && self.fans.moved(from, to).iter().all(|[_, new]| self.is_sound(*new));
        if is_possible {
            self.fans.collapse(from, to);
        }
        is_possible
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
        let found = without_slivers(&points, triangles.clone());
        assert_eq!((found.len(), thin(&points, &found)), (4, 0), "{found:?}");
        assert!((area(&points, &found) - area(&points, &triangles)).abs() < 1e-9);
        assert_eq!(without_slivers(&points, found.clone()), found, "nothing is left to fix");
    }

    #[test]
    fn a_cap_at_the_border_is_taken_off() {
        let points = around(&[[0.5, 0.00001, 0.0]]);
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let found = without_slivers(&points, triangles);
        assert_eq!(found, [[1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    }

    /// Two points next to each other in the middle.
    #[test]
    fn a_needle_is_collapsed() {
        let points = around(&[[0.5, 0.5, 0.0], [0.5002, 0.5001, 0.0]]);
        let triangles = vec![[0, 1, 4], [1, 5, 4], [1, 2, 5], [2, 3, 5], [3, 4, 5], [3, 0, 4]];
        assert_eq!(thin(&points, &triangles), 2);
        let found = without_slivers(&points, triangles);
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
        assert_eq!(without_slivers(&points, triangles.clone()), triangles);
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

    const UP: Vec3 = Vec3::new(0.0, 0.0, 1.0);
    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    fn doubled_areas(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
        triangles.iter().map(|t| Shape::of(points, *t).vector.z).collect()
    }

    /// A square whose diagonal is outside it: one of its corners is pulled in past the other diagonal.
    #[test]
    fn a_fold_at_a_diagonal_is_flipped() {
        let mut points = CORNERS.to_vec();
        points[1] = [0.3, 0.6, 0.0];
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        assert!(doubled_areas(&points, &triangles)[0] < 0.0);
        let found = unfolded(&points, &[UP; 4], triangles.clone());
        // One triangle in two is too many to be a fold.
        assert_eq!(found, triangles);
        let mut folds = Folds { fans: Fans::new(&points, triangles), normals: &[UP; 4], changed: false };
        folds.unfold(0);
        let found = folds.fans.into_triangles();
        assert!(
            found.len() == 2 && doubled_areas(&points, &found).iter().all(|area| *area > 0.0),
            "{found:?}"
        );
    }

    /// A square, and on its diagonal two facets back to back, like an upright blade.
    #[test]
    fn a_fin_is_taken_off() {
        let points: Vec<[f32; 3]> = CORNERS.into_iter().chain([[0.9, 0.2, 0.01]]).collect();
        let square = vec![[0, 1, 2], [0, 2, 3]];
        let fin = |back: [u32; 3]| [square.clone(), vec![[0, 2, 4], back]].concat();
        let unfolded = |triangles: Vec<[u32; 3]>| {
            let mut folds = Folds { fans: Fans::new(&points, triangles), normals: &[UP; 5], changed: false };
            (2..4).for_each(|t| folds.unfold(t));
            folds.fans.into_triangles()
        };
        assert!(doubled_areas(&points, &fin([2, 0, 4]))[2] < 0.0);
        assert_eq!(unfolded(fin([2, 0, 4])), square);
        assert_ne!(unfolded(fin([0, 2, 4])), square, "two facets with the same orientation are not a fin");
    }

    /// A grid, one of whose inner points is pulled across the opposite edge.
    #[test]
    fn a_fold_in_a_plane_is_unfolded() {
        let side = 9;
        let mut points: Vec<[f32; 3]> =
            (0..side * side).map(|i| [(i % side) as f32 / 8.0, (i / side) as f32 / 8.0, 0.0]).collect();
        let mut triangles = Vec::new();
        for y in 0..side - 1 {
            for x in 0..side - 1 {
                let [a, b] = [y * side + x, (y + 1) * side + x].map(|v| v as u32);
                triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
            }
        }
        points[4 * side + 4] = [0.5 + 0.19, 0.5 - 0.03, 0.0];
        let normals = vec![UP; points.len()];
        let turned =
            |triangles: &[[u32; 3]]| doubled_areas(&points, triangles).iter().filter(|a| **a < 0.0).count();
        assert!(turned(&triangles) > 0);
        let found = unfolded(&points, &normals, triangles.clone());
        assert_eq!(turned(&found), 0, "{found:?}");
        let area: f64 = doubled_areas(&points, &found).iter().sum();
        assert!((area - 2.0).abs() < 1e-9, "{area}");
        assert_eq!(unfolded(&points, &normals, found.clone()), found, "nothing is left to unfold");
    }
}
