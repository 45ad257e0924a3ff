//! Merges regions into UV islands: neighbours are joined as long as their triangles face roughly the same way, which
//! is measured by the narrowest cone around their directions. Borders between the islands are then shortened.

use super::regions::{NONE, Topology};
use crate::math::Vec3;
use std::collections::{BTreeMap, BinaryHeap};

/// The maximum angles between the axis of a UV island and the normals of its triangles, as minimum cosines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// For smooth normals.
    pub smooth: f64,
    /// For the triangles' own normals.
    pub own: f64,
    /// Join only if one side has less area than this.
    pub small: f64,
}

/// A UV island during merging: its normals, area and borders.
#[derive(Debug, Clone, Default)]
struct Region {
    smooth: Directions,
    own: Directions,
    /// The sum of the normals times areas.
    facing: Vec3<f64>,
    area: f64,
    perimeter: f64,
    /// The length of the border with each neighbour.
    borders: BTreeMap<u32, f64>,
    /// Incremented with each change; [`NONE`] if it was joined to another.
    version: u32,
}

/// A pair of neighbours, ordered by the benefit of joining them. The versions indicate if it is out of date.
///
/// Most pairs are out of date before their turn comes. So each starts with an upper bound of its worth, and the exact
/// value is computed in its turn; at equal worth the upper bound comes first.
type Pair = (u64, Worth, [u32; 2], [u32; 2]);

/// The kind of a pair's worth: exact, or an upper bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Worth {
    Computed,
    Possible,
}

/// The UV islands of triangles while they are merged.
pub(super) struct Merger {
    regions: Vec<Region>,
    /// The region to which each region was joined; itself if none.
    parents: Vec<u32>,
    middles: Middles,
}

impl Merger {
    pub fn new(topology: &Topology, labels: &[u32], count: usize) -> Self {
        let mut members = vec![Vec::new(); count];
        for (t, label) in labels.iter().enumerate().filter(|(_, label)| **label != NONE) {
            members[*label as usize].push(t);
        }
        let regions = members.iter().map(|members| Region::new(topology, labels, members)).collect();
        Self { regions, parents: (0..count as u32).collect(), middles: Middles::new() }
    }

    /// Joins pairs, highest worth first, until the limits allow no more.
    pub fn join(&mut self, limits: &Limits) {
        let mut pairs = BinaryHeap::new();
        for a in 0..self.regions.len() as u32 {
            self.offer(a, limits, &mut pairs, |b| b > a);
        }
        while let Some((_, worth, [a, b], versions)) = pairs.pop() {
            if [a, b].map(|r| self.regions[r as usize].version) != versions {
                continue;
            }
            if worth == Worth::Possible {
                let computed = self.worth(a, b, limits);
                pairs.extend(computed.map(|worth| (worth.to_bits(), Worth::Computed, [a, b], versions)));
            } else {
                self.unite(a, b);
                self.offer(a, limits, &mut pairs, |_| true);
            }
        }
    }

    /// Returns the UV island of each triangle, numbered without gaps, and the axis of each.
    pub fn islands(&self, labels: &[u32]) -> (Vec<u32>, Vec<Vec3<f64>>) {
        let mut numbers = vec![NONE; self.regions.len()];
        let mut axes = Vec::new();
        for (i, region) in self.regions.iter().enumerate().filter(|(i, _)| self.parents[*i] == *i as u32) {
            numbers[i] = axes.len() as u32;
            axes.push(region.axis(&self.middles));
        }
        let number = |label: u32| if label == NONE { NONE } else { numbers[self.root(label) as usize] };
        (labels.iter().map(|label| number(*label)).collect(), axes)
    }

    fn root(&self, mut region: u32) -> u32 {
        while self.parents[region as usize] != region {
            region = self.parents[region as usize];
        }
        region
    }

    /// Pushes the pairs of `a` with those neighbours that it may be joined to onto the heap.
    fn offer(&self, a: u32, limits: &Limits, pairs: &mut BinaryHeap<Pair>, wanted: impl Fn(u32) -> bool) {
        let region = &self.regions[a as usize];
        for b in region.borders.keys().copied().filter(|b| wanted(*b)) {
            let other = &self.regions[b as usize];
            if region.area.min(other.area) < limits.small {
                let most = region.worth(other, b, 1.0);
                pairs.push((most.to_bits(), Worth::Possible, [a, b], [region.version, other.version]));
            }
        }
    }

    /// Returns the worth of joining two neighbours; `None` if the limits do not allow it.
    fn worth(&self, a: u32, b: u32, limits: &Limits) -> Option<f64> {
        let [region, other] = [a, b].map(|r| &self.regions[r as usize]);
        let narrowness = region.with(other, limits, &self.middles)?;
        Some(region.worth(other, b, narrowness))
    }

    fn unite(&mut self, a: u32, b: u32) {
        let gone =
            std::mem::replace(&mut self.regions[b as usize], Region { version: NONE, ..Region::default() });
        self.parents[b as usize] = a;
        let region = &mut self.regions[a as usize];
        let shared = region.borders.remove(&b).unwrap_or(0.0);
        region.version += 1;
        region.smooth = region.smooth.union(&gone.smooth);
        region.own = region.own.union(&gone.own);
        region.facing += gone.facing;
        region.area += gone.area;
        region.perimeter += gone.perimeter - 2.0 * shared;
        for (other, length) in gone.borders.into_iter().filter(|(other, _)| *other != a) {
            *self.regions[a as usize].borders.entry(other).or_default() += length;
            let borders = &mut self.regions[other as usize].borders;
            borders.remove(&b);
            *borders.entry(a).or_default() += length;
        }
    }
}

impl Region {
    fn new(topology: &Topology, labels: &[u32], members: &[usize]) -> Self {
        let mut region = Self {
            smooth: Directions::of(members.iter().map(|t| topology.smooth[*t])),
            own: Directions::of(members.iter().map(|t| topology.normals[*t])),
            ..Self::default()
        };
        for t in members {
            region.facing += topology.normals[*t] * topology.areas[*t];
            region.area += topology.areas[*t];
            for (corner, side) in topology.neighbours[*t].into_iter().enumerate() {
                let neighbour = if side == NONE { NONE } else { labels[side as usize] };
                if neighbour != labels[*t] {
                    region.perimeter += topology.edge(*t, corner);
                    if neighbour != NONE {
                        *region.borders.entry(neighbour).or_default() += topology.edge(*t, corner);
                    }
                }
            }
        }
        region
    }

    /// Returns the direction along which the UV island is projected: where all triangles face it well, else most.
    fn axis(&self, middles: &Middles) -> Vec3<f64> {
        Cone { smooth: &self.smooth, own: &self.own, middles }.axis(self.facing)
    }

    /// Returns the worth, at least 0, of joining a neighbour such that the cone of both has this narrowness.
    fn worth(&self, other: &Self, number: u32, narrowness: f64) -> f64 {
        let shared = self.borders.get(&number).copied().unwrap_or(0.0);
        (shared / self.perimeter.min(other.perimeter) + 0.5 * narrowness).max(0.0)
    }

    /// Returns the narrowness of the cone of both together, 0 to 1; `None` if it is too wide.
    fn with(&self, other: &Self, limits: &Limits, middles: &Middles) -> Option<f64> {
        let facing = self.facing + other.facing;
        let start = facing.normalize_or(Vec3::splat(0.0));
        // Cheap and nearly always right: a normal far from the mean of both is far from every axis.
        if start.dot(start) < 0.5 || self.smooth.least_cosine(middles, start) < limits.smooth - 0.6 {
            return None;
        }
        let (smooth, own) = (self.smooth.union(&other.smooth), self.own.union(&other.own));
        let cone = Cone { smooth: &smooth, own: &own, middles };
        let axis = cone.axis(facing);
        let narrow = smooth.least_cosine(middles, axis);
        (narrow >= limits.smooth && own.least_cosine(middles, axis) >= limits.own).then_some(narrow)
    }
}

/// The normals for which an axis is searched: those of the smooth surface and the triangles' own.
struct Cone<'a> {
    smooth: &'a Directions,
    own: &'a Directions,
    middles: &'a Middles,
}

impl Cone<'_> {
    fn axis(&self, facing: Vec3<f64>) -> Vec3<f64> {
        let start = facing.normalize_or(Vec3::new(0.0, 0.0, 1.0));
        let [by_smooth, by_own] = [self.smooth, self.own].map(|normals| normals.axis(self.middles, start));
        // Between the axis of the smooth surface and that of its steepest triangles, so that both have leeway.
        let middle = (by_smooth + by_own).normalize_or(start);
        let axes = [by_smooth, middle, by_own].map(|axis| (self.fitness(axis), axis));
        axes.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b)).map_or(start, |(_, axis)| axis)
    }

    /// Returns the fitness of an axis: smooth normals count more than the triangles' own, unless one would be seen
    /// from behind.
    fn fitness(&self, axis: Vec3<f64>) -> f64 {
        let own = self.own.least_cosine(self.middles, axis);
        if own < 0.1 { own - 2.0 } else { self.smooth.least_cosine(self.middles, axis).min(own + 0.3) }
    }
}

/// Cells along a side of the octahedral map; directions are rounded by 1.3° on average.
const SIDE: u16 = 64;

/// The unit direction in the middle of each cell of the octahedral map.
struct Middles(Vec<Vec3<f64>>);

impl Middles {
    fn new() -> Self {
        Self((0..SIDE * SIDE).map(direction).collect())
    }
}

/// Directions rounded to cells of the octahedral map; sorted and distinct.
#[derive(Debug, Clone, Default)]
struct Directions(Vec<u16>);

impl Directions {
    fn of(directions: impl Iterator<Item = Vec3<f64>>) -> Self {
        let mut cells: Vec<u16> = directions.filter(|d| d.dot(*d) > 0.5).map(cell).collect();
        cells.sort_unstable();
        cells.dedup();
        Self(cells)
    }

    /// Returns the union of both sets.
    fn union(&self, other: &Self) -> Self {
        let mut cells = [self.0.as_slice(), &other.0].concat();
        cells.sort_unstable();
        cells.dedup();
        Self(cells)
    }

    /// Returns the minimum cosine of the angle between `axis` and any of them; 1 if there are none.
    fn least_cosine(&self, middles: &Middles, axis: Vec3<f64>) -> f64 {
        self.farthest(middles, axis).0
    }

    /// Returns the direction farthest from `axis`, and the cosine of the angle between both, at most 1; `axis` itself
    /// if there are none.
    fn farthest(&self, middles: &Middles, axis: Vec3<f64>) -> (f64, Vec3<f64>) {
        let directions = self.0.iter().map(|cell| middles.0[usize::from(*cell)]);
        directions.fold((1.0, axis), |(least, far), d| {
            let cosine = d.dot(axis);
            if cosine < least { (cosine, d) } else { (least, far) }
        })
    }

    /// Returns the axis of approximately the narrowest cone around them, searching from `start` (unit).
    ///
    /// Source: Bădoiu and Clarkson 2003, "Smaller core-sets for balls", section 3: move towards the farthest point in
    /// ever smaller steps.
    fn axis(&self, middles: &Middles, start: Vec3<f64>) -> Vec3<f64> {
        let mut farthest = self.farthest(middles, start);
        let (mut axis, mut best) = (start, (farthest.0, start));
        for round in 1..=12 {
            axis = (axis + (farthest.1 - axis) / (f64::from(round) + 2.0)).normalize_or(start);
            farthest = self.farthest(middles, axis);
            if farthest.0 > best.0 {
                best = (farthest.0, axis);
            }
        }
        best.1
    }
}

/// Returns the cell of a unit direction.
/// Source: Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors".
fn cell(d: Vec3<f64>) -> u16 {
    let sum = d.x.abs() + d.y.abs() + d.z.abs();
    let (x, y) = (d.x / sum, d.y / sum);
    let (x, y) = if d.z < 0.0 { folded(x, y) } else { (x, y) };
    let place = |v: f64| (((v * 0.5 + 0.5) * f64::from(SIDE)) as u16).min(SIDE - 1);
    place(y) * SIDE + place(x)
}

/// Returns the unit direction in the middle of a cell.
fn direction(cell: u16) -> Vec3<f64> {
    let place = |i: u16| (f64::from(i) + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
    let (x, y) = (place(cell % SIDE), place(cell / SIDE));
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z < 0.0 { folded(x, y) } else { (x, y) };
    Vec3::new(x, y, z).normalize()
}

fn folded(x: f64, y: f64) -> (f64, f64) {
    let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y))
}

/// The number of passes over all triangles.
const ROUNDS: usize = 4;

/// Moves triangles that stick into another UV island to that island, if they face its axis well enough. UV islands
/// stay connected: a triangle that is moved is attached to its old UV island by at most one edge.
pub(super) fn shorten_borders(topology: &Topology, labels: &mut [u32], axes: &[Vec3<f64>], limits: &Limits) {
    for _ in 0..ROUNDS {
        for t in 0..labels.len() {
            if let Some(better) = better(topology, labels, t) {
                let axis = axes[better as usize];
                let [smooth, own] = [topology.smooth[t], topology.normals[t]].map(|n| n.dot(axis));
                if smooth >= limits.smooth && own >= limits.own {
                    labels[t] = better;
                }
            }
        }
    }
}

/// Returns the UV island with which a triangle has a longer border than with its own.
fn better(topology: &Topology, labels: &[u32], t: usize) -> Option<u32> {
    let adjacent = topology.neighbours[t].map(|side| if side == NONE { NONE } else { labels[side as usize] });
    let own = labels[t];
    if own == NONE || adjacent.iter().filter(|label| **label == own).count() > 1 {
        return None;
    }
    let length =
        |label: u32| -> f64 { (0..3).filter(|k| adjacent[*k] == label).map(|k| topology.edge(t, k)).sum() };
    let others = adjacent.into_iter().filter(|label| *label != NONE && *label != own);
    let best = others.max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    (length(best) > length(own)).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_near_their_directions() {
        for i in 0..4096u16 {
            assert_eq!(cell(direction(i)), i);
        }
        let d = Vec3::new(0.3, -0.5, -0.7).normalize();
        assert!(direction(cell(d)).dot(d) > 0.9985);
    }

    #[test]
    fn the_cone_of_a_cap_is_found() {
        let rim = (0..40).map(|i| {
            let angle = f64::from(i) * 0.157;
            Vec3::new(0.6 * crate::math::scalar::cos(angle), 0.6 * crate::math::scalar::sin(angle), 0.8)
        });
        let (set, middles) = (Directions::of(rim), Middles::new());
        let axis = set.axis(&middles, Vec3::new(0.6, 0.0, 0.8));
        assert!(axis.z > 0.99, "{axis:?}");
        assert!(set.least_cosine(&middles, axis) > 0.75);
    }
}
