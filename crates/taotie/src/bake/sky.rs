//! How much of the hemisphere over a point of a scan is open.

use super::scan::Scan;
use crate::math::{Vec3, scalar, sequence::Sequence};
use crate::surface;
use crate::trace::Ray;

/// Sets of directions that texels choose from.
const SETS: usize = 64;

/// Directions over a hemisphere about z, their density proportional to the cosine, in many sets of equal size.
pub(super) struct Sky {
    directions: Vec<Vec3>,
    count: usize,
    /// How far what is in the way counts, model units.
    reach: f32,
    /// How far rays begin above the surface.
    lift: f32,
}

/// What was seen of the hemisphere.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Open {
    /// The open part, weighted by the cosine: [0, 1].
    pub part: f32,
    /// The sum of open directions over their number in all.
    pub direction: Vec3,
}

impl Sky {
    /// `count` directions a set; what is farther than `reach` away does not count.
    ///
    /// Directions are a disc's points raised to the hemisphere (Malley's method): Pharr, Jakob and Humphreys 2023,
    /// "Physically Based Rendering", 4th ed., A.5.3.
    pub fn new(count: usize, reach: f32, diagonal: f64) -> Self {
        let direction = |set: usize, i: usize| {
            let [u, v, ..] = Sequence::new(set as u32).four(i as u32, 0);
            let angle = std::f64::consts::TAU * f64::from(v);
            let radius = f64::from(u).sqrt();
            let height = (1.0 - f64::from(u)).max(0.0).sqrt();
            Vec3::new(radius * scalar::cos(angle), radius * scalar::sin(angle), height).to_f32()
        };
        let directions = (0..SETS * count).map(|k| direction(k / count, k % count)).collect();
        Self { directions, count, reach, lift: (diagonal * 1e-5) as f32 }
    }

    /// Looks out from a point of a triangle of the scan. `seed` chooses the set.
    pub fn open(&self, scan: &Scan, triangle: u32, weights: [f32; 3], seed: u32) -> Open {
        let normal = scan.normal(triangle, weights);
        let facet = surface::facet_normal(scan.mesh().corners(triangle as usize)).unwrap_or(normal);
        let facet = if facet.dot(normal) < 0.0 { -facet } else { facet };
        let origin = scan.point(triangle, weights) + facet * self.lift;
        let x = normal.any_perpendicular();
        let y = normal.cross(x);
        let set = seed as usize % SETS * self.count;
        let (mut seen, mut looked) = (Vec3::default(), 0);
        let mut open = 0;
        for local in &self.directions[set..set + self.count] {
            let direction = x * local.x + y * local.y + normal * local.z;
            // Below the facet there is nothing to be seen; the smooth surface that it stands for would see it.
            if direction.dot(facet) <= 0.0 {
                continue;
            }
            looked += 1;
            if !scan.bvh().occluded(&Ray::new(origin, direction), self.reach, |_| true) {
                open += 1;
                seen += direction;
            }
        }
        let share = 1.0 / looked.max(1) as f32;
        Open { part: open as f32 * share, direction: seen * share }
    }
}
