//! Traverses a tree along a ray, eight boxes or eight triangles at a time.

use super::Ray;
use super::tree::{Boxes, Leaf, Tree, WIDTH};
use crate::math::{Mask, Pack};
use arrayvec::ArrayVec;

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

/// The size of the stack, deeper than any tree of 2^32 triangles; seven siblings of each node on the path may wait.
const STACK: usize = 96;

/// A waiting node: the distance at which the ray enters it, its level above the leaves (0 is a leaf), its index.
#[derive(Clone, Copy)]
struct Waiting {
    enters: f32,
    level: u32,
    node: u32,
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
    if !tree.leaves.is_empty() {
        stack.push(Waiting { enters: 0.0, level: tree.levels.len() as u32, node: 0 });
    }
    while let Some(Waiting { enters, level, node }) = stack.pop() {
        if enters > span.to {
            continue;
        }
        if level == 0 {
            let leaf = &tree.leaves[node as usize];
            let present = tree.triangles(node as usize);
            span = meet_leaf::<P>(token, leaf, Cast { ray, span }, |met, span| match met.slot < present {
                true => meet(Met { slot: node as usize * WIDTH + met.slot, ..met }, span),
                false => span,
            });
            continue;
        }
        let (mut hit, entries) =
            slabs.entries::<P>(token, &tree.levels[level as usize - 1][node as usize], span);
        hit &= (1 << tree.children(level as usize, node as usize)) - 1;
        let first = stack.len();
        while hit != 0 {
            let i = hit.trailing_zeros();
            hit &= hit - 1;
            let mut place = stack.len();
            stack.push(Waiting {
                enters: entries[i as usize],
                level: level - 1,
                node: node * WIDTH as u32 + i,
            });
            while NEAR_FIRST && place > first && stack[place - 1].enters < stack[place].enters {
                stack.swap(place - 1, place);
                place -= 1;
            }
        }
    }
}

/// A ray for slab tests.
pub(super) struct Slabs {
    origin: [f32; 3],
    inverse: [f32; 3],
}

impl Slabs {
    pub fn new(ray: &Ray) -> Self {
        // Parallel to a slab: entered and left so far away that only the side of the origin matters.
        let steep = |v: f32| if v.abs() < 1e-30 { 1e30 } else { 1.0 / v };
        Self { origin: ray.origin().to_array(), inverse: ray.direction().to_array().map(steep) }
    }

    /// Returns the boxes that the ray crosses within the span, one bit each, and their entry distances.
    #[inline(always)]
    pub fn entries<P: Pack>(&self, token: P::Token, boxes: &Boxes, span: Span) -> (u64, [f32; WIDTH]) {
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
pub(super) fn meet_leaf<P: Pack>(
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
