//! Normals of a scan with rounded edges.

use super::projection::Correspondence;
use super::scan::Scan;
use crate::math::{Vec2, Vec3, integration, scalar};
use crate::surface::facet_normal;
use crate::trace::{Hit, Ray};
use std::cell::Cell;

/// A ball around each point of a scan over which its normals are averaged.
///
/// The average is over the surface within the ball, weighted by (1 − distance / radius)³. It is integrated by lines
/// through a disk: half of them along the normal, and a quarter along each of two tangents, so that walls that are
/// parallel to the normal count too; each hit is divided by the density with which all lines meet the surface there.
/// Source: King et al. 2013, "BSSRDF importance sampling", with a uniform density on the disks.
pub(super) struct Bevel {
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
    /// Makes about `rays` lines for each texel of `classes` samples.
    pub fn new(radius: f32, rays: u32, classes: u32) -> Self {
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
    pub fn normal(&self, scan: &Scan, found: &Correspondence, class: u32) -> Vec3 {
        let center = found.point.position(scan.mesh());
        let normal = facet_normal(scan.mesh().corners(found.point.triangle as usize)).unwrap_or(found.normal);
        let normal = if normal.dot(found.normal) < 0.0 { -normal } else { normal };
        let tangent = normal.any_perpendicular();
        let around =
            Around { scan, center, axes: [normal, tangent, normal.cross(tangent)], radius: self.radius };
        // Runs of a low-discrepancy sequence are well distributed; every fourth of its points, say, would not be.
        let each = self.lines.len() / self.classes;
        let own = self.lines.iter().skip(class as usize % self.classes * each).take(each);
        let sum = own.fold(Vec3::default(), |sum, line| sum + around.along(*line));
        sum.normalize_or(found.normal)
    }
}

/// The surroundings of a point.
struct Around<'a> {
    scan: &'a Scan,
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
        self.scan.bvh().nearest_of(&ray, 2.0 * half, |hit| {
            sum.set(sum.get() + self.weighted(hit));
            false
        });
        sum.get()
    }

    fn weighted(&self, hit: &Hit) -> Vec3 {
        let mesh = self.scan.mesh();
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
