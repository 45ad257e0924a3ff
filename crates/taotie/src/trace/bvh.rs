//! A bounding volume hierarchy over triangles.

use super::Ray;
use super::by_area::by_area;
use super::nearby::{Closest, closest, within};
use super::tree::{Tree, along_curve};
use super::walk::{Cast, Met, Span, walk};
use crate::error::Result;
use crate::math::{SimdLevel, Vec3, dispatch_eight};
use crate::mesh::Point;
use fearless_simd::Level;

/// The maximum number of triangles in a cluster.
const CLUSTER: usize = 64;

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
        Self { tree: Tree::new(along_curve(count, &corners), &corners), level: SimdLevel::fastest() }
    }

    /// Like [`Bvh::build`], for many rays: sorting takes about seventeen times as long, and tracing a fifth less
    /// time. Pays off above about four rays per triangle. Hits are the same.
    pub fn for_many_rays(triangles: &[[Vec3; 3]]) -> Self {
        let corners = |t: usize| triangles[t];
        Self { tree: Tree::new(by_area(triangles.len(), &corners), &corners), level: SimdLevel::fastest() }
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

    /// Returns the nearest hit with a distance below `limit`.
    pub fn nearest(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        self.nearest_of(ray, limit, |_| true)
    }

    /// Returns the nearest hit below the distance `limit` that `counts`, which may be called for any hit in any
    /// order.
    pub fn nearest_of(&self, ray: &Ray, limit: f32, counts: impl Fn(&Hit) -> bool) -> Option<Hit> {
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
    pub fn closest_of(&self, point: Vec3, reach: f32, counts: impl Fn(u32) -> bool) -> Option<Closest> {
        closest(&self.tree, point, reach, counts)
    }

    /// Returns the triangles whose boxes are within `reach` of a point, in any order; `None` if they are more than `most`.
    pub fn within(&self, point: Vec3, reach: f32, most: usize) -> Option<Vec<u32>> {
        within(&self.tree, point, reach, most)
    }

    /// Returns all triangles in groups of up to 64 that lie close to each other.
    pub fn clusters(&self) -> std::slice::Chunks<'_, u32> {
        self.tree.order.chunks(CLUSTER)
    }

    fn walk<const NEAR_FIRST: bool>(&self, ray: &Ray, span: Span, mut meet: impl FnMut(Hit, Span) -> Span) {
        dispatch_eight!(self.level, P, token => {
            walk::<P, NEAR_FIRST>(token, &self.tree, Cast { ray, span }, |met, span| meet(self.hit(&met), span));
        });
    }

    pub(super) fn hit(&self, met: &Met) -> Hit {
        Hit { triangle: self.tree.order[met.slot], weights: met.weights, distance: met.distance }
    }
}

/// Returns true if a hit is nearer; at equal distances the smaller index wins, in any order of traversal.
fn comes_before(hit: &Hit, best: &Hit) -> bool {
    hit.distance < best.distance || hit.distance == best.distance && hit.triangle < best.triangle
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
}
