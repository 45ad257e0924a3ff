//! The displaced mesh, moved like the low-poly one.

use super::rig::{binding, rig};
use rayon::prelude::*;
use taotie_engine::Result;
use taotie_engine::bake::UvLookup;
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::deform::skin;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};

/// The distance at which the surface around a point is probed, metres: small compared with the bend, large compared
/// with rounding errors.
const STEP: f32 = 1e-4;

/// A vessel with its relief as geometry, at a moment of pouring.
pub struct Truth {
    scene: Scene,
    lookup: UvLookup,
}

impl Truth {
    /// Poses the displaced mesh `rest` at a moment.
    ///
    /// Its normals do not come from the skin: at each vertex, two pairs of nearby points in the tangent plane are
    /// moved by the skin, and the normal is perpendicular to both moved pairs. It therefore includes shearing and
    /// stretching of the surface, which the rule for skinned normals ignores.
    ///
    /// # Errors
    /// None for a displaced mesh unless the time is NaN.
    pub fn at(rest: &Mesh, seconds: f64) -> Result<Self> {
        let instances = vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }];
        let (meshes, materials) = (vec![moved_mesh(rest, seconds)?], vec![Material::default()]);
        let scene = Scene::new(SceneData { meshes, materials, instances, ..SceneData::default() })?;
        Ok(Self { lookup: UvLookup::new(&scene)?, scene })
    }

    /// Returns its mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.scene.meshes()[0]
    }

    /// Returns the unit normal at this uv, if the uv is on the mesh.
    pub fn normal(&self, uv: Vec2) -> Option<Vec3> {
        self.lookup.at(uv).map(|(_, normal)| normal)
    }
}

fn moved_mesh(rest: &Mesh, seconds: f64) -> Result<Mesh> {
    let rig = rig(rest);
    let joints = rig.data().skins[0].joint_matrices(&rig.world_matrices(0, seconds)?);
    let positions = moved(rest.positions().to_vec(), &joints)?;
    let [right, left, up, down] = probes(rest).map(|points| moved(points, &joints));
    let (right, left, up, down) = (right?, left?, up?, down?);
    let normal = |i: usize| {
        let along = [right[i] - left[i], up[i] - down[i]].map(Vec3::to_f64);
        along[0].cross(along[1]).normalize_or(rest.normals()[i].to_f64()).to_f32()
    };
    let normals = (0..positions.len()).into_par_iter().map(normal).collect();
    let (uvs, triangles) = (rest.uvs().to_vec(), rest.triangles().to_vec());
    Mesh::new(MeshData { positions, normals, uvs, triangles, ..MeshData::default() })
}

fn moved(positions: Vec<Vec3>, joints: &[Mat4]) -> Result<Vec<Vec3>> {
    let binding = binding(&positions);
    let mut data = MeshData { positions, ..MeshData::default() };
    skin(&mut data, &binding, joints)?;
    Ok(data.positions)
}

/// Returns points right, left, above and below each vertex in its tangent plane, right-handed about its normal.
fn probes(rest: &Mesh) -> [Vec<Vec3>; 4] {
    let pairs = || rest.positions().par_iter().zip(rest.normals());
    let step = |sign: f32, across: bool| {
        let probe = |(p, n): (&Vec3, &Vec3)| {
            let any = if n.x.abs() < 0.7 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
            let right = any.cross(*n).normalize();
            *p + if across { right } else { n.cross(right) } * (sign * STEP)
        };
        pairs().map(probe).collect()
    };
    [step(1.0, true), step(-1.0, true), step(1.0, false), step(-1.0, false)]
}

#[cfg(test)]
mod tests {
    use super::super::pouring::Pouring;
    use super::super::rig::{POURED, follows};
    use super::*;
    use crate::jue::{displaced_mesh, scene};
    use taotie_engine::compare::angle_deg;

    /// Coarse, since every vertex is checked.
    fn vessel() -> Mesh {
        displaced_mesh(0.004)
    }

    fn worst(pairs: impl Iterator<Item = (Vec3, Vec3)>) -> f64 {
        pairs.map(|(a, b)| angle_deg(a.to_f64(), b.to_f64())).fold(0.0, f64::max)
    }

    #[test]
    fn at_rest_the_truth_is_the_displaced_mesh() {
        let rest = vessel();
        let truth = moved_mesh(&rest, 0.0).unwrap();
        assert_eq!(truth.positions(), rest.positions());
        assert!(worst(truth.normals().iter().copied().zip(rest.normals().iter().copied())) < 0.05);
    }

    #[test]
    fn normals_of_the_cup_turn_and_those_of_the_legs_follow_the_bend() {
        let rest = vessel();
        let truth = moved_mesh(&rest, POURED).unwrap();
        let motion = Pouring::new(scene(16)).unwrap().motion(POURED).unwrap();
        let turned = |i: usize| motion.transform_vector(rest.normals()[i].to_f64()).to_f32();
        let on_cup = (0..rest.positions().len()).filter(|i| rest.positions()[*i].y > 0.0902);
        assert!(worst(on_cup.map(|i| (turned(i), truth.normals()[i]))) < 0.05);
        // Normals are perpendicular to the surrounding triangles, as far as those are flat.
        let mut angles = Vec::new();
        for (t, triangle) in truth.triangles().iter().enumerate() {
            let [a, b, c] = truth.corners(t).map(Vec3::to_f64);
            let bends = rest.corners(t).iter().all(|p| follows(*p) > 0.05 && follows(*p) < 0.95);
            if bends {
                let face = (b - a).cross(c - a);
                angles.extend(triangle.map(|i| angle_deg(face, truth.normals()[i as usize].to_f64())));
            }
        }
        angles.sort_by(f64::total_cmp);
        let median = angles[angles.len() / 2];
        assert!(angles.len() > 100 && median < 4.0, "{median} of {}", angles.len());
    }
}
