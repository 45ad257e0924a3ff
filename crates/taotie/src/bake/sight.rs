//! The surface a viewer sees along a ray: the first one drawn, and its shading normal.

use super::appearance::MaterialSample;
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::math::Vec3;
use crate::mesh::Point;
use crate::trace::{Hit, Ray};

impl Scan {
    /// Returns the first hit below the distance `limit` that a renderer draws: front faces, back faces of
    /// double-sided materials, and nothing that alpha makes transparent.
    pub fn first_seen(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        let toward = -ray.direction();
        self.bvh().nearest_of(ray, limit, |hit| self.is_drawn(hit.point(), toward))
    }

    /// Returns the unit normal with which a renderer shades a point, sampled at the lookup width `at.width`, for a
    /// viewer in the direction `toward`: the back of a double-sided material shows it reversed.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn seen_normal(&self, at: LookupPoint, toward: Vec3) -> Vec3 {
        let smooth = at.point.normal(self.mesh());
        let normal = self.surface().normal(at, smooth).normal;
        if self.mesh().faces(at.point.triangle, toward) { normal } else { -normal }
    }

    /// Returns the material at a point, sampled at the lookup width `at.width`.
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
        if !material.double_sided && !self.mesh().faces(point.triangle, toward) {
            return false;
        }
        self.surface().is_opaque_at(point)
    }
}
