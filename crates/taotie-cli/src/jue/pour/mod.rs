//! The vessel pours: feet on the ground, the cup tips over its spout and leans back, and the legs bend between.
//!
//! A skin of two joints does it. The foot's joint stands still; the cup's turns about a point between the roots of the
//! legs. How far a point follows the cup is a smooth function of its height alone, so that the light mesh and the
//! displaced one, whose vertices are elsewhere, move alike.

mod errors;
mod truth;

pub use errors::{Eye, RULE, angular_errors};
pub use truth::Truth;

use taotie::math::{Mat4, Vec3, scalar};
use taotie::mesh::Mesh;
use taotie::mesh::deform::{Binding, Deformable};
use taotie::render::{SurfaceSettings, bind_tangents};
use taotie::scene::Scene;
use taotie::scene::animation::{
    Animation, Channel, Deformed, Interpolation, Node, Path, Rig, RigData, Sampler, Skin, Transform,
};
use taotie::{Result, Warnings};

/// The time at which the cup is tipped farthest, seconds; at twice that it is upright again.
pub const POURED: f64 = 1.0;

/// How far it is tipped then, degrees.
pub const TIP_DEG: f64 = 45.0;

/// The node that is the cup's joint.
const CUP: usize = 1;

/// Where it turns, metres.
const PIVOT: Vec3<f64> = Vec3::new(0.0, 0.085, 0.0);

/// The axis about which it turns, times √2: to the spout and away from the mask at once.
const AXIS: Vec3<f64> = Vec3::new(-1.0, 0.0, -1.0);

/// Up to the first height a point stands with the foot, from the second on it goes with the cup; metres.
const BEND: [f64; 2] = [0.02, 0.09];

/// How much of the cup's motion a point takes part in, [0, 1].
fn follows(p: Vec3) -> f32 {
    let t = ((f64::from(p.y) - BEND[0]) / (BEND[1] - BEND[0])).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t)) as f32
}

/// The rig of a scene whose one instance shows `mesh`, a vessel at rest.
pub fn rig(mesh: &Mesh) -> Rig {
    let local = Transform::parts(PIVOT, [0.0, 0.0, 0.0, 1.0], Vec3::splat(1.0));
    let nodes = vec![Node::default(), Node { parent: Some(0), local, ..Node::default() }];
    let skin =
        Skin { joints: vec![0, CUP], inverse_bind_matrices: vec![Mat4::IDENTITY, Mat4::translation(-PIVOT)] };
    let shape = Deformable {
        base: mesh.clone().into_data(),
        binding: Some(binding(mesh.positions())),
        ..Deformable::default()
    };
    let data = RigData {
        nodes,
        skins: vec![skin],
        deformed: vec![Deformed { mesh: 0, node: 0, skin: Some(0), shape }],
        instances: vec![None],
        animations: vec![animation()],
        ..RigData::default()
    };
    Rig::new(data).expect("every number in it is in range")
}

/// Two joints a point, of weights that sum to one.
fn binding(points: &[Vec3]) -> Binding {
    let weights = points.iter().map(|p| follows(*p)).flat_map(|cup| [1.0 - cup, cup]).collect();
    Binding { per_vertex: 2, joints: [0, CUP as u32].repeat(points.len()), weights }
}

/// Upright, tipped, upright, easing in and out.
fn animation() -> Animation {
    let half = TIP_DEG.to_radians() / 2.0;
    let axis = AXIS.normalize() * scalar::sin(half);
    let upright = [0.0, 0.0, 0.0, 1.0];
    let tipped = [axis.x, axis.y, axis.z, scalar::cos(half)].map(|v| v as f32);
    let still = [0.0; 4];
    let values = [upright, tipped, upright].into_iter().flat_map(|value| [still, value, still]).flatten();
    let times = [0.0, 1.0, 2.0].map(|turn| turn * POURED as f32).into();
    let sampler = Sampler::new(Interpolation::CubicSpline, times, values.collect());
    Animation {
        name: "pour".into(),
        channels: vec![Channel { node: CUP, path: Path::Rotation, sampler: 0 }],
        samplers: vec![sampler.expect("times rise and every number is finite")],
    }
}

/// A vessel that can be brought to moments of its pouring.
pub struct Pouring {
    scene: Scene,
    rig: Rig,
}

impl Pouring {
    /// Of a scene as [`super::scene`] makes it. Tangents are bound to the mesh where its normal map needs them.
    ///
    /// # Errors
    /// None but where the mesh cannot be given tangents.
    pub fn new(mut scene: Scene) -> Result<Self> {
        let rig = rig(&scene.meshes()[0]);
        let settings = SurfaceSettings::default();
        let (rig, _) = bind_tangents(&mut scene, rig, &settings, &mut Warnings::default())?;
        Ok(Self { scene, rig })
    }

    /// The vessel at a moment.
    ///
    /// # Errors
    /// None for a time that is a number.
    pub fn at(&mut self, seconds: f64) -> Result<&Scene> {
        self.rig.pose(&mut self.scene, 0, seconds)?;
        Ok(&self.scene)
    }

    /// What the cup has gone through since it stood upright.
    fn motion(&self, seconds: f64) -> Result<Mat4> {
        Ok(self.rig.world_matrices(0, seconds)?[CUP] * Mat4::translation(-PIVOT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jue::{low_mesh, scene};

    #[test]
    fn feet_stand_and_the_cup_turns_as_a_whole() {
        let mut vessel = Pouring::new(scene(16)).unwrap();
        let motion = vessel.motion(POURED).unwrap();
        let (rest, poured) = (low_mesh(), vessel.at(POURED).unwrap().meshes()[0].clone());
        assert_eq!(poured.triangles().len(), rest.triangles().len());
        let (mut feet, mut cup, mut between) = (0, 0, 0);
        for triangle in 0..rest.triangles().len() {
            for (p, q) in rest.corners(triangle).into_iter().zip(poured.corners(triangle)) {
                let turned = motion.transform_point(p.to_f64()).to_f32();
                match follows(p) {
                    0.0 => {
                        feet += 1;
                        assert_eq!(p, q);
                    }
                    1.0 => {
                        cup += 1;
                        assert!((q - turned).length() < 1e-7);
                    }
                    _ => {
                        between += 1;
                        assert!((q - p).length() < (turned - p).length() + 1e-7);
                    }
                }
            }
        }
        assert!(feet > 5 && cup > 500 && between > 100, "{feet} {cup} {between}");
    }

    #[test]
    fn it_tips_by_45_degrees_and_comes_back() {
        let vessel = Pouring::new(scene(16)).unwrap();
        let tipped = |seconds: f64| {
            let m = vessel.motion(seconds).unwrap();
            let cosine = (m.axis(0).x + m.axis(1).y + m.axis(2).z - 1.0) / 2.0;
            scalar::acos(cosine.clamp(-1.0, 1.0)).to_degrees()
        };
        assert!(tipped(0.0) < 1e-6 && tipped(2.0 * POURED) < 1e-6);
        assert!((tipped(POURED) - TIP_DEG).abs() < 1e-4, "{}", tipped(POURED));
        assert!((tipped(POURED / 2.0) - TIP_DEG / 2.0).abs() < 1e-4, "half way at half the time");
    }
}
