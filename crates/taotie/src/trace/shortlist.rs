//! The leaves around a place, for rays that begin and end there.

use super::bvh::{Bvh, Hit};
use super::tree::{Boxes, WIDTH};
use super::walk::{Met, Slabs, Span, meet_leaf};
use super::{Ray, walk::walk};
use crate::math::{Pack, Vec3, dispatch_pack};

/// The leaves of a [`Bvh`] that touch a box, so that many short rays inside it need not walk the tree from its root.
#[derive(Default)]
pub struct Shortlist {
    leaves: Vec<u32>,
    boxes: Vec<Boxes>,
}

impl Bvh {
    /// Makes `list` that of the box from `min` to `max`; `false` where it would hold more than `most` leaves.
    pub fn shortlist(&self, [min, max]: [Vec3; 2], most: usize, list: &mut Shortlist) -> bool {
        list.leaves.clear();
        list.boxes.clear();
        let [min, max] = [min.to_array(), max.to_array()];
        let mut waiting: Vec<(usize, usize)> = Vec::new();
        if !self.tree.leaves.is_empty() {
            waiting.push((self.tree.levels.len() - 1, 0));
        }
        while let Some((level, node)) = waiting.pop() {
            let boxes = &self.tree.levels[level][node];
            let mut touched = touched(boxes, min, max);
            while touched != 0 {
                let child = touched.trailing_zeros() as usize;
                touched &= touched - 1;
                match level {
                    0 if list.leaves.len() == most => return false,
                    0 => list.push((node * WIDTH + child) as u32, boxes.get(child)),
                    _ => waiting.push((level - 1, node * WIDTH + child)),
                }
            }
        }
        true
    }

    /// The hit that `counts` within `span`, lengths of the ray's direction, whose distance is nearest to `center`; of two
    /// equally near the farther along the ray. With a list, only its leaves are looked at.
    pub fn nearest_to(
        &self,
        ray: &Ray,
        [from, center, to]: [f32; 3],
        among: Option<&Shortlist>,
        counts: impl Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let away = |hit: &Hit| (hit.distance - center).abs();
        let meet = |met: Met, span: Span| {
            let hit =
                Hit { triangle: self.tree.order[met.slot], weights: met.weights, distance: met.distance };
            let is_nearer = best.is_none_or(|best| {
                let order = away(&hit).total_cmp(&away(&best));
                let order = order.then(best.distance.total_cmp(&hit.distance));
                order.then(hit.triangle.cmp(&best.triangle)).is_lt()
            });
            if !is_nearer || !counts(&hit) {
                return span;
            }
            best = Some(hit);
            Span { from: span.from.max(center - away(&hit)), to: span.to.min(center + away(&hit)) }
        };
        let span = Span { from: from.max(0.0), to };
        match among {
            None => dispatch_pack!(self.level, P, token => walk::<P>(token, &self.tree, ray, span, meet)),
            Some(list) => {
                dispatch_pack!(self.level, P, token => walk_list::<P>(token, (self, list), ray, span, meet));
            }
        }
        best
    }
}

impl Shortlist {
    fn push(&mut self, leaf: u32, bounds: [[f32; 3]; 2]) {
        let place = self.leaves.len() % WIDTH;
        if place == 0 {
            self.boxes.push(Boxes::EMPTY);
        }
        if let Some(boxes) = self.boxes.last_mut() {
            boxes.set(place, bounds);
        }
        self.leaves.push(leaf);
    }
}

#[inline(always)]
fn walk_list<P: Pack>(
    token: P::Token,
    (bvh, list): (&Bvh, &Shortlist),
    ray: &Ray,
    mut span: Span,
    mut meet: impl FnMut(Met, Span) -> Span,
) {
    let slabs = Slabs::new(ray);
    for (group, boxes) in list.boxes.iter().enumerate() {
        let (mut hit, _) = slabs.entries::<P>(token, boxes, span);
        while hit != 0 {
            let place = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let leaf = list.leaves[group * WIDTH + place] as usize;
            span = meet_leaf::<P>(token, &bvh.tree.leaves[leaf], ray, span, |i, distance, weights, span| {
                meet(Met { slot: leaf * WIDTH + i, distance, weights }, span)
            });
        }
    }
}

/// Which boxes touch that from `min` to `max`, a bit each.
fn touched(boxes: &Boxes, min: [f32; 3], max: [f32; 3]) -> u32 {
    let mut touched = 0;
    for i in 0..WIDTH {
        let mut touches = true;
        for axis in 0..3 {
            touches &= boxes.min[axis][i] <= max[axis] && boxes.max[axis][i] >= min[axis];
        }
        touched |= u32::from(touches) << i;
    }
    touched
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bumpy sheet of 2 · 40 · 40 triangles over the unit square.
    fn sheet() -> Vec<[Vec3; 3]> {
        let at = |x: i32, y: i32| {
            let height = ((x * 7 + y * 13) % 5) as f32 * 0.01;
            Vec3::new(x as f32 / 40.0, y as f32 / 40.0, height)
        };
        let cells = (0..40).flat_map(|y| (0..40).map(move |x| (x, y)));
        cells
            .flat_map(|(x, y)| {
                [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]]
            })
            .collect()
    }

    #[test]
    fn a_list_and_the_whole_tree_find_the_same() {
        let bvh = Bvh::build(&sheet());
        let mut list = Shortlist::default();
        let (low, high) = (Vec3::new(0.4, 0.4, -0.2), Vec3::new(0.6, 0.6, 0.2));
        assert!(bvh.shortlist([low, high], 1000, &mut list));
        assert!(list.leaves.len() < 60, "{}", list.leaves.len());
        assert!(!bvh.shortlist([low, high], 3, &mut Shortlist::default()));
        assert!(bvh.shortlist([low, high], 1000, &mut list));
        for i in 0..100 {
            let p = Vec3::new(0.45 + (i % 10) as f32 * 0.011, 0.45 + (i / 10) as f32 * 0.0113, -0.15);
            let ray = Ray::new(p, Vec3::new(0.1, -0.05, 1.0));
            let span = [0.0, 0.15, 0.3];
            let found = bvh.nearest_to(&ray, span, None, |_| true);
            assert!(found.is_some());
            assert_eq!(found, bvh.nearest_to(&ray, span, Some(&list), |_| true));
        }
    }

    #[test]
    fn the_hit_nearest_to_the_centre_wins_and_of_equals_the_farther() {
        let sheet = |z: f32| [Vec3::new(-1.0, -1.0, z), Vec3::new(3.0, -1.0, z), Vec3::new(-1.0, 3.0, z)];
        let bvh = Bvh::build(&[sheet(1.0), sheet(2.0), sheet(4.0)]);
        let ray = Ray::new(Vec3::default(), Vec3::new(0.0, 0.0, 1.0));
        let nearest = |span: [f32; 3]| bvh.nearest_to(&ray, span, None, |_| true).map(|hit| hit.triangle);
        assert_eq!(nearest([0.0, 0.1, 9.0]), Some(0));
        assert_eq!(nearest([0.0, 3.5, 9.0]), Some(2));
        assert_eq!(nearest([0.0, 3.0, 9.0]), Some(2), "of equals the farther");
        assert_eq!(nearest([0.0, 1.4, 9.0]), Some(0));
        assert_eq!(nearest([1.5, 1.0, 9.0]), Some(1), "not before its beginning");
        assert_eq!(nearest([4.5, 5.0, 9.0]), None);
        let odd = bvh.nearest_to(&ray, [0.0, 1.0, 9.0], None, |hit| hit.triangle != 0);
        assert_eq!(odd.map(|hit| hit.triangle), Some(1));
    }
}
