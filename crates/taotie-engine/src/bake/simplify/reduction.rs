//! The reduction of all triangles to the requested number, by the mildest method that reaches it: as a whole,
//! component by component, so that none is lost and no two are joined, or, if triangles are unconnected, by merging
//! vertices that are near one another.

use super::collapse::{
    Reduced, SimplifyMethod, SimplifyOptions, collapsed, collapsed_exactly, is_too_many, pruned,
};
use super::part::{Components, Fate, Part, adapter, is_connected, triples};
use crate::math::Vec3;
use crate::trace::Bvh;
use meshopt::SimplifyOptions as Choices;

/// Returns the part with the requested number of triangles, or as close to it as possible.
///
/// Edges are collapsed as a whole, which spends triangles where the surface needs them. If that does not reach the
/// number, or loses or tears a large component, each component is simplified separately, so that nothing joins parts
/// that are merely close. Vertices are merged by proximity in triangle soup only.
pub(super) fn reduce(part: &Part, components: &Components, options: &SimplifyOptions) -> Reduced {
    let wanted = options.triangles;
    if part.triangles.len() <= wanted {
        return Reduced::kept(part, SimplifyMethod::Kept);
    }
    let is_soup = components.is_soup;
    let is_whole = |reduced: &Reduced| {
        let fate = |reduced: &Reduced| components.fate(part, &reduced.triangles);
        is_soup || matches!(fate(reduced), Fate { lost_large: 0, torn: 0, .. })
    };
    let first = collapsed_exactly(part, options);
    if !is_too_many(&first, wanted) && is_whole(&first) {
        return first;
    }
    let together = if is_too_many(&first, wanted) { pruned(first, options) } else { first };
    let is_reached = !is_too_many(&together, wanted);
    match () {
        () if is_reached && is_whole(&together) => together,
        () if is_soup => {
            let last = clustered(part, options);
            // If clusters are as small as the whole, nothing is left.
            if last.triangles.is_empty() { together } else { last }
        }
        () if components.len() > 1 => reduce_apart(part, components, &together, options),
        () => together,
    }
}

/// The minimum number of triangles for a large component: that of a box.
const LEAST: usize = 12;
/// A large component gets at least its proportional share of the triangles divided by this.
const UNEVEN: usize = 2;
/// A component that is lost or torn gets up to this multiple of its share.
const MOST: usize = 8;

/// A component of a part.
struct Member<'a> {
    triangles: &'a [[u32; 3]],
    /// Its weight, relative to the others', in sharing out the remaining triangles.
    weight: usize,
}

/// Returns a part of several components with about the requested number of triangles.
///
/// `together` is the same part simplified as a whole. Components with many triangles there need many, so shares
/// follow it; small components that are lost there are left out.
fn reduce_apart(
    part: &Part,
    components: &Components,
    together: &Reduced,
    options: &SimplifyOptions,
) -> Reduced {
    let mut sorted = part.triangles.clone();
    sorted.sort_by_key(|triangle| part.component(triangle));
    let weights = weights(part, components, &together.triangles, options.triangles);
    let mut members: Vec<Member<'_>> = sorted
        .chunk_by(|a, b| part.component(a) == part.component(b))
        .map(|triangles| Member { triangles, weight: weights[part.component(&triangles[0])] })
        .filter(|member| member.weight > 0)
        .collect();
    // The largest come last and compensate for others that exceeded their shares.
    members.sort_by_key(|member| member.triangles.len());
    let method = if members.len() < components.len() { SimplifyMethod::Pruned } else { together.method };
    let mut all = Reduced { triangles: Vec::new(), ..Reduced::kept(part, method) };
    let mut purse = Purse { triangles: options.triangles, weight: members.iter().map(|m| m.weight).sum() };
    for member in &members {
        let own = part.extract(member.triangles);
        let found = simplify_one(&own, purse.share(member), options);
        purse.triangles = purse.triangles.saturating_sub(found.triangles.len());
        purse.weight -= member.weight;
        all.error = all.error.max(found.error);
        all.method = all.method.max(found.method);
        all.triangles
            .extend(found.triangles.iter().map(|triangle| triangle.map(|v| own.sources[v as usize])));
        let points = own.sources.iter().zip(found.points);
        points.for_each(|(source, point)| all.points[*source as usize] = point);
    }
    all
}

/// Returns the weight of each component; 0 if it is left out.
fn weights(part: &Part, components: &Components, together: &[[u32; 3]], wanted: usize) -> Vec<usize> {
    let before = components.counts(part, &part.triangles);
    let even = |count: usize| count as u128 * wanted as u128 / (UNEVEN * part.triangles.len()).max(1) as u128;
    let weight = |i: usize, left: usize| match components.large[i] && before[i] > 0 {
        true => left.max(even(before[i]) as usize).max(1),
        false => left,
    };
    components.counts(part, together).into_iter().enumerate().map(|(i, left)| weight(i, left)).collect()
}

/// The remaining triangles, and the total weight of the members still waiting for them.
struct Purse {
    triangles: usize,
    weight: usize,
}

/// The number of triangles allotted to a component.
struct Share {
    triangles: usize,
    /// The maximum if it is lost or torn.
    most: usize,
}

impl Purse {
    fn share(&self, member: &Member<'_>) -> Share {
        let own = (self.triangles as u128 * member.weight as u128 / self.weight.max(1) as u128) as usize;
        let count = member.triangles.len();
        let triangles = own.max(LEAST).min(count);
        let most = (MOST * triangles).min(self.triangles / 2).min(count).max(triangles);
        Share { triangles, most }
    }
}

/// Simplifies one component, with more triangles than its share if it is lost or torn.
fn simplify_one(own: &Part, share: Share, options: &SimplifyOptions) -> Reduced {
    let is_whole = |triangles: &[[u32; 3]]| is_connected(triangles, own.points.len());
    // Splitting into blocks may already have torn it, in which case more triangles do not help.
    let most = if is_whole(&own.triangles) { share.most } else { share.triangles };
    let mut count = share.triangles;
    loop {
        let found = to(own, &SimplifyOptions { triangles: count, ..*options });
        if count >= most || is_whole(&found.triangles) {
            return found;
        }
        count = (2 * count).min(most);
    }
}

fn to(own: &Part, options: &SimplifyOptions) -> Reduced {
    if own.triangles.len() <= options.triangles {
        return Reduced::kept(own, SimplifyMethod::Collapsed);
    }
    let first = collapsed(Reduced::kept(own, SimplifyMethod::Kept), options, Choices::empty());
    if !is_too_many(&first, options.triangles) {
        return first;
    }
    let earlier = first.error;
    let freer = collapsed(first, options, Choices::Permissive);
    Reduced { error: earlier + freer.error, method: SimplifyMethod::Pruned, ..freer }
}

/// The number of triangles that clustering leaves per requested triangle, so that edges can be collapsed afterwards.
const CLUSTERED_FOR_ONE: usize = 4;
/// A triangle spans a gap if its centroid or the midpoint of an edge is farther from the surface than this multiple
/// of the error...
const FAR: f32 = 4.0;
/// ... and than this fraction of the unit cube.
const LEAST_GAP: f32 = 0.01;

/// Merges nearby vertices down to a few times the target, collapses edges from there, and drops triangles that span
/// gaps.
fn clustered(part: &Part, options: &SimplifyOptions) -> Reduced {
    let joined = joined(part, options);
    let near = without_bars(part, &joined);
    if near.is_empty() { joined } else { Reduced { triangles: near, ..joined } }
}

/// Returns the triangles that are on the part's surface.
fn without_bars(part: &Part, joined: &Reduced) -> Vec<[u32; 3]> {
    let surface = Bvh::of(part.triangles.len(), |t| corners(&part.points, &part.triangles[t]));
    let far = (FAR * joined.error).max(LEAST_GAP);
    let is_near = |triangle: &&[u32; 3]| {
        middles(corners(&joined.points, triangle)).into_iter().all(|p| surface.closest(p, far).is_some())
    };
    joined.triangles.iter().filter(is_near).copied().collect()
}

fn corners(points: &[[f32; 3]], triangle: &[u32; 3]) -> [Vec3; 3] {
    triangle.map(|v| Vec3::from_array(points[v as usize]))
}

/// Returns the centroid of a triangle and the midpoints of its edges.
fn middles([a, b, c]: [Vec3; 3]) -> [Vec3; 4] {
    [(a + b + c) * (1.0 / 3.0), (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5]
}

/// Merges nearby vertices down to a few times the target, and collapses edges from there.
fn joined(part: &Part, options: &SimplifyOptions) -> Reduced {
    let wanted = options.triangles;
    let plenty = wanted.saturating_mul(CLUSTERED_FOR_ONE).min(part.triangles.len());
    let rough = sloppy(part, plenty);
    let rough_error = rough.error;
    let fine = collapsed(rough, options, Choices::Permissive);
    if fine.triangles.is_empty() || is_too_many(&fine, wanted) {
        return sloppy(part, wanted);
    }
    Reduced { error: rough_error + fine.error, method: SimplifyMethod::Clustered, ..fine }
}

fn sloppy(part: &Part, target: usize) -> Reduced {
    let mut error = 0.0;
    let corners = meshopt::simplify_sloppy(
        part.triangles.as_flattened(),
        &adapter(&part.points),
        3 * target,
        1.0,
        Some(&mut error),
    );
    Reduced { triangles: triples(corners), error, ..Reduced::kept(part, SimplifyMethod::Clustered) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::simplify::weld::weld;
    use crate::error::Warnings;
    use crate::mesh::{Mesh, MeshData};

    /// A large ball, a small one next to it, and a speck.
    fn balls() -> Part {
        let mut data = MeshData::default();
        let mut add = |ball: &Mesh, radius: f32, x: f32| {
            let first = data.positions.len() as u32;
            let rounded = |v: f32| (v * 1e5).round() * 1e-5;
            data.positions.extend(
                ball.positions().iter().map(|p| p.map(|v| rounded(v) * radius) + Vec3::new(x, 0.0, 0.0)),
            );
            data.triangles.extend(ball.triangles().iter().map(|t| t.map(|v| v + first)));
        };
        add(&Mesh::sphere(1.0, 60, 30), 1.0, 0.0);
        add(&Mesh::sphere(1.0, 24, 12), 0.05, 1.5);
        add(&Mesh::sphere(1.0, 8, 4), 0.001, -1.5);
        weld(&Mesh::new(data).unwrap(), &mut Warnings::default()).0
    }

    #[test]
    fn large_components_come_back_and_specks_do_not() {
        let mut part = balls();
        let components = Components::of(&mut part);
        let before = components.counts(&part, &part.triangles);
        let mut order: Vec<usize> = (0..3).collect();
        order.sort_by_key(|i| before[*i]);
        let [speck, small, ball] = [order[0], order[1], order[2]];
        assert_eq!([speck, small, ball].map(|i| components.large[i]), [false, true, true]);
        let options = SimplifyOptions { triangles: 400, ..SimplifyOptions::default() };
        let nothing = Reduced { triangles: Vec::new(), ..Reduced::kept(&part, SimplifyMethod::Collapsed) };
        let found = reduce_apart(&part, &components, &nothing, &options);
        let counts = components.counts(&part, &found.triangles);
        assert_eq!((counts[speck], found.method), (0, SimplifyMethod::Pruned));
        assert!(counts[small] >= LEAST && counts[ball] > 4 * counts[small], "{counts:?}");
        assert!(counts.iter().sum::<usize>().abs_diff(400) <= 8, "{counts:?}");
        let fate = components.fate(&part, &found.triangles);
        assert_eq!((fate.lost, fate.lost_large, fate.torn), (1, 0, 0));
    }

    #[test]
    fn no_triangle_joins_two_components() {
        let mut part = balls();
        let components = Components::of(&mut part);
        for triangles in [20, 60, 1000] {
            let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
            let as_it_was = Reduced::kept(&part, SimplifyMethod::Collapsed);
            let found = reduce_apart(&part, &components, &as_it_was, &options);
            for triangle in &found.triangles {
                let [a, b, c] = triangle.map(|v| part.labels[v as usize]);
                assert!(a == b && b == c, "{triangle:?}");
            }
            assert_eq!(components.fate(&part, &found.triangles).lost_large, 0, "{triangles}");
        }
    }

    /// Two triangles with a gap between them, one with the same corners, and two that bridge the gap.
    #[test]
    fn triangles_over_gaps_are_left_out() {
        let points = vec![
            [0.0, 0.0, 0.0],
            [0.3, 0.0, 0.0],
            [0.0, 0.3, 0.0],
            [0.4, 0.0, 0.0],
            [0.7, 0.0, 0.0],
            [0.4, 0.3, 0.0],
        ];
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        let part = Part { points, sources: Vec::new(), triangles, labels: Vec::new() };
        let joined = |error: f32| {
            let triangles = vec![[0, 2, 1], [1, 3, 2], [0, 4, 5]];
            Reduced { triangles, error, ..Reduced::kept(&part, SimplifyMethod::Clustered) }
        };
        assert_eq!(without_bars(&part, &joined(1e-3)), [[0, 2, 1]]);
        assert_eq!(
            without_bars(&part, &joined(0.1)).len(),
            3,
            "the error is the distance that vertices moved"
        );
    }
}
