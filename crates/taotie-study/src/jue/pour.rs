//! The pouring vessel: the feet stay on the ground, the cup tips over its spout and back, and the legs bend.
//!
//! A skin with two joints animates it. The joint of the feet is fixed; that of the cup turns about a point between
//! the roots of the legs. How far a point follows the cup is a smooth function of only its height, so that the low
//! mesh and the displaced one, whose vertices differ, move alike.
//!
//! [`Pouring`] poses a vessel at any moment, [`Truth`] the displaced mesh; [`angular_errors`] compares their normals.

use rayon::prelude::*;
use taotie_engine::bake::UvLookup;
use taotie_engine::compare::{Summary, angular_error};
use taotie_engine::image::Image;
use taotie_engine::math::{Mat4, Vec2, Vec3, scalar};
use taotie_engine::mesh::deform::{Binding, Deformable, skin};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{Aovs, Lighting, RenderSettings, Shot, SurfaceSettings, bind_tangents, render};
use taotie_engine::scene::animation::{
    Animation, Channel, Deformed, Interpolation, Node, Path, Rig, RigData, Sampler, Skin, Transform,
};
use taotie_engine::scene::{Camera, Instance, Material, Scene, SceneData};
use taotie_engine::{Error, Result, Warnings};

/// A vessel that can be posed at any moment of pouring.
pub struct Pouring {
    scene: Scene,
    rig: Rig,
}

impl Pouring {
    /// Creates a pouring vessel from a scene made by [`crate::jue::scene`]. Tangents are bound to the mesh if its
    /// normal map needs them.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has no mesh, or tangents cannot be computed for its mesh.
    pub fn new(mut scene: Scene) -> Result<Self> {
        let no_mesh = || Error::invalid("a pouring vessel", "the scene has no mesh");
        let rig = rig(scene.meshes().first().ok_or_else(no_mesh)?);
        let settings = SurfaceSettings::default();
        let (rig, _) = bind_tangents(&mut scene, rig, &settings, &mut Warnings::default())?;
        Ok(Self { scene, rig })
    }

    /// Poses the vessel at a moment.
    ///
    /// # Errors
    /// None unless the time is NaN.
    pub fn at(&mut self, seconds: f64) -> Result<&Scene> {
        self.rig.pose(&mut self.scene, 0, seconds)?;
        Ok(&self.scene)
    }

    /// Returns the transform of the cup relative to its upright position.
    fn motion(&self, seconds: f64) -> Result<Mat4> {
        Ok(self.rig.world_matrices(0, seconds)?[CUP] * Mat4::translation(-PIVOT))
    }
}

/// The time at which the cup is tipped farthest, seconds; at twice that time it is upright again.
pub const POURED: f64 = 1.0;

/// The angle by which it is tipped then, degrees.
pub const TIP_DEG: f64 = 45.0;

/// The node of the cup's joint.
const CUP: usize = 1;

/// The point about which it turns, metres.
const PIVOT: Vec3<f64> = Vec3::new(0.0, 0.085, 0.0);

/// The axis about which it turns, times √2: both towards the spout and away from the mask.
const AXIS: Vec3<f64> = Vec3::new(-1.0, 0.0, -1.0);

/// Points up to the first height stay with the feet, points above the second move with the cup; metres.
const BEND: [f64; 2] = [0.02, 0.09];

/// Returns how far a point follows the cup's motion, [0, 1].
fn follows(p: Vec3) -> f32 {
    let t = ((f64::from(p.y) - BEND[0]) / (BEND[1] - BEND[0])).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t)) as f32
}

/// Builds the rig for a scene with a single instance of `mesh`, a vessel at rest: the skin with two joints, and the
/// rotation of the cup's joint over time.
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
        samplers: vec![sampler.expect("times ascend and all numbers are finite")],
    }
}

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

/// The measurement rule in words.
pub const RULE: &str = "angle between the rendered normal and that of the displaced mesh under the same skin at the \
    same uv, with its normal taken from the moved surface; over the pixels of triangles whose corners all move by \
    at least a millimetre, seen by a camera that moves with the cup, so that the same surface is seen at rest and \
    poured";

/// Corners that move less count as stationary, metres.
const MOVED: f32 = 0.001;

/// The camera for looking at normals.
#[derive(Debug, Clone)]
pub struct Eye {
    /// The camera at rest; it moves with the cup.
    pub camera: Camera,
    /// The side of the picture, pixels.
    pub side: u32,
}

/// Returns the angular errors of a vessel with a normal map, at rest and poured, degrees; [`RULE`] states which
/// pixels count. `truths` are those of the two moments.
///
/// # Errors
/// [`Error::Invalid`] if the camera sees nothing that moves.
pub fn angular_errors(vessel: &mut Pouring, truths: &[Truth; 2], eye: &Eye) -> Result<[Summary; 2]> {
    let moved = moving_triangles(vessel)?;
    let mut error_at = |seconds: f64, truth: &Truth| {
        let seen = vessel.seen_from(eye, seconds)?;
        let of_interest = |pixel: &[f32; 4]| pixel[3] > 0.0 && moved[pixel[0] as usize];
        let keep: Vec<bool> = seen.triangle.pixels().iter().map(of_interest).collect();
        let error = angular_error(&seen.normals, &normals_of(truth, &seen))?.within(&keep)?.summary();
        error.ok_or_else(nothing_seen)
    };
    Ok([error_at(0.0, &truths[0])?, error_at(POURED, &truths[1])?])
}

fn nothing_seen() -> Error {
    Error::invalid("angular errors", "the camera sees nothing that moves")
}

/// Returns for each triangle of the low mesh whether it moves.
fn moving_triangles(vessel: &mut Pouring) -> Result<Vec<bool>> {
    let mesh = |scene: &Scene| scene.meshes()[0].clone();
    let (rest, poured) = (mesh(vessel.at(0.0)?), mesh(vessel.at(POURED)?));
    let moves = |t: usize| {
        let mut pairs = rest.corners(t).into_iter().zip(poured.corners(t));
        pairs.all(|(p, q)| (q - p).length() >= MOVED)
    };
    Ok((0..rest.triangles().len()).map(moves).collect())
}

impl Pouring {
    /// Renders the view of a camera that moves with the cup, at a moment.
    fn seen_from(&mut self, eye: &Eye, seconds: f64) -> Result<Aovs> {
        let mut camera = eye.camera.clone();
        camera.world_from_view = self.motion(seconds)? * camera.world_from_view;
        let (width, height) = (eye.side, eye.side);
        let settings = RenderSettings { width, height, samples: 1, aovs: true, ..RenderSettings::default() };
        let lighting = Lighting::default();
        let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
        let frame = render(self.at(seconds)?, &shot)?;
        frame.aovs.ok_or_else(nothing_seen)
    }
}

/// Returns the normals of the ground truth at the visible uvs.
fn normals_of(truth: &Truth, seen: &Aovs) -> Image {
    let mut normals = seen.uv.clone();
    normals.pixels_mut().par_iter_mut().for_each(|pixel| {
        let [u, v, _, covered] = *pixel;
        let found = (covered > 0.0).then(|| truth.normal(Vec2::new(u, v))).flatten();
        *pixel = found.map_or([0.0; 4], |n| [n.x, n.y, n.z, 1.0]);
    });
    normals
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jue::{displaced_mesh, low_mesh, scene};
    use taotie_engine::compare::angle_deg;

    #[test]
    fn feet_are_fixed_and_the_cup_turns_as_a_whole() {
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
