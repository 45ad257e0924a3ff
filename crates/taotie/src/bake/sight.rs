//! What a viewer sees along a ray: the first surface that is drawn, and its normal as it is shaded.

use super::appearance::MaterialSample;
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::math::Vec3;
use crate::mesh::Point;
use crate::scene::AlphaMode;
use crate::trace::{Hit, Ray};

/// The alpha from which on a blended surface hides what is behind it.
const HALF: f32 = 0.5;

impl Scan {
    /// Returns the first hit below the distance `limit` that a renderer draws: front faces, back faces of double-sided
    /// materials, and nothing that alpha makes transparent.
    pub fn first_seen(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        let toward = -ray.direction();
        self.bvh().nearest_of(ray, limit, |hit| self.is_drawn(hit.point(), toward))
    }

    /// Returns `true` if nothing but what alpha makes transparent lies between the ray's origin and the distance `limit`.
    pub fn is_seen_along(&self, ray: &Ray, limit: f32) -> bool {
        !self.bvh().occluded(ray, limit, |hit| self.is_opaque_at(hit.point()))
    }

    /// Returns the normal that a renderer shades a point with, unit, read as finely as `at.width`, for a viewer in the
    /// direction `toward`: the back of a double-sided material shows it reversed.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn seen_normal(&self, at: LookupPoint, toward: Vec3) -> Vec3 {
        let smooth = at.point.normal(self.mesh());
        let normal = self.surface().normal(at, smooth).normal;
        if self.faces(at.point.triangle, toward) { normal } else { -normal }
    }

    /// Returns the material at a point, read as finely as `at.width`.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn seen_material(&self, at: LookupPoint) -> MaterialSample {
        self.surface().sample(at)
    }

    /// Returns `true` if a renderer draws this point for a viewer in the direction `toward`.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn is_drawn(&self, point: Point, toward: Vec3) -> bool {
        let material = self.surface().material(point.triangle);
        if !material.double_sided && !self.faces(point.triangle, toward) {
            return false;
        }
        self.is_opaque_at(point)
    }

    /// Returns `true` if alpha does not make the surface transparent at a point: it reaches a mask's cutoff, or a half.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn is_opaque_at(&self, point: Point) -> bool {
        let alpha = || self.surface().sample(LookupPoint::finest(point)).alpha;
        match self.surface().material(point.triangle).alpha {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => alpha() >= cutoff,
            AlphaMode::Blend => alpha() >= HALF,
        }
    }

    /// Returns `true` if the front of a triangle, where its corners run counter-clockwise, is turned to `toward`.
    pub(super) fn faces(&self, triangle: u32, toward: Vec3) -> bool {
        let [a, b, c] = self.mesh().corners(triangle as usize);
        (b - a).cross(c - a).dot(toward) > 0.0
    }
}
