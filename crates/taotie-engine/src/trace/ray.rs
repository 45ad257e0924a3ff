//! A ray, its watertight intersection with triangles, and its traversal of a tree, eight boxes or eight triangles at
//! a time.

use super::by_area::WIDTH;
use super::tree::{Boxes, Child, Leaf, STACK, Tree};
use crate::math::{Mask, Pack, Vec3};
use arrayvec::ArrayVec;

/// A half-line, prepared for intersection: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection".
/// A ray through a shared edge or corner hits at least one of the triangles.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    origin: Vec3,
    direction: Vec3,
    /// The axes that become x, y, z, so that the ray runs along z.
    axes: [usize; 3],
    shear: [f32; 3],
}

impl Ray {
    /// Creates a ray from any point along a direction that is not zero; distances are in lengths of `direction`.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let d = direction.to_array();
        let z = (0..3).fold(0, |best, i| if d[i].abs() > d[best].abs() { i } else { best });
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        Self { origin, direction, axes: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }

    /// The same ray from another origin.
    pub fn from(self, origin: Vec3) -> Self {
        Self { origin, ..self }
    }

    /// The origin.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// The direction as passed.
    pub fn direction(&self) -> Vec3 {
        self.direction
    }

    /// Returns the intersection of the ray with the triangle, either side: distance ≥ 0 and the weights of the corners.
    #[inline]
    pub fn intersect(&self, corners: [Vec3; 3]) -> Option<(f32, [f32; 3])> {
        let [kx, ky, kz] = self.axes;
        let [sx, sy, sz] = self.shear;
        let local = corners.map(|p| (p - self.origin).to_array());
        let [a, b, c] = local.map(|p| [p[kx] - sx * p[kz], p[ky] - sy * p[kz]]);
        let (along, weights) = pierced([a, b, c], local.map(|p| p[kz]))?;
        let t = sz * along;
        (t >= 0.0).then_some((t, weights))
    }

    /// The first half of [`Ray::intersect`] for a pack of triangles, those of `corners[corner][axis]` starting at
    /// `from`, with the same bits. `None` if the ray misses all of them.
    #[inline(always)]
    fn edges<P: Pack>(&self, token: P::Token, corners: &[[[f32; 8]; 3]; 3], from: usize) -> Option<Edges<P>> {
        let [kx, ky, kz] = self.axes;
        let origin = self.origin.to_array();
        let (ox, oy, oz) =
            (P::splat(token, origin[kx]), P::splat(token, origin[ky]), P::splat(token, origin[kz]));
        let [sx, sy, sz] = self.shear;
        let (sx, sy, sz) = (P::splat(token, sx), P::splat(token, sy), P::splat(token, sz));
        let (mut along, mut seen) = ([ox; 3], [[ox; 2]; 3]);
        for k in 0..3 {
            along[k] = P::load(token, &corners[k][kz][from..]) - oz;
            let x = P::load(token, &corners[k][kx][from..]) - ox - sx * along[k];
            let y = P::load(token, &corners[k][ky][from..]) - oy - sy * along[k];
            seen[k] = [x, y];
        }
        Edges::new(seen, along, sz)
    }
}

/// The tests of rays against the edges of triangles: a pack of either.
pub(super) struct Edges<P: Pack> {
    /// Twice the areas opposite each corner.
    edges: [P; 3],
    /// The corners along the ray's main axis.
    along: [P; 3],
    /// Lengths of the direction per length of that axis.
    scale: P,
    inside: P::Mask,
    /// `true` if it crosses an edge, as far as single precision can distinguish: [`Ray::intersect`] must decide.
    pub unsure: P::Mask,
}

/// The intersections of a ray with a pack of triangles.
pub(super) struct PackHits<P: Pack> {
    /// `true` if the ray hits the triangle.
    pub hit: P::Mask,
    pub distance: P,
    pub weights: [P; 3],
}

impl<P: Pack> Edges<P> {
    /// Returns the edges of corners seen along the ray, `None` if all are missed.
    #[inline(always)]
    pub fn new([a, b, c]: [[P; 2]; 3], along: [P; 3], scale: P) -> Option<Self> {
        let edges = [b[0] * c[1] - b[1] * c[0], c[0] * a[1] - c[1] * a[0], a[0] * b[1] - a[1] * b[0]];
        let zero = scale.lit(0.0);
        let below = edges[0].min(edges[1]).min(edges[2]).lt(zero);
        let above = zero.lt(edges[0].max(edges[1]).max(edges[2]));
        let inside = below.and(above).not();
        let unsure = edges[0].abs().min(edges[1].abs()).min(edges[2].abs()).le(zero);
        inside.or(unsure).any().then_some(Self { edges, along, inside, unsure, scale })
    }

    /// Returns the rays that may have a triangle ahead, without the divisions of [`Self::meet`].
    #[inline(always)]
    pub fn ahead(&self) -> P::Mask {
        let [e, z] = [self.edges, self.along];
        let det = e[0] + e[1] + e[2];
        let along = e[0] * z[0] + e[1] * z[1] + e[2] * z[2];
        self.unsure.or(self.inside.and(det.lit(0.0).le(det * along * self.scale)))
    }

    /// The second half of [`Ray::intersect`].
    #[inline(always)]
    pub fn meet(&self) -> PackHits<P> {
        let [e, z] = [self.edges, self.along];
        let det = e[0] + e[1] + e[2];
        let weights = [e[0] / det, e[1] / det, e[2] / det];
        let distance = self.scale * (weights[0] * z[0] + weights[1] * z[1] + weights[2] * z[2]);
        let zero = det.lit(0.0);
        PackHits { hit: self.inside.and(det.abs().le(zero).not()).and(zero.le(distance)), distance, weights }
    }
}

/// Returns where a ray through zero pierces a triangle with these corners, seen along it, and the weights of the
/// corners; `None` if it misses.
#[inline]
pub(super) fn pierced([a, b, c]: [[f32; 2]; 3], along: [f32; 3]) -> Option<(f32, [f32; 3])> {
    let edges = edge_functions(a, b, c);
    if edges.iter().any(|e| *e < 0.0) && edges.iter().any(|e| *e > 0.0) {
        return None;
    }
    let det = edges[0] + edges[1] + edges[2];
    if det == 0.0 {
        return None;
    }
    let weights = edges.map(|e| e / det);
    Some((weights[0] * along[0] + weights[1] * along[1] + weights[2] * along[2], weights))
}

/// Twice the areas opposite each corner; in double precision if one is zero, since its sign decides an edge.
#[inline]
fn edge_functions(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> [f32; 3] {
    let cross = |p: [f32; 2], q: [f32; 2]| p[0] * q[1] - p[1] * q[0];
    let edges = [cross(b, c), cross(c, a), cross(a, b)];
    if edges.iter().all(|e| *e != 0.0) {
        return edges;
    }
    let exact = |p: [f32; 2], q: [f32; 2]| {
        let [p, q] = [p.map(f64::from), q.map(f64::from)];
        (p[0] * q[1] - p[1] * q[0]) as f32
    };
    [exact(b, c), exact(c, a), exact(a, b)]
}

/// The part of a ray that still matters: distances in lengths of its direction, at least 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub from: f32,
    pub to: f32,
}

impl Span {
    /// The empty span, which ends the traversal.
    pub const NONE: Self = Self { from: f32::INFINITY, to: f32::NEG_INFINITY };
}

/// A ray, and the span of it that matters.
#[derive(Clone, Copy)]
pub(super) struct Cast<'a> {
    pub ray: &'a Ray,
    pub span: Span,
}

/// A triangle hit by a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Met {
    /// Its slot: eight times the leaf, plus its position in it.
    pub slot: usize,
    pub distance: f32,
    pub weights: [f32; 3],
}

/// A waiting node or leaf, and the distance at which the ray enters it.
#[derive(Clone, Copy)]
struct Waiting {
    enters: f32,
    child: Child,
}

/// Calls `meet` with each triangle that the ray hits within the span, with `NEAR_FIRST` roughly from near to far; it
/// returns the remaining span.
#[inline(always)]
pub(super) fn walk<P: Pack, const NEAR_FIRST: bool>(
    token: P::Token,
    tree: &Tree,
    cast: Cast<'_>,
    mut meet: impl FnMut(Met, Span) -> Span,
) {
    let Cast { ray, mut span } = cast;
    let slabs = Slabs::new(ray);
    let mut stack = ArrayVec::<Waiting, STACK>::new();
    stack.extend(tree.root().map(|child| Waiting { enters: 0.0, child }));
    while let Some(Waiting { enters, child }) = stack.pop() {
        if enters > span.to {
            continue;
        }
        if let Some(leaf) = child.as_leaf() {
            span = meet_leaf::<P>(token, &tree.leaves[leaf], Cast { ray, span }, |met, span| {
                meet(Met { slot: leaf * WIDTH + met.slot, ..met }, span)
            });
            continue;
        }
        let node = tree.node(child);
        let (mut hit, entries) = slabs.entries::<P>(token, &node.boxes, span);
        hit &= node.present();
        let first = stack.len();
        while hit != 0 {
            let i = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let mut place = stack.len();
            stack.push(Waiting { enters: entries[i], child: node.child(i) });
            while NEAR_FIRST && place > first && stack[place - 1].enters < stack[place].enters {
                stack.swap(place - 1, place);
                place -= 1;
            }
        }
    }
}

/// A ray for slab tests.
struct Slabs {
    origin: [f32; 3],
    inverse: [f32; 3],
}

impl Slabs {
    fn new(ray: &Ray) -> Self {
        // Parallel to a slab: entered and left so far away that only the side of the origin matters.
        let steep = |v: f32| if v.abs() < 1e-30 { 1e30 } else { 1.0 / v };
        Self { origin: ray.origin().to_array(), inverse: ray.direction().to_array().map(steep) }
    }

    /// Returns the boxes that the ray crosses within the span, one bit each, and their entry distances.
    #[inline(always)]
    fn entries<P: Pack>(&self, token: P::Token, boxes: &Boxes, span: Span) -> (u64, [f32; WIDTH]) {
        /// The relative rounding error of a distance to a slab.
        const ROUNDING: f64 = 4e-7;
        let mut entries = [0.0; WIDTH];
        let mut hit = 0;
        for k in (0..WIDTH).step_by(P::LANES) {
            let (mut near, mut far) = (P::splat(token, span.from), P::splat(token, span.to));
            for axis in 0..3 {
                let origin = P::splat(token, self.origin[axis]);
                let inverse = P::splat(token, self.inverse[axis]);
                let (first, second) = match self.inverse[axis] < 0.0 {
                    true => (&boxes.max[axis], &boxes.min[axis]),
                    false => (&boxes.min[axis], &boxes.max[axis]),
                };
                let enter = (P::load(token, &first[k..]) - origin) * inverse;
                let leave = (P::load(token, &second[k..]) - origin) * inverse;
                near = enter.max(near);
                far = leave.min(far);
            }
            // Empty boxes are entered at infinity and left at minus infinity.
            let enters = near * near.lit(1.0 - ROUNDING);
            hit |= P::bits(enters.le(far * far.lit(1.0 + ROUNDING))) << k;
            enters.store(&mut entries[k..]);
        }
        (hit, entries)
    }
}

/// Calls `meet` with the triangles of a leaf that the ray hits within the span; slots are positions in the leaf.
#[inline(always)]
fn meet_leaf<P: Pack>(
    token: P::Token,
    leaf: &Leaf,
    cast: Cast<'_>,
    mut meet: impl FnMut(Met, Span) -> Span,
) -> Span {
    let Cast { ray, mut span } = cast;
    for k in (0..WIDTH).step_by(P::LANES) {
        let Some(edges) = ray.edges::<P>(token, &leaf.corners, k) else { continue };
        let mut distances = [0.0; WIDTH];
        let mut weights = [[0.0; WIDTH]; 3];
        let met = edges.meet();
        let within = met.hit.and(P::splat(token, span.from).le(met.distance));
        let mut hit = P::bits(within.and(met.distance.le(P::splat(token, span.to))));
        met.distance.store(&mut distances);
        for (weight, to) in met.weights.into_iter().zip(&mut weights) {
            weight.store(to);
        }
        let mut unsure = P::bits(edges.unsure);
        while unsure != 0 {
            let i = unsure.trailing_zeros() as usize;
            unsure &= unsure - 1;
            hit &= !(1 << i);
            if let Some((distance, exact)) = ray.intersect(leaf.triangle(k + i)) {
                hit |= u64::from(distance >= span.from && distance <= span.to) << i;
                distances[i] = distance;
                (0..3).for_each(|corner| weights[corner][i] = exact[corner]);
            }
        }
        while hit != 0 {
            let i = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let weights = [weights[0][i], weights[1][i], weights[2][i]];
            span = meet(Met { slot: k + i, distance: distances[i], weights }, span);
        }
    }
    span
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [Vec3; 3] =
        [Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];

    #[test]
    fn hits_from_both_sides() {
        for side in [-1.0, 1.0] {
            let ray = Ray::new(Vec3::new(0.25, 0.25, 2.0 * side), Vec3::new(0.0, 0.0, -side));
            let (t, weights) = ray.intersect(TRIANGLE).unwrap();
            assert_eq!((t, weights), (2.0, [0.5, 0.25, 0.25]));
        }
    }

    #[test]
    fn misses_behind_and_beside() {
        assert!(Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::new(0.0, 0.0, 1.0)).intersect(TRIANGLE).is_none());
        assert!(Ray::new(Vec3::new(0.9, 0.9, 1.0), Vec3::new(0.0, 0.0, -1.0)).intersect(TRIANGLE).is_none());
    }

    #[test]
    fn no_ray_slips_through_a_shared_edge() {
        let other = [TRIANGLE[1], Vec3::new(1.0, 1.0, 0.0), TRIANGLE[2]];
        for i in 1..1000 {
            let t = i as f32 / 1000.0;
            let target = Vec3::new(t, 1.0 - t, 0.0);
            let origin = Vec3::new(0.3, -0.7, 1.3);
            let ray = Ray::new(origin, target - origin);
            assert!(ray.intersect(TRIANGLE).is_some() || ray.intersect(other).is_some(), "{i}");
        }
    }
}
