//! The open part of the hemisphere over each point of a scan.

use super::projection::Correspondence;
use super::scan::Scan;
use crate::math::{Vec3, scalar};
use crate::surface;
use crate::trace::{PacketView, Ray, RayPacket};

/// Directions all over the sphere, the same for every point of a map, so that neighbouring texels differ by what they
/// see and not by chance, and their rays run side by side.
pub(super) struct Sky {
    directions: Vec<Vec3>,
    /// Samples a texel, which share the directions out between them.
    classes: u32,
    /// The distance within which surfaces block the rays, model units.
    distance: f32,
    /// The height above the surface at which rays begin.
    offset: f32,
}

/// A point from which the sky is looked at.
pub(super) struct AoSample {
    origin: Vec3,
    normal: Vec3,
    facet: Vec3,
    class: u32,
}

impl AoSample {
    /// Returns `true` where a direction leads away from the surface: below its facet a point sees nothing; the smooth
    /// surface that the facet stands for would.
    fn looks(&self, direction: Vec3) -> bool {
        self.normal.dot(direction) > 0.0 && self.facet.dot(direction) > 0.0
    }
}

/// The open part of a hemisphere: sums over directions, each weighted by its cosine.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Open {
    /// Of the weights of all directions.
    pub looked: f32,
    /// Of those of open ones.
    pub seen: f32,
    /// Open directions.
    pub direction: Vec3,
}

impl Sky {
    /// Makes about `rays` a texel of `classes` samples over the hemisphere; surfaces farther than `distance` away do
    /// not count.
    ///
    /// Directions are a spherical Fibonacci lattice (Keinert et al. 2015, "Spherical Fibonacci mapping", eq. 2).
    pub fn new(rays: u32, classes: u32, distance: f32, diagonal: f64) -> Self {
        // Half of the sphere lies under the surface.
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

    /// Returns the point of the scan that a sample found; `class` is the sample's number in its texel.
    pub fn ao_sample(&self, scan: &Scan, found: &Correspondence, class: u32) -> AoSample {
        let corners = scan.mesh().corners(found.point.triangle as usize);
        let facet = surface::facet_normal(corners).unwrap_or(found.normal);
        let facet = if facet.dot(found.normal) < 0.0 { -facet } else { facet };
        let origin = found.point.position(scan.mesh()) + facet * self.offset;
        AoSample { origin, normal: found.normal, facet, class: class % self.classes }
    }

    /// Looks out from each of these points, which should lie near one another.
    pub fn open(&self, scan: &Scan, ao_samples: &[AoSample]) -> Vec<Open> {
        let mut open = vec![Open::default(); ao_samples.len()];
        let mut looking = Vec::with_capacity(ao_samples.len());
        for (class, direction) in self.by_class(ao_samples).iter().cycle().zip(&self.directions) {
            looking.clear();
            looking.extend(class.iter().copied().filter(|k| ao_samples[*k].looks(*direction)));
            let blocked = self.blocked(scan, ao_samples, &looking, *direction);
            for (k, blocked) in looking.iter().zip(blocked) {
                let weight = ao_samples[*k].normal.dot(*direction);
                open[*k].looked += weight;
                if !blocked {
                    open[*k].seen += weight;
                    open[*k].direction += *direction * weight;
                }
            }
        }
        open
    }

    /// Returns the samples of each class; direction `i` belongs to class `i` modulo their number.
    fn by_class(&self, ao_samples: &[AoSample]) -> Vec<Vec<usize>> {
        let mut classes = vec![Vec::new(); self.classes as usize];
        for (k, sample) in ao_samples.iter().enumerate() {
            classes[sample.class as usize].push(k);
        }
        classes
    }

    /// Returns for each of these points whether something blocks its ray.
    fn blocked(&self, scan: &Scan, ao_samples: &[AoSample], looking: &[usize], direction: Vec3) -> Vec<bool> {
        /// Fewer rays are faster one by one.
        const FEW: usize = 6;
        let along = Ray::new(Vec3::default(), direction);
        let rays: Vec<Ray> = looking.iter().map(|k| along.from(ao_samples[*k].origin)).collect();
        let packet = (rays.len() > FEW).then(|| self.packet(&rays, direction)).flatten();
        let Some(packet) = packet else {
            return rays.iter().map(|ray| scan.bvh().occluded(ray, self.distance, |_| true)).collect();
        };
        let mut blocked = vec![false; rays.len()];
        let mut open = rays.len();
        scan.bvh().meet_all(&packet, |ray, hit| {
            if hit.distance < self.distance && !blocked[ray] {
                blocked[ray] = true;
                open -= 1;
            }
            open > 0
        });
        blocked
    }

    fn packet<'a>(&self, rays: &'a [Ray], direction: Vec3) -> Option<RayPacket<'a>> {
        let x = direction.any_perpendicular();
        let axes = [x, direction.cross(x), direction];
        let origin = rays.first()?.origin();
        let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
        let mut places = Vec::with_capacity(rays.len());
        for ray in rays {
            let [column, row, depth] = axes.map(|axis| axis.dot(ray.origin() - origin));
            places.push([column, row]);
            (nearest, farthest) = (nearest.min(depth), farthest.max(depth));
        }
        // Rounding of places and of their shadows, which grows with how far away they are from zero.
        let slack = (origin.length() + farthest - nearest) * 2e-6 + self.offset * 0.1;
        let depths = [nearest - slack, farthest + self.distance];
        RayPacket::new(rays, &places, PacketView { origin, axes, slack: [slack; 2], depths })
    }
}
