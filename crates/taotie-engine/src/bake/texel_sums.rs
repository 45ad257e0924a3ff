//! The values of a texel: means over its samples of materials, positions, vertex colours and depths; the
//! material and object of most of them; and the alpha mode of each triangle of a low-poly mesh, that of most of the
//! surface it represents.

use super::appearance::MaterialSample;
use super::cage::Cage;
use super::maps::{BandMaps, MapKind, Plane};
use super::scan::Scan;
use super::sky::Depth;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::scene::AlphaMode;

/// The minimum weight of a colour, far below one code of alpha: fully transparent places still have a colour, which
/// has no effect next to any other.
const LEAST_WEIGHT: f32 = 1e-6;

/// Sums over the samples of a texel that have a correspondence. Colours are weighted by alpha, so that no colour of
/// transparent places bleeds in.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MaterialSums {
    count: u32,
    color: Vec3,
    weight: f32,
    /// Except for colour, sums are of differences from the first sample: constant values stay bit-identical.
    first: Option<MaterialSample>,
    rest: Rest,
}

/// Sums of differences from the first sample.
#[derive(Debug, Clone, Copy, Default)]
struct Rest {
    alpha: f32,
    metallic: f32,
    roughness: f32,
    occlusion: f32,
    emission: Vec3,
}

impl MaterialSums {
    /// Adds a sample.
    pub fn add(&mut self, sample: MaterialSample) {
        let first = *self.first.get_or_insert(sample);
        let weight = sample.alpha.max(LEAST_WEIGHT);
        self.count += 1;
        self.color += sample.color * weight;
        self.weight += weight;
        self.rest.alpha += sample.alpha - first.alpha;
        self.rest.metallic += sample.metallic - first.metallic;
        self.rest.roughness += sample.roughness - first.roughness;
        self.rest.occlusion += sample.occlusion - first.occlusion;
        self.rest.emission += sample.emission - first.emission;
    }

    /// Returns the mean; `None` without a sample.
    pub fn mean(&self) -> Option<MaterialSample> {
        let (first, rest) = (self.first?, self.rest);
        let share = 1.0 / self.count as f32;
        Some(MaterialSample {
            color: self.color * (1.0 / self.weight),
            alpha: first.alpha + rest.alpha * share,
            metallic: first.metallic + rest.metallic * share,
            roughness: first.roughness + rest.roughness * share,
            occlusion: first.occlusion + rest.occlusion * share,
            emission: first.emission + rest.emission * share,
        })
    }
}

/// The barycentric weights of the points of a triangle that are projected onto the scan: its centre, and six points
/// around it.
const POINTS: [[f32; 3]; 7] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.6, 0.2, 0.2],
    [0.2, 0.6, 0.2],
    [0.2, 0.2, 0.6],
    [0.45, 0.45, 0.1],
    [0.45, 0.1, 0.45],
    [0.1, 0.45, 0.45],
];

impl Scan {
    /// Returns the alpha mode of each triangle of a low-poly mesh: the most frequent one among points of the scan
    /// onto which a few of its points are projected, as texels are. Masks with several cutoffs count as one with the
    /// cutoff 0.5. In a tie, the more transparent mode wins; a triangle that finds no scan is opaque.
    pub fn alpha_modes(&self, low: &Mesh, cage: &Cage) -> Vec<AlphaMode> {
        let count = low.triangles().len();
        match self.surface().alpha_modes().as_slice() {
            [only] => vec![*only; count],
            modes => parallel::collect(count, |t| {
                let points = POINTS.iter().map(|weights| Point { triangle: t as u32, weights: *weights });
                let most = most(points.filter_map(|point| self.rank_at(low, cage, point)));
                modes.iter().copied().find(|mode| rank(*mode) == most).unwrap_or_default()
            }),
        }
    }

    /// Returns the rank of the mode at a point of the low-poly mesh; `None` if it finds no scan.
    fn rank_at(&self, low: &Mesh, cage: &Cage, point: Point) -> Option<usize> {
        let projection = cage.projection_ray(low, point);
        let found = self.project(&projection).or_else(|| cage.fallback(self, &projection))?;
        Some(rank(self.surface().material(found.point.triangle).alpha))
    }
}

/// Returns the rank of a mode among all kinds: the higher, the more transparent.
fn rank(mode: AlphaMode) -> usize {
    match mode {
        AlphaMode::Opaque => 0,
        AlphaMode::Mask(_) => 1,
        AlphaMode::Blend => 2,
    }
}

/// Returns the most frequent of the ranks, the highest in a tie; 0 if there is none.
fn most(ranks: impl Iterator<Item = usize>) -> usize {
    let mut counts = [0; 3];
    ranks.for_each(|rank| counts[rank] += 1);
    (1..3).fold(0, |most, rank| if counts[rank] > 0 && counts[rank] >= counts[most] { rank } else { most })
}

/// The maps of the scan's points.
pub(super) const OF_POINTS: [MapKind; 8] = [
    MapKind::Position,
    MapKind::Gradient,
    MapKind::Thickness,
    MapKind::VertexColor,
    MapKind::MaterialId,
    MapKind::ObjectId,
    MapKind::Bevel,
    MapKind::VectorDisplacement,
];

/// Sums over the samples of a texel that have a correspondence.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PointSums {
    count: u32,
    /// Sums of positions are of differences from the first, which are small.
    first: Vec3,
    rest: Vec3,
    color: Vec3,
    bevel: Vec3,
    /// Sum of the vectors from the low-poly mesh.
    way: Vec3,
    depth: Depth,
    material: Majority,
    object: Majority,
}

impl PointSums {
    /// Adds a point.
    pub fn add(&mut self, scan: &Scan, point: Point) {
        let position = point.position(scan.mesh());
        if self.count == 0 {
            self.first = position;
        }
        self.count += 1;
        self.rest += position - self.first;
        if !scan.mesh().colors().is_empty() {
            self.color += point.color(scan.mesh());
        }
        self.material.add(scan.surface().material_number(point.triangle) as u32);
        self.object.add(scan.object_number(point.triangle) as u32);
    }

    /// Adds a unit normal with rounded edges.
    pub fn add_bevel(&mut self, normal: Vec3) {
        self.bevel += normal;
    }

    /// Adds a vector from the low-poly mesh to a point.
    pub fn add_way(&mut self, way: Vec3) {
        self.way += way;
    }

    /// Returns the sum of normals with rounded edges.
    pub fn bevel(&self) -> Vec3 {
        self.bevel
    }

    /// Returns the mean vector from the low-poly mesh; `None` without points.
    pub fn way(&self) -> Option<Vec3> {
        (self.count > 0).then(|| self.way * (1.0 / self.count as f32))
    }

    /// Adds the depth below a point.
    pub fn add_depth(&mut self, depth: Depth) {
        self.depth.distance += depth.distance;
        self.depth.weight += depth.weight;
    }

    /// Writes the means; without points, NaN, which [`super::fill`] replaces by what is around it.
    pub fn store(&self, texel: usize, maps: &mut BandMaps<'_>) {
        if self.count == 0 {
            let missing = Vec3::splat(f32::NAN);
            [Plane::Position, Plane::VertexColor]
                .into_iter()
                .for_each(|plane| maps.set_vector(plane, texel, missing));
            let numbers = [Plane::Thickness, Plane::MaterialId, Plane::ObjectId];
            numbers.into_iter().for_each(|plane| maps.set(plane, texel, f32::NAN));
            return;
        }
        let share = 1.0 / self.count as f32;
        maps.set_vector(Plane::Position, texel, self.first + self.rest * share);
        maps.set_vector(Plane::VertexColor, texel, self.color * share);
        maps.set(Plane::Thickness, texel, self.depth.mean());
        maps.set(Plane::MaterialId, texel, self.material.value as f32);
        maps.set(Plane::ObjectId, texel, self.object.value as f32);
    }
}

/// The number that most of those added are, if more than half of them are the same.
///
/// Source: Boyer and Moore 1981, "MJRTY: a fast majority vote algorithm".
#[derive(Debug, Clone, Copy, Default)]
struct Majority {
    value: u32,
    lead: u32,
}

impl Majority {
    fn add(&mut self, value: u32) {
        match self.lead {
            0 => *self = Self { value, lead: 1 },
            _ if value == self.value => self.lead += 1,
            _ => self.lead -= 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(value: f32, alpha: f32) -> MaterialSample {
        MaterialSample {
            color: Vec3::splat(value),
            alpha,
            metallic: value,
            roughness: value,
            occlusion: value,
            emission: Vec3::splat(value),
        }
    }

    #[test]
    fn what_is_the_same_everywhere_stays_so_to_the_bit() {
        for count in 1..70 {
            let mut sums = MaterialSums::default();
            (0..count).for_each(|_| sums.add(sample(0.1, 0.7)));
            let mean = sums.mean().unwrap();
            let rest = MaterialSample { color: mean.color, ..sample(0.1, 0.7) };
            assert_eq!(mean, rest);
            assert!((mean.color.x - 0.1).abs() < 1e-6);
        }
    }

    #[test]
    fn colours_count_by_their_alpha() {
        let mut sums = MaterialSums::default();
        assert!(sums.mean().is_none());
        sums.add(sample(1.0, 0.75));
        sums.add(sample(0.0, 0.25));
        let mean = sums.mean().unwrap();
        assert_eq!((mean.color.x, mean.alpha, mean.metallic), (0.75, 0.5, 0.5));
        let mut faint = MaterialSums::default();
        faint.add(sample(1.0, 1.0 / 255.0));
        faint.add(sample(0.0, 0.0));
        assert!(faint.mean().unwrap().color.x > 0.999);
        let mut hidden = MaterialSums::default();
        hidden.add(sample(0.3, 0.0));
        assert!((hidden.mean().unwrap().color.x - 0.3).abs() < 1e-6);
    }

    #[test]
    fn most_points_decide_and_then_what_lets_more_through() {
        let of = |ranks: &[usize]| most(ranks.iter().copied());
        assert_eq!(of(&[]), 0);
        assert_eq!((of(&[0, 0, 1]), of(&[1, 2, 1]), of(&[2, 2, 0])), (0, 1, 2));
        assert_eq!((of(&[0, 1]), of(&[1, 2, 0]), of(&[0, 2, 2, 0, 1])), (1, 2, 2));
    }

    #[test]
    fn the_points_lie_within_the_triangle_and_balance() {
        let mut sum = [0.0; 3];
        for weights in POINTS {
            assert!(weights.iter().all(|w| *w > 0.0) && (weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            sum.iter_mut().zip(weights).for_each(|(sum, w)| *sum += w);
        }
        assert!(sum.iter().all(|sum| (sum - 7.0 / 3.0).abs() < 1e-5), "{sum:?}");
    }

    #[test]
    fn most_of_them_decide_in_any_order() {
        for values in [[7, 7, 7, 1, 2], [1, 7, 2, 7, 7], [7, 1, 7, 2, 7]] {
            let mut majority = Majority::default();
            values.iter().for_each(|value| majority.add(*value));
            assert_eq!(majority.value, 7);
        }
    }
}
