//! Simplifies components one by one, so that none is lost and no two are joined.

use super::collapse::{Reduced, collapsed, is_too_many};
use super::components::{self, Components};
use super::options::{SimplifyMethod, SimplifyOptions};
use super::part::Part;
use meshopt::SimplifyOptions as Choices;

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
pub(super) fn reduce(
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
    let is_whole = |triangles: &[[u32; 3]]| components::is_connected(triangles, own.points.len());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::simplify::weld::weld;
    use crate::error::Warnings;
    use crate::math::Vec3;
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
        let found = reduce(&part, &components, &nothing, &options);
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
            let found = reduce(&part, &components, &as_it_was, &options);
            for triangle in &found.triangles {
                let [a, b, c] = triangle.map(|v| part.labels[v as usize]);
                assert!(a == b && b == c, "{triangle:?}");
            }
            assert_eq!(components.fate(&part, &found.triangles).lost_large, 0, "{triangles}");
        }
    }
}
