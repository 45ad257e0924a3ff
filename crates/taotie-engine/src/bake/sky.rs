//! Rays around a point of a scan: the open part of the hemisphere over it, the depth below it, and normals
//! with rounded edges.

use super::projection::{Among, Correspondence};
use super::scan::{Open, RayCaster, Scan, SkyPoint, SkyRays};
use crate::error::Result;
use crate::math::{Vec2, Vec3, integration, scalar};
use crate::mesh::Mesh;
use crate::surface::facet_normal;
use crate::trace::{Hit, PacketOrigins, ParallelRays, Ray};
use std::cell::Cell;

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

/// The part of a scan that rays see.
#[derive(Clone, Copy)]
pub(crate) struct Seen<'a> {
    pub scan: &'a Scan,
    /// The objects that count; `None` for all.
    pub among: Option<Among<'a>>,
}

impl Seen<'_> {
    /// Returns `true` if a hit is on an object that counts.
    #[inline]
    pub fn has(&self, hit: &Hit) -> bool {
        self.scan.is_among(self.among, hit.triangle)
    }
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
    pub fn point(&self, seen: Seen<'_>, found: &Correspondence, class: u32) -> SkyPoint {
        let facet = facet_of(seen.scan, found);
        let origin = found.point.position(seen.scan.mesh()) + facet * self.offset;
        let group = seen.among.map(|among| among.group);
        SkyPoint { origin, normal: found.normal, facet, class: class % self.classes, group }
    }

    /// Follows the directions into the surface below a point. Those that leave the scan without meeting it, as through
    /// a hole, do not count.
    pub fn depth(&self, seen: Seen<'_>, sample: &SkyPoint) -> Depth {
        let below = sample.origin - sample.facet * (2.0 * self.offset);
        let mut depth = Depth::default();
        let own = self.directions.iter().skip(sample.class as usize).step_by(self.classes as usize);
        for direction in own.filter(|direction| direction.dot(sample.facet) < 0.0) {
            let weight = -direction.dot(sample.normal);
            let hit = (weight > 0.0).then(|| {
                let ray = Ray::new(below, *direction);
                seen.scan.bvh().nearest_of(&ray, f32::INFINITY, |hit| seen.has(hit))
            });
            if let Some(hit) = hit.flatten() {
                depth.distance += (hit.distance + self.offset) * weight;
                depth.weight += weight;
            }
        }
        depth
    }

    /// Samples the sky of each of these points on a device; `groups` are those of the scan's parts.
    ///
    /// # Errors
    /// Those of the device.
    pub fn open_by(
        &self,
        caster: &dyn RayCaster,
        points: &[SkyPoint],
        groups: &[Option<u32>],
    ) -> Result<Vec<Open>> {
        let Self { directions, classes, distance, .. } = self;
        let sky = SkyRays { directions, classes: *classes, distance: *distance };
        caster.open(sky, points, groups)
    }

    /// Samples the sky of each of these points; neighbours should be consecutive.
    pub fn open(&self, seen: Seen<'_>, ao_samples: &[SkyPoint]) -> Vec<Open> {
        let mut open = vec![Open::default(); ao_samples.len()];
        for (class, direction) in self.classes(ao_samples).iter().cycle().zip(&self.directions) {
            let look = class.look(*direction);
            let unblocked = self.unblocked(seen, &look);
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
    fn classes(&self, ao_samples: &[SkyPoint]) -> Vec<Class> {
        let of = |class| {
            let numbers: Vec<usize> =
                (0..ao_samples.len()).filter(|k| ao_samples[*k].class == class).collect();
            Class::new(ao_samples, numbers)
        };
        (0..self.classes).map(of).collect()
    }

    /// Returns the samples whose rays are unblocked, among those with a weight, one bit each.
    fn unblocked(&self, seen: Seen<'_>, look: &Look<'_>) -> Vec<u8> {
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
                *weight > 0.0 && !seen.scan.bvh().occluded(&ray, self.distance, |hit| seen.has(hit))
            });
        };
        seen.scan.bvh().meet_all(&mut packet, |_, hit| hit.distance >= self.distance || !seen.has(&hit));
        packet.into_going()
    }
}

/// Returns the normal of the triangle at a correspondence, on the side of its smooth normal.
pub(crate) fn facet_of(scan: &Scan, found: &Correspondence) -> Vec3 {
    let facet = facet_normal(scan.mesh().corners(found.point.triangle as usize)).unwrap_or(found.normal);
    if facet.dot(found.normal) < 0.0 { -facet } else { facet }
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
    fn new(ao_samples: &[SkyPoint], numbers: Vec<usize>) -> Self {
        let column =
            |value: &dyn Fn(&SkyPoint) -> f32| numbers.iter().map(|k| value(&ao_samples[*k])).collect();
        let normals = [0, 1, 2].map(|axis| column(&|sample: &SkyPoint| sample.normal.to_array()[axis]));
        let facets = [0, 1, 2].map(|axis| column(&|sample: &SkyPoint| sample.facet.to_array()[axis]));
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

/// A ball around each point of a scan over which its normals are averaged.
///
/// The average is over the surface within the ball, weighted by (1 − distance / radius)³. It is integrated by lines
/// through a disk: half of them along the normal, and a quarter along each of two tangents, so that walls that are
/// parallel to the normal count too; each hit is divided by the density with which all lines meet the surface there.
/// Source: King et al. 2013, "BSSRDF importance sampling", with a uniform density on the disks.
pub(crate) struct Bevel {
    /// Model units.
    radius: f32,
    /// Lines, the same for every point of a map.
    lines: Vec<Line>,
    /// Samples per texel, which share the lines among them.
    classes: usize,
}

/// A line through the disk around a point.
#[derive(Clone, Copy)]
struct Line {
    /// The normal, 0, or a tangent, 1 or 2.
    axis: usize,
    /// Where it meets the unit disk perpendicular to it.
    at: Vec2,
}

/// The share of lines along the normal and each of the two tangents.
const SHARES: [f32; 3] = [0.5, 0.25, 0.25];
/// Surfaces that face away more than this do not count: they are the back of something thin.
const FACING_AWAY: f32 = -0.5;

impl Bevel {
    /// Makes about `rays` lines for each texel of `classes` samples; without a radius, it is 1 % of the scan's diagonal.
    pub fn of_scan(scan: &Mesh, radius: Option<f32>, (rays, classes): (u32, u32)) -> Self {
        const RADIUS: f64 = 0.01;
        let radius = radius.unwrap_or((scan.diagonal() * RADIUS) as f32);
        let points = integration::Sequence::new(0);
        let line = |i: u32| {
            let [u, v, w, _] = points.four(i, 0);
            let (r, angle) = (f64::from(u).sqrt(), std::f64::consts::TAU * f64::from(v));
            let at = Vec2::new((r * scalar::cos(angle)) as f32, (r * scalar::sin(angle)) as f32);
            let axis = if w < SHARES[0] { 0 } else { 1 + usize::from(w >= SHARES[0] + SHARES[1]) };
            Line { axis, at }
        };
        let count = rays.div_ceil(classes) * classes;
        Self { radius, lines: (0..count).map(line).collect(), classes: classes as usize }
    }

    /// Returns the average normal at a correspondence, not normalised; `class` is the sample's index within its texel.
    pub fn normal(&self, seen: Seen<'_>, found: &Correspondence, class: u32) -> Vec3 {
        let scan = seen.scan;
        let center = found.point.position(scan.mesh());
        let normal = facet_of(scan, found);
        let tangent = normal.any_perpendicular();
        let around =
            Around { seen, center, axes: [normal, tangent, normal.cross(tangent)], radius: self.radius };
        // Runs of a low-discrepancy sequence are well distributed; every fourth of its points, say, would not be.
        let each = self.lines.len() / self.classes;
        let own = self.lines.iter().skip(class as usize % self.classes * each).take(each);
        let sum = own.fold(Vec3::default(), |sum, line| sum + around.along(*line));
        sum.normalize_or(found.normal)
    }
}

/// The surroundings of a point.
struct Around<'a> {
    seen: Seen<'a>,
    center: Vec3,
    /// The normal and two tangents.
    axes: [Vec3; 3],
    radius: f32,
}

impl Around<'_> {
    /// Returns the sum of normals that a line meets.
    fn along(&self, Line { axis, at }: Line) -> Vec3 {
        let direction = -self.axes[axis];
        let across = self.axes[(axis + 1) % 3] * at.x + self.axes[(axis + 2) % 3] * at.y;
        let half = self.radius * (1.0 - at.x * at.x - at.y * at.y).max(0.0).sqrt();
        let ray = Ray::new(self.center + across * self.radius - direction * half, direction);
        let sum = Cell::new(Vec3::default());
        // All hits are visited, since none is accepted.
        self.seen.scan.bvh().nearest_of(&ray, 2.0 * half, |hit| {
            if self.seen.has(hit) {
                sum.set(sum.get() + self.weighted(hit));
            }
            false
        });
        sum.get()
    }

    fn weighted(&self, hit: &Hit) -> Vec3 {
        let mesh = self.seen.scan.mesh();
        let Some(facet) = facet_normal(mesh.corners(hit.triangle as usize)) else { return Vec3::default() };
        let normal = hit.point().normal(mesh);
        let away = 1.0 - (hit.point().position(mesh) - self.center).length() / self.radius;
        if away <= 0.0 || normal.dot(self.axes[0]) < FACING_AWAY {
            return Vec3::default();
        }
        let cosines = self.axes.map(|axis| axis.dot(facet).abs());
        let density = cosines.into_iter().zip(SHARES).fold(0.0, |sum, (cosine, share)| sum + cosine * share);
        normal * (away * away * away / density.max(f32::MIN_POSITIVE))
    }
}
