//! The open part of the hemisphere over each point of a scan.

use super::projection::Correspondence;
use super::scan::Scan;
use crate::math::{Vec3, scalar};
use crate::surface;
use crate::trace::{PacketOrigins, ParallelRays, Ray};

/// Directions over the whole sphere, the same for every point of a map, so that neighbouring texels differ by what
/// they see and not by noise, and their rays are parallel.
pub(super) struct Sky {
    directions: Vec<Vec3>,
    /// Samples per texel, which share the directions among them.
    classes: u32,
    /// The distance within which surfaces block the rays, in model units.
    distance: f32,
    /// The height above the surface at which rays start.
    offset: f32,
}

/// A point whose sky is sampled.
pub(super) struct AoSample {
    origin: Vec3,
    normal: Vec3,
    facet: Vec3,
    class: u32,
}

/// The open part of a hemisphere: sums over directions, each weighted by its cosine.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Open {
    /// The weights of all directions.
    pub looked: f32,
    /// The weights of open directions.
    pub seen: f32,
    /// The weighted open directions.
    pub direction: Vec3,
}

/// The distances to the surface behind a point: sums over directions into it, each weighted by its cosine.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Depth {
    /// The weighted distances.
    pub distance: f32,
    /// The weights of the directions that met a surface.
    pub weight: f32,
}

impl Depth {
    /// Returns the mean distance; 0 if there is nothing behind.
    pub fn mean(&self) -> f32 {
        if self.weight > 0.0 { self.distance / self.weight } else { 0.0 }
    }
}

impl Sky {
    /// Makes about `rays` directions over the hemisphere for each texel of `classes` samples; surfaces farther away
    /// than `distance` do not count.
    ///
    /// Directions are a spherical Fibonacci lattice (Keinert et al. 2015, "Spherical Fibonacci mapping", eq. 2).
    pub fn new(rays: u32, classes: u32, distance: f32, diagonal: f64) -> Self {
        // Half of the sphere is below the surface.
        let count = 2 * rays.max(classes);
        let golden = (5.0f64.sqrt() - 1.0) / 2.0;
        let direction = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let turn = f64::from(i) * golden;
            let angle = std::f64::consts::TAU * (turn - turn.floor());
            let ring = (1.0 - z * z).max(0.0).sqrt();
            Vec3::new(ring * scalar::cos(angle), ring * scalar::sin(angle), z).to_f32()
        };
        Self {
            directions: (0..count).map(direction).collect(),
            classes,
            distance,
            offset: (diagonal * 1e-5) as f32,
        }
    }

    /// Returns the point of the scan that a sample found; `class` is the sample's index within its texel.
    pub fn ao_sample(&self, scan: &Scan, found: &Correspondence, class: u32) -> AoSample {
        let corners = scan.mesh().corners(found.point.triangle as usize);
        let facet = surface::facet_normal(corners).unwrap_or(found.normal);
        let facet = if facet.dot(found.normal) < 0.0 { -facet } else { facet };
        let origin = found.point.position(scan.mesh()) + facet * self.offset;
        AoSample { origin, normal: found.normal, facet, class: class % self.classes }
    }

    /// Follows the directions into the surface below a point. Those that leave the scan without meeting it, as through
    /// a hole, do not count.
    pub fn depth(&self, scan: &Scan, sample: &AoSample) -> Depth {
        let below = sample.origin - sample.facet * (2.0 * self.offset);
        let mut depth = Depth::default();
        let own = self.directions.iter().skip(sample.class as usize).step_by(self.classes as usize);
        for direction in own.filter(|direction| direction.dot(sample.facet) < 0.0) {
            let weight = -direction.dot(sample.normal);
            let hit = (weight > 0.0).then(|| {
                let ray = Ray::new(below, *direction);
                scan.bvh().nearest_of(&ray, f32::INFINITY, |_| true)
            });
            if let Some(hit) = hit.flatten() {
                depth.distance += (hit.distance + self.offset) * weight;
                depth.weight += weight;
            }
        }
        depth
    }

    /// Samples the sky of each of these points; neighbours should be consecutive.
    pub fn open(&self, scan: &Scan, ao_samples: &[AoSample]) -> Vec<Open> {
        let mut open = vec![Open::default(); ao_samples.len()];
        for (class, direction) in self.classes(ao_samples).iter().cycle().zip(&self.directions) {
            let look = class.look(*direction);
            let unblocked = self.unblocked(scan, &look);
            for ((i, weight), k) in look.weights.iter().enumerate().zip(&class.numbers) {
                let open = &mut open[*k];
                open.looked += weight;
                if unblocked[i / 8] & 1 << (i % 8) != 0 {
                    open.seen += weight;
                    open.direction += *direction * *weight;
                }
            }
        }
        open
    }

    /// Returns the samples of each class; direction `i` belongs to class `i` modulo their number.
    fn classes(&self, ao_samples: &[AoSample]) -> Vec<Class> {
        let of = |class| {
            let numbers: Vec<usize> =
                (0..ao_samples.len()).filter(|k| ao_samples[*k].class == class).collect();
            Class::new(ao_samples, numbers)
        };
        (0..self.classes).map(of).collect()
    }

    /// Returns the samples whose rays are unblocked, among those with a weight, one bit each.
    fn unblocked(&self, scan: &Scan, look: &Look<'_>) -> Vec<u8> {
        /// Up to this number, rays are faster one by one.
        const FEW: u32 = 6;
        let looking = bits(&look.weights, |(_, weight)| *weight > 0.0);
        let rays =
            ParallelRays { direction: look.direction, reach: self.distance, margin: self.offset * 0.1 };
        let count: u32 = looking.iter().map(|looking| looking.count_ones()).sum();
        let packet = (count > FEW).then(|| look.class.origins.packet(looking, rays)).flatten();
        let Some(mut packet) = packet else {
            let along = Ray::new(Vec3::default(), look.direction);
            return bits(&look.weights, |(i, weight)| {
                let ray = along.from(look.class.origins.at(i));
                *weight > 0.0 && !scan.bvh().occluded(&ray, self.distance, |_| true)
            });
        };
        scan.bvh().meet_all(&mut packet, |_, hit| hit.distance >= self.distance);
        packet.into_going()
    }
}

/// Returns one answer per index as bits, eight per byte.
fn bits(numbers: &[f32], yes: impl Fn((usize, &f32)) -> bool) -> Vec<u8> {
    let mut bits = vec![0; numbers.len().div_ceil(8)];
    for (i, number) in numbers.iter().enumerate() {
        bits[i / 8] |= u8::from(yes((i, number))) << (i % 8);
    }
    bits
}

/// The samples of a class, component by component.
struct Class {
    /// Their indices among all samples.
    numbers: Vec<usize>,
    origins: PacketOrigins,
    normals: [Vec<f32>; 3],
    facets: [Vec<f32>; 3],
}

impl Class {
    fn new(ao_samples: &[AoSample], numbers: Vec<usize>) -> Self {
        let column =
            |value: &dyn Fn(&AoSample) -> f32| numbers.iter().map(|k| value(&ao_samples[*k])).collect();
        let normals = [0, 1, 2].map(|axis| column(&|sample: &AoSample| sample.normal.to_array()[axis]));
        let facets = [0, 1, 2].map(|axis| column(&|sample: &AoSample| sample.facet.to_array()[axis]));
        Self {
            origins: PacketOrigins::new(numbers.iter().map(|k| ao_samples[*k].origin)),
            normals,
            facets,
            numbers,
        }
    }

    /// Returns a look in a direction from all samples of the class.
    fn look(&self, direction: Vec3) -> Look<'_> {
        let cosines = |[x, y, z]: &[Vec<f32>; 3]| -> Vec<f32> {
            let vectors = x.iter().zip(y).zip(z);
            vectors.map(|((x, y), z)| Vec3::new(*x, *y, *z).dot(direction)).collect()
        };
        let mut weights = cosines(&self.normals);
        for (weight, facet) in weights.iter_mut().zip(cosines(&self.facets)) {
            *weight = if *weight > 0.0 && facet > 0.0 { *weight } else { 0.0 };
        }
        Look { class: self, direction, weights }
    }
}

/// A direction in which the samples of a class look.
struct Look<'a> {
    class: &'a Class,
    direction: Vec3,
    /// Its cosine at each sample; 0 if it does not point away from the surface: below its facet a point sees nothing,
    /// though the smooth surface that the facet approximates would.
    weights: Vec<f32>,
}
