//! How much of a surface has a fault, and where most of it is.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use taotie_engine::length::{Unit, place_text};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::SceneData;

/// Cells along the diagonal of the model: spots in adjacent cells belong to one cluster.
const CELLS: f64 = 50.0;

/// A piece of a surface that has a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::asset) struct Spot {
    /// World space.
    pub at: Vec3<f64>,
    /// Its area, or its length for faults of edges.
    pub amount: f64,
}

/// The surface on which spots are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::asset) struct Whole {
    /// The area of the whole surface, or the length of all its edges.
    pub amount: f64,
    /// The diagonal of the model, in its unit.
    pub diagonal: f64,
    /// The unit of the model's coordinates, if known.
    pub unit: Option<Unit>,
}

impl Spot {
    /// Converts a triangle to a spot.
    pub fn of_triangle(mesh: &Mesh, triangle: usize, world_from_object: &Mat4) -> Self {
        let [a, b, c] = mesh.corners(triangle).map(|p| world_from_object.transform_point(p.to_f64()));
        Self { at: (a + b + c) / 3.0, amount: (b - a).cross(c - a).length() * 0.5 }
    }
}

impl Whole {
    /// Measures the surface of all instances.
    pub fn of(parts: &SceneData, unit: Option<Unit>) -> Self {
        let mut whole = Self { amount: 0.0, diagonal: 0.0, unit };
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for instance in &parts.instances {
            let (mesh, m) = (&parts.meshes[instance.mesh], &instance.world_from_object);
            whole.amount += mesh.area(m);
            for p in mesh.positions() {
                let p = m.transform_point(p.to_f64()).to_array();
                least = std::array::from_fn(|k| least[k].min(p[k]));
                most = std::array::from_fn(|k| most[k].max(p[k]));
            }
        }
        let diagonal = (Vec3::from_array(most) - Vec3::from_array(least)).length();
        whole.diagonal = if diagonal.is_finite() { diagonal } else { 0.0 };
        whole
    }

    /// Measures the surface of a mesh.
    pub fn of_mesh(mesh: &Mesh, unit: Option<Unit>) -> Self {
        Self { amount: mesh.area(&Mat4::IDENTITY), diagonal: mesh.diagonal(), unit }
    }
}

/// The share of a surface that has a fault, and the centre of its largest cluster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::asset) struct Extent {
    /// [0, 1].
    pub share: f64,
    /// A point of the largest cluster near its centre of mass, world space.
    pub centre: Vec3<f64>,
    /// The surface, whose size determines how many digits of the centre are shown.
    whole: Whole,
}

/// A cluster of spots under construction.
#[derive(Default)]
struct Cluster {
    amount: f64,
    members: Vec<usize>,
}

impl Extent {
    /// Measures spots; `None` if there are none.
    pub fn of(spots: &[Spot], whole: Whole) -> Option<Self> {
        let cluster = largest(spots, whole.diagonal)?;
        let weighted = |sum: Vec3<f64>, i: &usize| sum + spots[*i].at * spots[*i].amount;
        let zero = Vec3::<f64>::splat(0.0);
        let mean = cluster.members.iter().fold(zero, weighted) / cluster.amount.max(f64::MIN_POSITIVE);
        let distance = |i: &usize| (spots[*i].at - mean).length();
        let nearest = cluster.members.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let amount: f64 = spots.iter().map(|spot| spot.amount).sum();
        let share = (amount / whole.amount.max(f64::MIN_POSITIVE)).min(1.0);
        Some(Self { share, centre: spots[*nearest].at, whole })
    }

    /// Returns the share as text, in percent.
    pub fn percent(&self) -> String {
        match self.share {
            share if share < 0.0005 => "less than 0.1 %".into(),
            share => format!("{:.1} %", share * 100.0),
        }
    }

    /// Returns the centre as text, to about a thousandth of the diagonal.
    pub fn place(&self) -> String {
        place_text(self.centre.to_array(), self.whole.diagonal, self.whole.unit)
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of its surface, around {}", self.percent(), self.place())
    }
}

/// Returns the cluster with the largest amount; on ties, the one whose cell comes first.
fn largest(spots: &[Spot], diagonal: f64) -> Option<Cluster> {
    let side = (diagonal / CELLS).max(f64::MIN_POSITIVE);
    let cell = |at: Vec3<f64>| at.to_array().map(|v| (v / side).floor() as i64);
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for (i, spot) in spots.iter().enumerate() {
        cells.entry(cell(spot.at)).or_default().push(i);
    }
    let mut left: BTreeSet<[i64; 3]> = cells.keys().copied().collect();
    let mut best: Option<Cluster> = None;
    while let Some(start) = left.pop_first() {
        let (mut cluster, mut queue) = (Cluster::default(), vec![start]);
        while let Some(cell) = queue.pop() {
            let members = &cells[&cell];
            cluster.amount += members.iter().map(|i| spots[*i].amount).sum::<f64>();
            cluster.members.extend(members);
            queue.extend(around(cell).filter(|near| left.remove(near)));
        }
        if best.as_ref().is_none_or(|best| cluster.amount > best.amount) {
            best = Some(cluster);
        }
    }
    best
}

/// Returns the 27 cells around and including a cell.
fn around([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let near = |v: i64| v.saturating_sub(1)..=v.saturating_add(1);
    near(x).flat_map(move |x| near(y).flat_map(move |y| near(z).map(move |z| [x, y, z])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::scalar;

    fn spot(x: f64, y: f64, amount: f64) -> Spot {
        Spot { at: Vec3::new(x, y, 0.0), amount }
    }

    #[test]
    fn the_largest_cluster_is_named_and_all_count() {
        let whole = Whole { amount: 10.0, diagonal: 10.0, unit: None };
        // Many small touching ones against one larger one, with an isolated one in between.
        let mut spots: Vec<Spot> = (0..5).map(|i| spot(1.0 + 0.1 * f64::from(i), 1.0, 0.1)).collect();
        spots.extend([spot(-4.0, 0.0, 0.3), spot(3.0, 1.0, 0.2)]);
        let extent = Extent::of(&spots, whole).unwrap();
        assert!((extent.share - 0.1).abs() < 1e-12);
        assert_eq!(extent.centre, Vec3::new(1.2, 1.0, 0.0));
        assert_eq!(extent.to_string(), "10.0 % of its surface, around (1.20, 1.00, 0.00)");
        assert_eq!(Extent::of(&[], whole), None);
    }

    #[test]
    fn the_centre_is_a_spot_even_of_a_ring() {
        let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / 100.0;
        let ring: Vec<Spot> =
            (0..100).map(|i| spot(scalar::cos(angle(i)), scalar::sin(angle(i)), 1.0)).collect();
        let extent = Extent::of(&ring, Whole { amount: 1e6, diagonal: 3.0, unit: None }).unwrap();
        assert!((extent.centre.length() - 1.0).abs() < 1e-9, "{extent:?}");
        assert_eq!(extent.percent(), "less than 0.1 %");
    }
}
