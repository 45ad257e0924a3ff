//! A bounding volume hierarchy over triangles: the hits of single rays, the closest points, and its boxes as a list.

use super::Ray;
use super::nearby::{Closest, Reach, closest, within};
use super::ray::{Cast, Met, Span, walk};
use super::tree::{Child, Tree, along_curve};
use crate::error::Result;
use crate::math::{SimdLevel, Vec3, dispatch_eight};
use crate::mesh::Point;
use fearless_simd::Level;
use std::ops::Range;

/// The maximum number of leaves in a cluster of triangles.
const CLUSTER: usize = 8;

/// An intersection of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index of the triangle as passed to [`Bvh::build`].
    pub triangle: u32,
    /// Weights of its corners.
    pub weights: [f32; 3],
    /// Distance in lengths of the ray's direction.
    pub distance: f32,
}

impl Hit {
    /// The point on the mesh from whose triangles the tree was built.
    #[inline]
    pub fn point(&self) -> Point {
        Point { triangle: self.triangle, weights: self.weights }
    }
}

/// Triangles sorted for ray tracing. Hits have the same bits on every machine.
pub struct Bvh {
    pub(super) tree: Tree,
    pub(super) level: Level,
}

impl Bvh {
    /// Sorts `triangles`, whose positions must be finite.
    pub fn build(triangles: &[[Vec3; 3]]) -> Self {
        Self::of(triangles.len(), |t| triangles[t])
    }

    /// Sorts the triangles 0 to `count` − 1, at most 2^32, whose finite corners are returned by `corners`. It is
    /// called several times.
    pub fn of(count: usize, corners: impl Fn(usize) -> [Vec3; 3] + Sync) -> Self {
        Self { tree: Tree::packed(along_curve(count, &corners), &corners), level: SimdLevel::fastest() }
    }

    /// Like [`Bvh::build`], for many rays: sorting takes five to ten times as long, and tracing a quarter to a third
    /// less time, or two thirds if triangles of very different sizes are mixed. Pays off above about eight rays per
    /// triangle. Hits are the same.
    pub fn for_many_rays(triangles: &[[Vec3; 3]]) -> Self {
        let corners = |t: usize| triangles[t];
        Self { tree: Tree::by_area(triangles.len(), &corners), level: SimdLevel::fastest() }
    }

    /// Returns the same tree, traced at a SIMD level other than the machine's fastest.
    ///
    /// # Errors
    /// If the SIMD level is not available on this machine.
    pub fn with_simd(self, simd: SimdLevel) -> Result<Self> {
        Ok(self.at(simd.dispatch()?))
    }

    pub(crate) fn at(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// Returns the SIMD level at which it is traced.
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Returns the nearest hit with a distance below `limit`.
    pub fn nearest(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        self.nearest_of(ray, limit, |_| true)
    }

    /// Returns the nearest hit below the distance `limit` that `counts`, which may be called for any hit in any
    /// order.
    pub(crate) fn nearest_of(&self, ray: &Ray, limit: f32, counts: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk::<true>(ray, Span { from: 0.0, to: limit }, |hit, span| {
            if hit.distance < limit && best.is_none_or(|best| comes_before(&hit, &best)) && counts(&hit) {
                best = Some(hit);
                return Span { from: 0.0, to: hit.distance };
            }
            span
        });
        best
    }

    /// Returns true if anything that `blocks` is hit at a distance below `limit`.
    pub fn occluded(&self, ray: &Ray, limit: f32, blocks: impl Fn(&Hit) -> bool) -> bool {
        let mut blocked = false;
        self.walk::<false>(ray, Span { from: 0.0, to: limit }, |hit, span| {
            blocked |= hit.distance < limit && blocks(&hit);
            if blocked { Span::NONE } else { span }
        });
        blocked
    }

    /// Returns the point of all triangles closest to `point`, if one is at most `reach` away.
    pub fn closest(&self, point: Vec3, reach: f32) -> Option<Closest> {
        self.closest_of(point, reach, |_| true)
    }

    /// Returns the closest point of all triangles that `counts`, at most `reach` away.
    pub(crate) fn closest_of(
        &self,
        point: Vec3,
        reach: f32,
        counts: impl Fn(u32) -> bool,
    ) -> Option<Closest> {
        let from = Reach { point, distance: reach };
        dispatch_eight!(self.level, P, token => closest::<P>(token, &self.tree, from, counts))
    }

    /// Returns the triangles whose boxes are within `reach` of a point, in any order; `None` if they are more than `most`.
    pub fn within(&self, point: Vec3, reach: f32, most: usize) -> Option<Vec<u32>> {
        let from = Reach { point, distance: reach };
        dispatch_eight!(self.level, P, token => within::<P>(token, &self.tree, from, most))
    }

    /// Returns all triangles in groups of up to 64 that lie close to each other.
    pub(crate) fn clusters(&self) -> impl Iterator<Item = Vec<u32>> {
        let leaves = 0..self.tree.leaves.len();
        leaves.step_by(CLUSTER).map(|first| {
            let leaves = first..self.tree.leaves.len().min(first + CLUSTER);
            leaves.flat_map(|leaf| self.tree.triangles(leaf)).copied().collect()
        })
    }

    fn walk<const NEAR_FIRST: bool>(&self, ray: &Ray, span: Span, mut meet: impl FnMut(Hit, Span) -> Span) {
        dispatch_eight!(self.level, P, token => {
            walk::<P, NEAR_FIRST>(token, &self.tree, Cast { ray, span }, |met, span| match self.hit(&met) {
                Some(hit) => meet(hit, span),
                None => span,
            });
        });
    }

    /// Returns the hit of a triangle; `None` for an absent one.
    pub(super) fn hit(&self, met: &Met) -> Option<Hit> {
        let triangle = self.tree.triangle(met.slot)?;
        Some(Hit { triangle, weights: met.weights, distance: met.distance })
    }
}

/// Returns true if a hit is nearer; at equal distances the smaller index wins, in any order of traversal.
fn comes_before(hit: &Hit, best: &Hit) -> bool {
    hit.distance < best.distance || hit.distance == best.distance && hit.triangle < best.triangle
}

/// An interval of a ray in which to find the hit nearest to its centre: distances in lengths of the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayInterval {
    /// The start of the interval, at least 0.
    pub from: f32,
    /// The distance to which hits should be near.
    pub center: f32,
    /// The end of the interval.
    pub to: f32,
}

/// The two hits nearest to the centre of an interval so far, with the values returned for them.
#[derive(Debug, Clone, Copy)]
pub struct Nearest<T> {
    interval: RayInterval,
    best: Option<(Hit, T)>,
    second: Option<(Hit, T)>,
}

impl<T: Copy> Nearest<T> {
    /// Starts without a hit.
    #[inline]
    pub fn on(interval: RayInterval) -> Self {
        Self { interval, best: None, second: None }
    }

    /// Offers a hit, which is accepted if it is in the interval, is nearer than the second so far, and `judge`
    /// returns a value; of two equally near, the one farther along the ray wins, then the triangle with the lower
    /// index. So the order of hits does not matter.
    #[inline]
    pub fn offer(&mut self, hit: Hit, judge: impl FnOnce(&Hit) -> Option<T>) {
        let RayInterval { from, to, .. } = self.interval;
        if !(from..=to).contains(&hit.distance) || !self.is_before(&hit, self.second.as_ref()) {
            return;
        }
        if let Some(said) = judge(&hit) {
            match self.is_before(&hit, self.best.as_ref()) {
                true => (self.second, self.best) = (self.best, Some((hit, said))),
                false => self.second = Some((hit, said)),
            }
        }
    }

    /// The best of all.
    #[inline]
    pub fn best(self) -> Option<(Hit, T)> {
        self.best
    }

    /// The best of the others.
    #[inline]
    pub fn second(self) -> Option<(Hit, T)> {
        self.second
    }

    #[inline]
    fn is_before(&self, hit: &Hit, other: Option<&(Hit, T)>) -> bool {
        let Some((other, _)) = other else { return true };
        let [new, old] = [hit, other].map(|hit| (hit.distance - self.interval.center).abs());
        let order = new.total_cmp(&old).then(other.distance.total_cmp(&hit.distance));
        order.then(hit.triangle.cmp(&other.triangle)).is_lt()
    }

    /// The interval in which a better hit is still possible.
    #[inline]
    fn span(&self) -> Span {
        let RayInterval { from, center, to } = self.interval;
        let reach = self.second.as_ref().map_or(f32::INFINITY, |(hit, _)| (hit.distance - center).abs());
        Span { from: from.max(center - reach), to: to.min(center + reach) }
    }
}

impl Bvh {
    /// Returns the two hits in an interval of a ray that are nearest to its centre, among those for which `judge`
    /// returns a value. It may be called for any hit, in any order; its values are returned with the hits.
    pub fn nearest_to<T: Copy>(
        &self,
        ray: &Ray,
        interval: RayInterval,
        judge: impl Fn(&Hit) -> Option<T>,
    ) -> Nearest<T> {
        let mut nearest = Nearest::on(interval);
        let span = nearest.span();
        let meet = |met: Met, _: Span| {
            if let Some(hit) = self.hit(&met) {
                nearest.offer(hit, &judge);
            }
            nearest.span()
        };
        dispatch_eight!(self.level, P, token => walk::<P, true>(token, &self.tree, Cast { ray, span }, meet));
        nearest
    }
}

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
    /// use taotie_engine::math::Vec3;
    /// use taotie_engine::trace::Bvh;
    ///
    /// let [x, y] = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    /// let flat = Bvh::build(&[[Vec3::default(), x, y]]).flat();
    /// assert_eq!((flat.boxes.len(), flat.boxes[0].triangles.clone(), flat.order), (1, 0..1, vec![0]));
    /// ```
    pub fn flat(&self) -> FlatBvh {
        let (boxes, triangles) = self.tree.counts();
        let mut flat = FlatBvh { boxes: Vec::with_capacity(boxes), order: Vec::with_capacity(triangles) };
        if let Some(root) = self.tree.root() {
            self.flatten(root, &mut flat);
        }
        flat
    }

    /// Adds the boxes in a node.
    fn flatten(&self, node: Child, flat: &mut FlatBvh) {
        let node = self.tree.node(node);
        for (i, child) in node.children().iter().enumerate() {
            let [low, high] = [&node.boxes.min, &node.boxes.max].map(|side| side.map(|axis| axis[i]));
            let place = flat.boxes.len();
            flat.boxes.push(FlatBox { low, high, skip: 0, triangles: 0..0 });
            if let Some(leaf) = child.as_leaf() {
                let first = flat.order.len() as u32;
                flat.order.extend(self.tree.triangles(leaf));
                flat.boxes[place].triangles = first..flat.order.len() as u32;
            } else {
                self.flatten(*child, flat);
            }
            flat.boxes[place].skip = flat.boxes.len() as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers in [0, 1).
    fn random(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as f32 / (1 << 24) as f32
    }

    fn random_point(state: &mut u32) -> Vec3 {
        Vec3::new(random(state), random(state), random(state))
    }

    #[test]
    fn agrees_with_testing_every_triangle() {
        let mut state = 1;
        let triangles: Vec<[Vec3; 3]> = (0..500)
            .map(|_| {
                let p = random_point(&mut state);
                [p, p + random_point(&mut state) * 0.1, p + random_point(&mut state) * 0.1]
            })
            .collect();
        let bvh = Bvh::build(&triangles);
        let mut hits = 0;
        for _ in 0..2000 {
            let ray = Ray::new(random_point(&mut state), random_point(&mut state) - random_point(&mut state));
            let brute = triangles
                .iter()
                .filter_map(|t| ray.intersect(*t))
                .map(|(t, _)| t)
                .fold(f32::INFINITY, f32::min);
            let found = bvh.nearest(&ray, f32::INFINITY).map_or(f32::INFINITY, |h| h.distance);
            assert_eq!(found, brute);
            assert_eq!(bvh.occluded(&ray, f32::INFINITY, |_| true), brute.is_finite());
            hits += usize::from(brute.is_finite());
        }
        assert!(hits > 200, "the test needs hits, found {hits}");
    }

    #[test]
    fn directions_with_negative_zeros_hit() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let bvh = Bvh::build(&[[corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]]);
        for zero in [0.0, -0.0] {
            let ray = Ray::new(Vec3::new(0.3, 0.3, 1.0), Vec3::new(zero, zero, -1.0));
            assert_eq!(bvh.nearest(&ray, 2.0).map(|hit| hit.distance), Some(1.0));
            assert!(bvh.occluded(&ray, 2.0, |_| true));
        }
    }

    #[test]
    fn the_nearest_is_hit_however_near() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let bvh = Bvh::build(&[[corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]]);
        for height in [0.0, 1e-7, 1e-5, 1e-4, 1e-3] {
            let ray = Ray::new(Vec3::new(0.3, 0.3, height), Vec3::new(0.0, 0.0, -1.0));
            let hit = bvh.nearest(&ray, 1.0).unwrap_or_else(|| panic!("missed at {height}"));
            assert!((hit.distance - height).abs() <= 1e-6 * height, "{} at {height}", hit.distance);
            assert!(bvh.occluded(&ray, 1.0, |_| true));
            assert!(bvh.nearest(&ray, height * 0.99).is_none(), "beyond its limit");
        }
    }

    #[test]
    fn what_does_not_count_is_passed_through() {
        let mut state = 5;
        let triangles: Vec<[Vec3; 3]> = (0..200).map(|_| [0; 3].map(|_| random_point(&mut state))).collect();
        let bvh = Bvh::build(&triangles);
        let odd = |hit: &Hit| hit.triangle % 2 == 1;
        for _ in 0..500 {
            let ray = Ray::new(random_point(&mut state), random_point(&mut state) - random_point(&mut state));
            let hits = triangles.iter().enumerate().skip(1).step_by(2);
            let brute = hits.filter_map(|(i, t)| Some((ray.intersect(*t)?.0, i as u32)));
            let nearest = brute.min_by(|a, b| a.0.total_cmp(&b.0));
            let found = bvh.nearest_of(&ray, f32::INFINITY, odd).map(|hit| (hit.distance, hit.triangle));
            assert_eq!(found, nearest);
        }
    }

    #[test]
    fn coordinates_that_overflow_lead_to_no_absent_child() {
        for size in [1e20, 1e30, 1e37, 3e38] {
            for count in [1, 7, 9, 65, 70] {
                let mut state = 3;
                let mut place = || (random_point(&mut state) - Vec3::splat(0.5)) * size;
                let triangles: Vec<[Vec3; 3]> = (0..count).map(|_| [0; 3].map(|_| place())).collect();
                let bvh = Bvh::build(&triangles);
                for _ in 0..200 {
                    for ray in [Ray::new(place(), place()), Ray::new(place(), place() * (1.0 / size))] {
                        let found = bvh.nearest(&ray, f32::INFINITY);
                        assert!(found.is_none_or(|hit| hit.triangle < count), "{size} {count}");
                        bvh.occluded(&ray, f32::INFINITY, |hit| hit.triangle >= count);
                    }
                }
            }
        }
    }

    #[test]
    fn empty_hits_nothing() {
        let ray = Ray::new(Vec3::default(), Vec3::new(0.0, 0.0, 1.0));
        assert!(Bvh::build(&[]).nearest(&ray, 1.0).is_none());
    }

    #[test]
    fn the_hit_nearest_to_the_centre_wins_and_of_equals_the_farther() {
        let sheet = |z: f32| [Vec3::new(-1.0, -1.0, z), Vec3::new(3.0, -1.0, z), Vec3::new(-1.0, 3.0, z)];
        let bvh = Bvh::build(&[sheet(1.0), sheet(2.0), sheet(4.0)]);
        let ray = Ray::new(Vec3::default(), Vec3::new(0.0, 0.0, 1.0));
        let found = |[from, center, to]: [f32; 3], judge: &dyn Fn(&Hit) -> Option<u32>| {
            let nearest = bvh.nearest_to(&ray, RayInterval { from, center, to }, judge);
            nearest.best().map(|(hit, said)| (hit.triangle, said))
        };
        let nearest = |interval: [f32; 3]| found(interval, &|_| Some(0)).map(|(triangle, _)| triangle);
        assert_eq!(nearest([0.0, 0.1, 9.0]), Some(0));
        assert_eq!(nearest([0.0, 3.5, 9.0]), Some(2));
        assert_eq!(nearest([0.0, 3.0, 9.0]), Some(2), "the farther of two equals");
        assert_eq!(nearest([0.0, 1.4, 9.0]), Some(0));
        assert_eq!(nearest([1.5, 1.0, 9.0]), Some(1), "not before its start");
        assert_eq!(nearest([4.5, 5.0, 9.0]), None);
        let second = |[from, center, to]: [f32; 3]| {
            let nearest = bvh.nearest_to(&ray, RayInterval { from, center, to }, |_| Some(0));
            nearest.second().map(|(hit, _)| hit.triangle)
        };
        assert_eq!([[0.0, 0.1, 9.0], [0.0, 3.5, 9.0], [1.5, 1.0, 3.0]].map(second), [Some(1), Some(1), None]);
        let not_the_first = |hit: &Hit| (hit.triangle != 0).then_some(7);
        assert_eq!(found([0.0, 1.0, 9.0], &not_the_first), Some((1, 7)));
    }

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
