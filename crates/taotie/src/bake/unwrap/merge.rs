//! UV islands from regions: neighbours are joined as long as their triangles face nearly one way.

use super::cone::{Directions, Middles};
use super::topology::{NONE, Topology};
use crate::math::Vec3;
use std::collections::{BTreeMap, BinaryHeap};

/// The widest angles between the axis of a UV island and the normals of its triangles, as least cosines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Of the smooth normals.
    pub smooth: f64,
    /// Of the triangles' own.
    pub own: f64,
    /// Only joins of which one side has less area than this.
    pub small: f64,
}

/// A UV island while UV islands are joined: its normals, area and borders.
#[derive(Debug, Clone, Default)]
struct Region {
    smooth: Directions,
    own: Directions,
    /// The normals times areas, added.
    facing: Vec3<f64>,
    area: f64,
    perimeter: f64,
    /// The length of the border with each neighbour.
    borders: BTreeMap<u32, f64>,
    /// Rises with each change; [`NONE`] where it was joined to another.
    version: u32,
}

/// A pair of neighbours, the more worth to be joined the greater. The versions tell whether it is out of date.
///
/// Most pairs are out of date before their turn comes. So each begins with the most that it may be worth, and what it is
/// is computed in its turn; of equal worths the possible one comes first.
type Pair = (u64, Worth, [u32; 2], [u32; 2]);

/// The kind of a pair's worth: as computed, or the most that is possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Worth {
    Computed,
    Possible,
}

/// The UV islands of triangles as they are joined.
pub(super) struct Merger {
    regions: Vec<Region>,
    /// The region that each region was joined to, itself where to none.
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

    /// Joins pairs, the worthiest first, until the limits allow no more.
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

    /// Puts the pairs of `a` with those neighbours that it may be joined to on the heap.
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

    /// Returns the worth of joining two neighbours; `None` where the limits do not allow it.
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
                let beside = if side == NONE { NONE } else { labels[side as usize] };
                if beside != labels[*t] {
                    region.perimeter += topology.edge(*t, corner);
                    if beside != NONE {
                        *region.borders.entry(beside).or_default() += topology.edge(*t, corner);
                    }
                }
            }
        }
        region
    }

    /// Returns the direction that the UV island is seen from: where all triangles are seen well, else where most are.
    fn axis(&self, middles: &Middles) -> Vec3<f64> {
        Cone { smooth: &self.smooth, own: &self.own, middles }.axis(self.facing)
    }

    /// Returns the worth, from 0 on, of joining a neighbour so that the cone of both has this narrowness.
    fn worth(&self, other: &Self, number: u32, narrowness: f64) -> f64 {
        let shared = self.borders.get(&number).copied().unwrap_or(0.0);
        (shared / self.perimeter.min(other.perimeter) + 0.5 * narrowness).max(0.0)
    }

    /// Returns the narrowness of the cone of both together, 0 to 1; `None` where it is too wide.
    fn with(&self, other: &Self, limits: &Limits, middles: &Middles) -> Option<f64> {
        let facing = self.facing + other.facing;
        let start = facing.normalize_or(Vec3::splat(0.0));
        // Cheap and nearly always right: what is far from the mean of both is far from every axis.
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

/// The normals that an axis is sought for: those of the smooth surface and the triangles' own.
struct Cone<'a> {
    smooth: &'a Directions,
    own: &'a Directions,
    middles: &'a Middles,
}

impl Cone<'_> {
    fn axis(&self, facing: Vec3<f64>) -> Vec3<f64> {
        let start = facing.normalize_or(Vec3::new(0.0, 0.0, 1.0));
        let [by_smooth, by_own] = [self.smooth, self.own].map(|normals| normals.axis(self.middles, start));
        // Between the axis of the smooth surface and that of its steepest triangles, so that both have room.
        let middle = (by_smooth + by_own).normalize_or(start);
        let axes = [by_smooth, middle, by_own].map(|axis| (self.fitness(axis), axis));
        axes.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b)).map_or(start, |(_, axis)| axis)
    }

    /// Returns the fitness of an axis: the smooth normals count more than the triangles' own, unless one would be seen
    /// from behind.
    fn fitness(&self, axis: Vec3<f64>) -> f64 {
        let own = self.own.least_cosine(self.middles, axis);
        if own < 0.1 { own - 2.0 } else { self.smooth.least_cosine(self.middles, axis).min(own + 0.3) }
    }
}
