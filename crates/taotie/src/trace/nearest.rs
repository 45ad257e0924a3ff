//! The hit nearest to a place on a ray.

use super::bvh::{Bvh, Hit};
use super::walk::{Met, Span, walk};
use super::{Ray, tree::WIDTH};
use crate::math::{Vec3, dispatch_pack};

/// A stretch of a ray on which the hit nearest to a place in it is sought: distances in lengths of the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Where it begins, at least 0.
    pub from: f32,
    /// What hits are to be near to.
    pub center: f32,
    /// Where it ends.
    pub to: f32,
}

/// The hit nearest to the centre of a stretch so far, with what was said of it.
#[derive(Debug, Clone, Copy)]
pub struct Nearest<T> {
    stretch: Stretch,
    best: Option<(Hit, T)>,
}

impl<T> Nearest<T> {
    /// Nothing yet.
    pub fn on(stretch: Stretch) -> Self {
        Self { stretch, best: None }
    }

    /// Takes a hit that lies on the stretch, is nearer than the best so far, and of which `judge` says something; of two
    /// equally near the one farther along the ray, then the triangle with the lower number. So the order of hits does not
    /// matter.
    pub fn offer(&mut self, hit: Hit, judge: impl FnOnce(&Hit) -> Option<T>) {
        if self.is_before(&hit)
            && let Some(said) = judge(&hit)
        {
            self.best = Some((hit, said));
        }
    }

    /// The best of all.
    pub fn best(self) -> Option<(Hit, T)> {
        self.best
    }

    fn is_before(&self, hit: &Hit) -> bool {
        let Stretch { from, center, to } = self.stretch;
        if !(from..=to).contains(&hit.distance) {
            return false;
        }
        let Some((best, _)) = &self.best else { return true };
        let [new, old] = [hit, best].map(|hit| (hit.distance - center).abs());
        let order = new.total_cmp(&old).then(best.distance.total_cmp(&hit.distance));
        order.then(hit.triangle.cmp(&best.triangle)).is_lt()
    }

    /// Where a better hit may still lie.
    fn span(&self) -> Span {
        let Stretch { from, center, to } = self.stretch;
        let reach = self.best.as_ref().map_or(f32::INFINITY, |(hit, _)| (hit.distance - center).abs());
        Span { from: from.max(center - reach), to: to.min(center + reach) }
    }
}

impl Bvh {
    /// The hit on a stretch of a ray that is nearest to its centre, of those of which `judge` says something. It may be
    /// asked of any hit, in any order; what it says of the nearest comes back with it.
    pub fn nearest_to<T>(
        &self,
        ray: &Ray,
        stretch: Stretch,
        judge: impl Fn(&Hit) -> Option<T>,
    ) -> Option<(Hit, T)> {
        let mut nearest = Nearest::on(stretch);
        let span = nearest.span();
        let meet = |met: Met, _: Span| {
            nearest.offer(self.hit(&met), &judge);
            nearest.span()
        };
        dispatch_pack!(self.level, P, token => walk::<P>(token, &self.tree, ray, span, meet));
        nearest.best()
    }

    /// Calls `take` with the number and the corners of every triangle near the box from `min` to `max`: of all that touch
    /// it, and of some beside it.
    pub fn near(&self, [min, max]: [Vec3; 2], mut take: impl FnMut(u32, [Vec3; 3])) {
        let [min, max] = [min.to_array(), max.to_array()];
        let mut waiting = Vec::with_capacity(64);
        if !self.tree.leaves.is_empty() {
            waiting.push((self.tree.levels.len(), 0));
        }
        while let Some((level, node)) = waiting.pop() {
            if level == 0 {
                let slots = self.tree.order[node * WIDTH..].iter().take(WIDTH).enumerate();
                slots.for_each(|(i, triangle)| take(*triangle, self.tree.leaves[node].triangle(i)));
                continue;
            }
            let mut touched = self.tree.levels[level - 1][node].touched(min, max);
            while touched != 0 {
                waiting.push((level - 1, node * WIDTH + touched.trailing_zeros() as usize));
                touched &= touched - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hit_nearest_to_the_centre_wins_and_of_equals_the_farther() {
        let sheet = |z: f32| [Vec3::new(-1.0, -1.0, z), Vec3::new(3.0, -1.0, z), Vec3::new(-1.0, 3.0, z)];
        let bvh = Bvh::build(&[sheet(1.0), sheet(2.0), sheet(4.0)]);
        let ray = Ray::new(Vec3::default(), Vec3::new(0.0, 0.0, 1.0));
        let found = |[from, center, to]: [f32; 3], judge: &dyn Fn(&Hit) -> Option<u32>| {
            bvh.nearest_to(&ray, Stretch { from, center, to }, judge).map(|(hit, said)| (hit.triangle, said))
        };
        let nearest = |stretch: [f32; 3]| found(stretch, &|_| Some(0)).map(|(triangle, _)| triangle);
        assert_eq!(nearest([0.0, 0.1, 9.0]), Some(0));
        assert_eq!(nearest([0.0, 3.5, 9.0]), Some(2));
        assert_eq!(nearest([0.0, 3.0, 9.0]), Some(2), "of equals the farther");
        assert_eq!(nearest([0.0, 1.4, 9.0]), Some(0));
        assert_eq!(nearest([1.5, 1.0, 9.0]), Some(1), "not before its beginning");
        assert_eq!(nearest([4.5, 5.0, 9.0]), None);
        let not_the_first = |hit: &Hit| (hit.triangle != 0).then_some(7);
        assert_eq!(found([0.0, 1.0, 9.0], &not_the_first), Some((1, 7)));
    }

    #[test]
    fn all_triangles_that_touch_a_box_are_near_it() {
        let cell = |i: u32| Vec3::new((i % 20) as f32, (i / 20 % 20) as f32, (i / 400) as f32);
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.3);
        let triangles: Vec<[Vec3; 3]> = (0..8000)
            .map(|i| [corner(0.0, 0.0), corner(0.9, 0.0), corner(0.0, 0.9)].map(|p| p + cell(i)))
            .collect();
        let bvh = Bvh::build(&triangles);
        let mut seen = vec![0; triangles.len()];
        bvh.near([Vec3::splat(4.5), Vec3::splat(7.5)], |t, corners| {
            assert_eq!(corners, triangles[t as usize]);
            seen[t as usize] += 1;
        });
        for (i, times) in seen.iter().enumerate() {
            let p = cell(i as u32);
            let touches =
                [p.x, p.y].iter().all(|v| (4.0..=7.0).contains(v)) && (4.5..=7.5).contains(&(p.z + 0.3));
            assert!(*times <= 1 && (*times == 1 || !touches), "{p:?}");
        }
        assert!(seen.iter().sum::<i32>() < 600);
    }
}
