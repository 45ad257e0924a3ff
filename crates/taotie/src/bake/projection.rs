//! From a light surface to the heavy one that it stands for.

use super::corners::Corners;
use crate::math::Vec3;
use crate::scene::Scene;
use crate::trace::{Bvh, Ray};

/// The triangles of a heavy scene, ready to be found from points of a light one.
pub struct Projector {
    bvh: Bvh,
    corners: Corners,
}

/// How far behind a point its rays begin, as a part of the reach.
const BEHIND: f32 = 1e-3;

/// The point of the heavy surface that a point of the light one stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Along the normal that was followed: above 0 outside the light surface, model units.
    pub height: f32,
    /// The interpolated normal there: unit, world space.
    pub normal: Vec3,
}

impl Projector {
    /// Sorts all triangles of `scene`. Normal maps of its materials are not read: its relief is its geometry.
    pub fn new(scene: &Scene) -> Self {
        let mut corners = Corners::default();
        scene.instances.iter().for_each(|instance| corners.add(scene, instance));
        Self { bvh: Bvh::build(&corners.positions), corners }
    }

    /// The nearer of the first hits along `normal` (unit) and against it, at most `reach` away from `point`, if the
    /// surface there faces as `normal` does; a hit that does not is the far side of something else, and no match.
    pub fn project(&self, point: Vec3, normal: Vec3, reach: f32) -> Option<Match> {
        let outward = self.first(point, normal, reach);
        let inward = self.first(point, -normal, reach).map(|m| Match { height: -m.height, ..m });
        let [outward, inward] = [outward, inward].map(|m| m.map(|m| (m.height.abs(), m)));
        let nearer = match (outward, inward) {
            (Some((out, m)), Some((into, _))) if out <= into => m,
            (_, Some((_, m))) | (Some((_, m)), None) => m,
            (None, None) => return None,
        };
        (nearer.normal.dot(normal) > 0.0).then_some(nearer)
    }

    /// The first hit from a little behind `point`, so that a surface through the point itself is not missed.
    fn first(&self, point: Vec3, direction: Vec3, reach: f32) -> Option<Match> {
        let back = reach * BEHIND;
        let hit = self.bvh.nearest(&Ray::new(point - direction * back, direction), reach + back)?;
        Some(Match { height: hit.distance - back, normal: self.corners.normal_at(&hit) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Mat4;
    use crate::mesh::{Mesh, MeshData};
    use crate::scene::{Instance, Material};

    /// Two squares above each other, the lower facing up, the upper down.
    fn sheets() -> Scene {
        let square = |z: f32, order: [u32; 6]| {
            let corner = |x: f32, y: f32| Vec3::new(x, y, z);
            let positions = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            let triangles = vec![[order[0], order[1], order[2]], [order[3], order[4], order[5]]];
            Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
        };
        let meshes = vec![square(0.0, [0, 1, 2, 0, 2, 3]), square(1.0, [0, 2, 1, 0, 3, 2])];
        let instances =
            (0..2).map(|mesh| Instance { mesh, material: 0, world_from_object: Mat4::IDENTITY }).collect();
        Scene { meshes, instances, materials: vec![Material::default()], ..Scene::default() }
    }

    #[test]
    fn finds_the_nearer_sheet_on_either_side() {
        let projector = Projector::new(&sheets());
        let up = Vec3::new(0.0, 0.0, 1.0);
        let at = |z: f32, reach: f32| projector.project(Vec3::new(0.3, 0.4, z), up, reach);
        let below = at(0.2, 0.5).unwrap();
        assert!((below.height + 0.2).abs() < 1e-6 && (below.normal - up).length() < 1e-6);
        let above = at(-0.1, 0.5).unwrap();
        assert!((above.height - 0.1).abs() < 1e-6);
        let on = at(0.0, 0.5).unwrap();
        assert!(on.height.abs() < 1e-6 && (on.normal - up).length() < 1e-6);
        assert!(at(0.3, 0.2).is_none(), "beyond reach");
        assert!(at(0.9, 0.5).is_none(), "the nearer sheet faces the other way");
    }
}
