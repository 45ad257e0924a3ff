//! The skin with two joints, and the rotation of the cup's joint over time.

use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::mesh::deform::{Binding, Deformable};
use taotie_engine::scene::animation::{
    Animation, Channel, Deformed, Interpolation, Node, Path, Rig, RigData, Sampler, Skin, Transform,
};

/// The time at which the cup is tipped farthest, seconds; at twice that time it is upright again.
pub const POURED: f64 = 1.0;

/// The angle by which it is tipped then, degrees.
pub const TIP_DEG: f64 = 45.0;

/// The node of the cup's joint.
pub(super) const CUP: usize = 1;

/// The point about which it turns, metres.
pub(super) const PIVOT: Vec3<f64> = Vec3::new(0.0, 0.085, 0.0);

/// The axis about which it turns, times √2: both towards the spout and away from the mask.
const AXIS: Vec3<f64> = Vec3::new(-1.0, 0.0, -1.0);

/// Points up to the first height stay with the feet, points above the second move with the cup; metres.
const BEND: [f64; 2] = [0.02, 0.09];

/// Returns how far a point follows the cup's motion, [0, 1].
pub(super) fn follows(p: Vec3) -> f32 {
    let t = ((f64::from(p.y) - BEND[0]) / (BEND[1] - BEND[0])).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t)) as f32
}

/// Builds the rig for a scene with a single instance of `mesh`, a vessel at rest.
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
    Rig::new(data).expect("all numbers are in range")
}

/// Binds each point to two joints, with weights that sum to one.
pub(super) fn binding(points: &[Vec3]) -> Binding {
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
        samplers: vec![sampler.expect("times ascend and all numbers are finite")],
    }
}
