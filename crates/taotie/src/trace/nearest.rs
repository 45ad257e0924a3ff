//! The hit nearest to a given distance along a ray.

use super::Ray;
use super::bvh::{Bvh, Hit};
use super::walk::{Cast, Met, Span, walk};
use crate::math::dispatch_eight;

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
            nearest.offer(self.hit(&met), &judge);
            nearest.span()
        };
        dispatch_eight!(self.level, P, token => walk::<P, true>(token, &self.tree, Cast { ray, span }, meet));
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

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
}
