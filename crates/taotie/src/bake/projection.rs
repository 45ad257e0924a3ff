//! The projection of a low-poly mesh onto the high-poly surface.

use super::mapped_normal::MappedNormal;
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::math::Vec3;
use crate::mesh::Point;
use crate::trace::{Hit, Nearest, Ray, RayInterval};

/// A correspondence: the point of the high-poly surface onto which a point of the low-poly mesh is projected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correspondence {
    /// The height along the projection ray: above 0 outside the low-poly surface, in model units.
    pub height: f32,
    /// The interpolated normal there, without maps: unit, world space.
    pub normal: Vec3,
    /// The point itself, on the scan's mesh.
    pub point: Point,
}

/// A ray through a point of the low-poly mesh along which its correspondence is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectionRay {
    /// A point of the low-poly surface, world space.
    pub point: Vec3,
    /// Outward, unit.
    pub direction: Vec3,
    /// The ray distance, both into and out of the low-poly surface, in model units.
    pub distance: f32,
}

impl ProjectionRay {
    /// Returns the ray from its inner end, and its relevant interval.
    #[inline]
    pub(super) fn ray(&self) -> (Ray, RayInterval) {
        let ray = Ray::new(self.point - self.direction * self.distance, self.direction);
        (ray, RayInterval { from: 0.0, center: self.distance, to: self.distance + self.distance })
    }

    /// Returns the correspondence of a hit of [`ProjectionRay::ray`] on a surface with this normal.
    #[inline]
    pub(super) fn found(&self, hit: &Hit, normal: Vec3) -> Correspondence {
        Correspondence { height: hit.distance - self.distance, normal, point: hit.point() }
    }
}

impl Scan {
    /// Returns the nearest point on the ray at which the scan's normal points along the ray and that can be seen: a surface
    /// facing the other way is the far side of something else, and hidden walls and ghost layers do not count. If
    /// none of the points can be seen, the nearest one is used.
    pub fn project(&self, projection: &ProjectionRay) -> Option<Correspondence> {
        let (ray, interval) = projection.ray();
        let nearest = self.bvh().nearest_to(&ray, interval, |hit| self.facing(hit, projection));
        self.visible_of(projection, nearest)
    }

    /// Returns the correspondence among the nearest hits to a position on its ray. Visibility is checked only if
    /// there are several.
    pub(super) fn visible_of(
        &self,
        projection: &ProjectionRay,
        nearest: Nearest<Vec3>,
    ) -> Option<Correspondence> {
        let (hit, normal) = nearest.best()?;
        let is_visible = |hit: &Hit| self.is_visible(hit.point(), projection.direction);
        let found = match nearest.second() {
            None => (hit, normal),
            Some(_) if is_visible(&hit) => (hit, normal),
            Some((second, normal)) if is_visible(&second) => (second, normal),
            Some(_) => {
                let (ray, interval) = projection.ray();
                let facing = |hit: &Hit| self.facing(hit, projection).filter(|_| is_visible(hit));
                self.bvh().nearest_to(&ray, interval, facing).best().unwrap_or((hit, normal))
            }
        };
        Some(projection.found(&found.0, found.1))
    }

    /// Returns the normal of a correspondence with the relief of the scan's normal and height maps, sampled at the
    /// lookup width `width`, in model units; at their finest level if it is 0. Without a map it is the normal itself.
    pub fn mapped_normal(&self, found: &Correspondence, width: f32) -> MappedNormal {
        self.surface().normal(LookupPoint { point: found.point, width }, found.normal)
    }

    /// Returns the scan's normal at a hit, if it points along the ray.
    #[inline]
    pub(super) fn facing(&self, hit: &Hit, projection: &ProjectionRay) -> Option<Vec3> {
        let normal = hit.point().normal(self.mesh());
        (normal.dot(projection.direction) > 0.0).then_some(normal)
    }

    /// Returns the closest point of the scan within `most`, if its normal points along `direction`.
    pub fn closest(&self, point: Vec3, direction: Vec3, most: f32) -> Option<Correspondence> {
        let closest = self.bvh().closest(point, most)?;
        let there = closest.point();
        let normal = there.normal(self.mesh());
        let side = if (there.position(self.mesh()) - point).dot(direction) < 0.0 { -1.0 } else { 1.0 };
        let found = Correspondence { height: closest.distance * side, normal, point: there };
        (normal.dot(direction) > 0.0).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Mat4;
    use crate::mesh::{Mesh, MeshData};
    use crate::scene::{Instance, Material, Scene, SceneData};

    /// Returns two squares, one above the other, the lower facing up, the upper down.
    fn sheets() -> Scan {
        let square = |z: f32, order: [u32; 6]| {
            let corner = |x: f32, y: f32| Vec3::new(x, y, z);
            let positions = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            let triangles = vec![[order[0], order[1], order[2]], [order[3], order[4], order[5]]];
            Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
        };
        let meshes = vec![square(0.0, [0, 1, 2, 0, 2, 3]), square(1.0, [0, 2, 1, 0, 3, 2])];
        let instances =
            (0..2).map(|mesh| Instance { mesh, material: 0, world_from_object: Mat4::IDENTITY }).collect();
        let materials = vec![Material::default()];
        let data = SceneData { meshes, instances, materials, ..SceneData::default() };
        Scan::new(Scene::new(data).unwrap()).unwrap()
    }

    #[test]
    fn finds_the_nearest_sheet_that_faces_the_same_way() {
        let scan = sheets();
        let up = Vec3::new(0.0, 0.0, 1.0);
        let projection = |z: f32, direction: Vec3, distance: f32| ProjectionRay {
            point: Vec3::new(0.3, 0.4, z),
            direction,
            distance,
        };
        let at = |z: f32, distance: f32| scan.project(&projection(z, up, distance));
        let below = at(0.2, 0.5).unwrap();
        assert!((below.height + 0.2).abs() < 1e-6 && (below.normal - up).length() < 1e-6);
        assert!((at(-0.1, 0.5).unwrap().height - 0.1).abs() < 1e-6);
        let on = at(0.0, 0.5).unwrap();
        assert!(on.height.abs() < 1e-6 && (on.normal - up).length() < 1e-6);
        assert!(at(0.3, 0.2).is_none(), "beyond the ray distance");
        assert!(
            at(0.9, 0.5).is_none(),
            "the nearer sheet faces the other way, the other is beyond the ray distance"
        );
        assert!(
            (at(0.9, 1.0).unwrap().height + 0.9).abs() < 1e-6,
            "surfaces facing the other way are passed through"
        );
        let down = scan.project(&projection(0.9, -up, 0.5)).unwrap();
        assert!((down.height + 0.1).abs() < 1e-6);
    }

    #[test]
    fn the_closest_point_counts_where_it_faces_the_same_way() {
        let scan = sheets();
        let up = Vec3::new(0.0, 0.0, 1.0);
        let outside = Vec3::new(-0.3, 0.5, 0.1);
        let found = scan.closest(outside, up, 1.0).unwrap();
        assert!((found.height + 0.1f32.hypot(0.3)).abs() < 1e-6 && (found.normal - up).length() < 1e-6);
        assert!(scan.closest(outside, -up, 1.0).is_none());
        assert!(scan.closest(outside, up, 0.1).is_none());
    }
}
