//! The closest point of a surface to a given one, and the triangles within a distance of it.

use super::tree::{Boxes, Leaf, Tree, WIDTH};
use crate::math::Vec3;
use crate::mesh::Point;
use arrayvec::ArrayVec;

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

/// Returns the distance of a point from a triangle.
pub fn distance_to_triangle(corners: [Vec3; 3], point: Vec3) -> f32 {
    let weights = closest_weights(corners, point);
    (corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2] - point).length()
}

/// The maximum number of nodes waiting to be visited: the siblings of the visited node on each of 11 levels.
const STACK: usize = 11 * (WIDTH - 1) + WIDTH;

/// Returns the closest point of the triangles that `counts`. Visits nodes from near to far, and skips those farther
/// away than the best so far.
pub(super) fn closest(tree: &Tree, point: Vec3, reach: f32, counts: impl Fn(u32) -> bool) -> Option<Closest> {
    let mut best: Option<(f32, Closest)> = None;
    let mut limit = reach * reach;
    let mut waiting: ArrayVec<(f32, usize, usize), STACK> = ArrayVec::new();
    if !tree.leaves.is_empty() {
        waiting.push((0.0, tree.levels.len(), 0));
    }
    while let Some((squared, level, node)) = waiting.pop() {
        if squared > limit {
            continue;
        }
        if level > 0 {
            let first = waiting.len();
            let distances = squared_distances(&tree.levels[level - 1][node], point);
            let present = distances.into_iter().take(tree.children(level, node));
            for (i, squared) in present.enumerate().filter(|(_, squared)| *squared <= limit) {
                waiting.push((squared, level - 1, node * WIDTH + i));
            }
            waiting[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
            continue;
        }
        for (i, triangle) in tree.order[node * WIDTH..].iter().take(WIDTH).enumerate() {
            let corners = tree.leaves[node].triangle(i);
            let weights = closest_weights(corners, point);
            let away = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2] - point;
            let squared = away.dot(away);
            let is_before = best.is_none_or(|(least, found)| {
                squared < least || squared == least && *triangle < found.triangle
            });
            if squared <= limit && is_before && counts(*triangle) {
                limit = squared;
                best = Some((squared, Closest { triangle: *triangle, weights, distance: squared.sqrt() }));
            }
        }
    }
    best.map(|(_, closest)| closest)
}

/// Returns the triangles whose boxes are within `reach` of a point; `None` if they are more than `most`.
pub(super) fn within(tree: &Tree, point: Vec3, reach: f32, most: usize) -> Option<Vec<u32>> {
    let (limit, mut found) = (reach * reach, Vec::new());
    let mut waiting: ArrayVec<(usize, usize), STACK> = ArrayVec::new();
    if !tree.leaves.is_empty() {
        waiting.push((tree.levels.len(), 0));
    }
    while let Some((level, node)) = waiting.pop() {
        if level > 0 {
            let distances = squared_distances(&tree.levels[level - 1][node], point);
            let present = distances.into_iter().take(tree.children(level, node)).enumerate();
            let near = present.filter(|(_, squared)| *squared <= limit);
            waiting.extend(near.map(|(i, _)| (level - 1, node * WIDTH + i)));
            continue;
        }
        let distances = squared_distances(&boxes(&tree.leaves[node]), point);
        let slots = tree.order[node * WIDTH..].iter().zip(distances);
        found.extend(slots.filter(|(_, squared)| *squared <= limit).map(|(triangle, _)| *triangle));
        if found.len() > most {
            return None;
        }
    }
    Some(found)
}

/// The box around each triangle.
fn boxes(leaf: &Leaf) -> Boxes {
    let [a, b, c] = &leaf.corners;
    let of = |pick: fn(f32, f32) -> f32| {
        std::array::from_fn(|axis| std::array::from_fn(|i| pick(pick(a[axis][i], b[axis][i]), c[axis][i])))
    };
    Boxes { min: of(f32::min), max: of(f32::max) }
}

/// The squared distance to each box, 0 inside.
fn squared_distances(boxes: &Boxes, point: Vec3) -> [f32; WIDTH] {
    let mut squared = [0.0; WIDTH];
    for (axis, v) in point.to_array().into_iter().enumerate() {
        for (i, sum) in squared.iter_mut().enumerate() {
            let away = (boxes.min[axis][i] - v).max(v - boxes.max[axis][i]).max(0.0);
            *sum += away * away;
        }
    }
    squared
}

/// The weights of the corners at the point of a triangle closest to `p`.
///
/// Source: Ericson 2004, "Real-Time Collision Detection", 5.1.5.
fn closest_weights([a, b, c]: [Vec3; 3], p: Vec3) -> [f32; 3] {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 && d4 - d3 > d6 - d5 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
    [1.0 - v - w, v, w]
}

#[cfg(test)]
mod tests {
    use super::super::numbers::numbers;
    use super::*;
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
            let is_near = |t: &u32| distance_to_triangle(triangles[*t as usize], p) <= 0.2;
            assert!((0..300).filter(is_near).all(|t| found.contains(&t)));
            // Boxes are no larger than 0.1 by 0.1 by 0.1.
            let is_far = |t: &u32| distance_to_triangle(triangles[*t as usize], p) > 0.2 + 0.18;
            assert!(!found.iter().any(is_far));
            assert!(found.is_empty() || bvh.within(p, 0.2, found.len() - 1).is_none());
        }
        let mut all: Vec<u32> = bvh.clusters().flatten().copied().collect();
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
            let least = rest.map(|t| distance_to_triangle(t, p)).fold(f32::INFINITY, f32::min);
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
