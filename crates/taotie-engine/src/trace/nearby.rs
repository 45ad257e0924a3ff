//! The closest point of a surface to a given one, and the triangles within a distance of it.

use super::by_area::WIDTH;
use super::tree::{Boxes, Child, Leaf, STACK, Tree};
use crate::math::{Lane, Mask, Pack, Vec3, dispatch_eight};
use crate::mesh::Point;
use arrayvec::ArrayVec;
use fearless_simd::Level;

/// The closest point of a surface to another point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Index of its triangle.
    pub triangle: u32,
    /// Weights of the triangle's corners.
    pub weights: [f32; 3],
    /// The distance to it.
    pub distance: f32,
}

impl Closest {
    /// The point on the mesh from whose triangles the tree was built.
    pub fn point(&self) -> Point {
        Point { triangle: self.triangle, weights: self.weights }
    }
}

/// Returns the largest distance of some points, at most eight, from a triangle.
pub fn farthest_distance(level: Level, triangle: [Vec3; 3], points: &[Vec3]) -> f32 {
    let mut places = [[0.0; WIDTH]; 3];
    for (i, point) in points.iter().enumerate() {
        places.iter_mut().zip(point.to_array()).for_each(|(axis, v)| axis[i] = v);
    }
    let mut squared = [0.0; WIDTH];
    dispatch_eight!(level, P, token => {
        let corners = triangle.map(|corner| splat::<P>(token, corner));
        for k in (0..points.len()).step_by(P::LANES) {
            let [x, y, z] = places.each_ref().map(|axis| P::load(token, &axis[k..]));
            closest_point(corners, Vec3::new(x, y, z)).1.store(&mut squared[k..]);
        }
    });
    squared[..points.len()].iter().fold(0.0, |most: f32, v| most.max(*v)).sqrt()
}

/// A search for the closest point: the point from which, and the largest distance.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    pub point: Vec3,
    pub distance: f32,
}

/// Returns the closest point of the triangles that `counts`. Visits nodes from near to far, and skips those farther
/// away than the best so far.
#[inline(always)]
pub(super) fn closest<P: Pack>(
    token: P::Token,
    tree: &Tree,
    from: Reach,
    counts: impl Fn(u32) -> bool,
) -> Option<Closest> {
    let point = from.point;
    let mut best: Option<(f32, Closest)> = None;
    let mut limit = from.distance * from.distance;
    let mut waiting: ArrayVec<(f32, Child), STACK> = ArrayVec::new();
    waiting.extend(tree.root().map(|root| (0.0, root)));
    while let Some((squared, child)) = waiting.pop() {
        if squared > limit {
            continue;
        }
        let Some(leaf) = child.as_leaf() else {
            let (first, node) = (waiting.len(), tree.node(child));
            let distances = squared_distances::<P>(token, &node.boxes, point);
            let near = distances.into_iter().zip(node.children()).filter(|(squared, _)| *squared <= limit);
            near.for_each(|(squared, child)| waiting.push((squared, *child)));
            waiting[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
            continue;
        };
        let points = ClosestPoints::new::<P>(token, &tree.leaves[leaf], point);
        for (i, triangle) in tree.triangles(leaf).iter().enumerate() {
            let squared = points.squared[i];
            let is_before = best.is_none_or(|(least, found)| {
                squared < least || squared == least && *triangle < found.triangle
            });
            if squared <= limit && is_before && counts(*triangle) {
                limit = squared;
                let weights = [0, 1, 2].map(|corner: usize| points.weights[corner][i]);
                best = Some((squared, Closest { triangle: *triangle, weights, distance: squared.sqrt() }));
            }
        }
    }
    best.map(|(_, closest)| closest)
}

/// The closest points of the triangles of a leaf.
struct ClosestPoints {
    /// The weights of their corners.
    weights: [[f32; WIDTH]; 3],
    /// Their squared distances; NaN for absent triangles.
    squared: [f32; WIDTH],
}

impl ClosestPoints {
    #[inline(always)]
    fn new<P: Pack>(token: P::Token, leaf: &Leaf, point: Vec3) -> Self {
        let mut points = Self { weights: [[0.0; WIDTH]; 3], squared: [0.0; WIDTH] };
        let point = splat::<P>(token, point);
        for k in (0..WIDTH).step_by(P::LANES) {
            let load = |axis: &[f32; WIDTH]| P::load(token, &axis[k..]);
            let [a, b, c] = &leaf.corners;
            let [a, b, c] = [a, b, c].map(|[x, y, z]| Vec3::new(load(x), load(y), load(z)));
            let (weights, squared) = closest_point([a, b, c], point);
            squared.store(&mut points.squared[k..]);
            for (weight, to) in weights.into_iter().zip(&mut points.weights) {
                weight.store(&mut to[k..]);
            }
        }
        points
    }
}

/// Returns the triangles whose boxes are within a distance of a point; `None` if they are more than `most`.
#[inline(always)]
pub(super) fn within<P: Pack>(token: P::Token, tree: &Tree, from: Reach, most: usize) -> Option<Vec<u32>> {
    let (limit, mut found) = (from.distance * from.distance, Vec::new());
    let mut waiting: ArrayVec<Child, STACK> = ArrayVec::from_iter(tree.root());
    while let Some(child) = waiting.pop() {
        let Some(leaf) = child.as_leaf() else {
            let node = tree.node(child);
            let distances = squared_distances::<P>(token, &node.boxes, from.point).into_iter();
            let near = distances.zip(node.children()).filter(|(squared, _)| *squared <= limit);
            waiting.extend(near.map(|(_, child)| *child));
            continue;
        };
        let distances = squared_distances::<P>(token, &boxes(&tree.leaves[leaf]), from.point);
        let slots = tree.triangles(leaf).iter().zip(distances);
        found.extend(slots.filter(|(_, squared)| *squared <= limit).map(|(triangle, _)| *triangle));
        if found.len() > most {
            return None;
        }
    }
    Some(found)
}

/// The box around each triangle.
#[inline(always)]
fn boxes(leaf: &Leaf) -> Boxes {
    let [a, b, c] = &leaf.corners;
    let of = |pick: fn(f32, f32) -> f32| {
        std::array::from_fn(|axis| std::array::from_fn(|i| pick(pick(a[axis][i], b[axis][i]), c[axis][i])))
    };
    Boxes { min: of(f32::min), max: of(f32::max) }
}

/// The squared distance to each box, 0 inside.
#[inline(always)]
fn squared_distances<P: Pack>(token: P::Token, boxes: &Boxes, point: Vec3) -> [f32; WIDTH] {
    let mut squared = [0.0; WIDTH];
    for k in (0..WIDTH).step_by(P::LANES) {
        let zero = P::splat(token, 0.0);
        let mut sum = zero;
        for (axis, v) in point.to_array().into_iter().enumerate() {
            let v = P::splat(token, v);
            let (min, max) = (P::load(token, &boxes.min[axis][k..]), P::load(token, &boxes.max[axis][k..]));
            let away = (min - v).max(v - max).max(zero);
            sum = sum + away * away;
        }
        sum.store(&mut squared[k..]);
    }
    squared
}

#[inline(always)]
fn splat<P: Pack>(token: P::Token, v: Vec3) -> Vec3<P> {
    Vec3::new(P::splat(token, v.x), P::splat(token, v.y), P::splat(token, v.z))
}

/// The weights of the corners at the point of a triangle closest to `p`, and the squared distance to it.
#[inline(always)]
fn closest_point<L: Lane>([a, b, c]: [Vec3<L>; 3], p: Vec3<L>) -> ([L; 3], L) {
    let weights = closest_weights([a, b, c], p);
    let away = a * weights[0] + b * weights[1] + c * weights[2] - p;
    (weights, away.dot(away))
}

/// The weights of the corners at the point of a triangle closest to `p`.
///
/// Source: Ericson 2004, "Real-Time Collision Detection", 5.1.5, without branches: all regions are computed, and the
/// first one that holds the point is selected last.
#[inline(always)]
fn closest_weights<L: Lane>([a, b, c]: [Vec3<L>; 3], p: Vec3<L>) -> [L; 3] {
    let (zero, one) = (p.x.lit(0.0), p.x.lit(1.0));
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    let (vc, vb, va) = (d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4);
    let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
    let along_bc = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    let along_ca = d2 / (d2 - d6);
    let along_ab = d1 / (d1 - d3);
    let on_bc = va.le(zero).and(d3.le(d4)).and(d6.le(d5)).and((d6 - d5).lt(d4 - d3));
    let on_ca = vb.le(zero).and(zero.le(d2)).and(d6.le(zero)).and(d6.lt(d2));
    let on_ab = vc.le(zero).and(zero.le(d1)).and(d3.le(zero)).and(d3.lt(d1));
    let regions = [
        (on_bc, [zero, one - along_bc, along_bc]),
        (on_ca, [one - along_ca, zero, along_ca]),
        (zero.le(d6).and(d5.le(d6)), [zero, zero, one]),
        (on_ab, [one - along_ab, along_ab, zero]),
        (zero.le(d3).and(d4.le(d3)), [zero, one, zero]),
        (d1.le(zero).and(d2.le(zero)), [one, zero, zero]),
    ];
    regions.into_iter().fold([one - v - w, v, w], |weights, (is_in, region)| {
        std::array::from_fn(|corner| L::select(is_in, region[corner], weights[corner]))
    })
}

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::*;
    use crate::math::SimdLevel;
    use crate::trace::Bvh;
    use std::collections::HashSet;

    #[test]
    fn triangles_within_a_distance_are_those_that_are_near() {
        let mut next = numbers(1);
        let mut point = || Vec3::new(next(), next(), next());
        let triangles: Vec<[Vec3; 3]> = (0..300)
            .map(|_| {
                let p = point();
                [p, p + point() * 0.1, p + point() * 0.1]
            })
            .collect();
        let bvh = Bvh::build(&triangles);
        for _ in 0..100 {
            let p = point();
            let found: HashSet<u32> = bvh.within(p, 0.2, usize::MAX).unwrap().into_iter().collect();
            let is_near =
                |t: &u32| farthest_distance(SimdLevel::fastest(), triangles[*t as usize], &[p]) <= 0.2;
            assert!((0..300).filter(is_near).all(|t| found.contains(&t)));
            // Boxes are no larger than 0.1 by 0.1 by 0.1.
            let is_far =
                |t: &u32| farthest_distance(SimdLevel::fastest(), triangles[*t as usize], &[p]) > 0.2 + 0.18;
            assert!(!found.iter().any(is_far));
            assert!(found.is_empty() || bvh.within(p, 0.2, found.len() - 1).is_none());
        }
        let mut all: Vec<u32> = bvh.clusters().flatten().collect();
        all.sort_unstable();
        assert_eq!(all, (0..300).collect::<Vec<u32>>());
    }

    #[test]
    fn no_point_of_any_triangle_is_closer() {
        let mut next = numbers(0);
        let mut point = || Vec3::new(next(), next(), next());
        let triangles: Vec<[Vec3; 3]> = (0..300)
            .map(|_| {
                let p = point();
                [p, p + point() * 0.2, p + point() * 0.2]
            })
            .collect();
        let bvh = Bvh::build(&triangles);
        for _ in 0..300 {
            let p = point() * 2.0 - Vec3::splat(0.5);
            let found = bvh.closest(p, f32::INFINITY).unwrap();
            // A grid over every triangle, including its borders: no point may be closer, and the best hardly farther.
            let steps = 24;
            let grid = |[a, b, c]: [Vec3; 3]| {
                (0..=steps).flat_map(move |i| {
                    (0..=steps - i).map(move |k| {
                        let (v, w) = (i as f32 / steps as f32, k as f32 / steps as f32);
                        a * (1.0 - v - w) + b * v + c * w
                    })
                })
            };
            let least = triangles.iter().flat_map(|t| grid(*t)).map(|q| (q - p).length());
            let least = least.fold(f32::INFINITY, f32::min);
            assert!(found.distance <= least + 1e-6, "{} against {least}", found.distance);
            assert!(found.distance >= least - 0.02, "{} against {least}", found.distance);
            let corners = triangles[found.triangle as usize];
            let at =
                corners[0] * found.weights[0] + corners[1] * found.weights[1] + corners[2] * found.weights[2];
            assert!(((at - p).length() - found.distance).abs() < 1e-6);
            assert!(bvh.closest(p, found.distance * 0.99).is_none(), "beyond its reach");
            let other = bvh.closest_of(p, f32::INFINITY, |triangle| triangle != found.triangle).unwrap();
            assert!(other.triangle != found.triangle && other.distance >= found.distance);
            let rest = (0..300).filter(|t| *t != found.triangle as usize).map(|t| triangles[t]);
            let least =
                rest.map(|t| farthest_distance(SimdLevel::fastest(), t, &[p])).fold(f32::INFINITY, f32::min);
            assert_eq!(other.distance, least);
        }
    }

    #[test]
    fn infinite_squared_distances_lead_to_no_absent_child() {
        for size in [1e19, 1e20, 1e30, 1e37, f32::MAX] {
            for count in [1, 7, 9, 65, 70] {
                let at = |i: usize| size * ((i % 7) as f32 / 7.0);
                let corners = |i| {
                    [[0, 0, 0], [1, 0, 2], [0, 3, 1]]
                        .map(|k: [usize; 3]| Vec3::from_array(k.map(|k| at(i + k))))
                };
                let triangles: Vec<[Vec3; 3]> = (0..count).map(corners).collect();
                let bvh = Bvh::build(&triangles);
                for point in [Vec3::splat(-size), Vec3::splat(size), Vec3::default()] {
                    let found = bvh.closest(point, f32::INFINITY);
                    assert!(found.is_none_or(|found| (found.triangle as usize) < count), "{size} {count}");
                }
            }
        }
    }

    #[test]
    fn triangles_without_area_have_a_closest_point() {
        let p = Vec3::new(1.0, 0.0, 0.0);
        let bvh = Bvh::build(&[[p; 3], [Vec3::default(), p, p * 2.0]]);
        let found = bvh.closest(Vec3::new(1.0, 1.0, 0.0), 10.0).unwrap();
        assert_eq!(found.distance, 1.0);
        assert!(Bvh::build(&[]).closest(p, 10.0).is_none());
    }
}
