//! A rig at several times against NumPy in double precision (`tests/oracle/animation_oracle.py`).

use serde_json::Value;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::deform::{Binding, Deformable, MorphTarget};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::animation::{
    Animation, Channel, Deformed, Interpolation, Node, Path, Rig, RigData, Sampler, Skin, Transform,
};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};

fn oracle() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/oracle/animation_oracle.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().unwrap().iter()
}

/// Returns all numbers in `value`, in order.
fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .map_or_else(|| vec![value.as_f64().unwrap()], |all| all.iter().flat_map(numbers).collect())
}

fn vectors(value: &Value) -> Vec<Vec3> {
    list(value).map(|v| Vec3::from_array(numbers(v).try_into().unwrap()).to_f32()).collect()
}

fn tangents(value: &Value) -> Vec<[f32; 4]> {
    list(value).map(|v| <[f64; 4]>::try_from(numbers(v)).unwrap().map(|c| c as f32)).collect()
}

/// Reads a matrix stored by rows.
fn matrix(value: &Value) -> Mat4 {
    let rows = numbers(value);
    Mat4 { columns: std::array::from_fn(|j| std::array::from_fn(|i| rows[4 * i + j])) }
}

fn node(value: &Value) -> Node {
    let vector = |key: &str| Vec3::from_array(numbers(&value[key]).try_into().unwrap());
    let rotation = numbers(&value["rotation"]).try_into().unwrap();
    Node {
        parent: value["parent"].as_u64().map(|p| p as usize),
        local: Transform::parts(vector("translation"), rotation, vector("scale")),
        weights: numbers(&value["weights"]).into_iter().map(|w| w as f32).collect(),
    }
}

fn shape(mesh: &Value) -> Deformable {
    let target = |value: &Value| MorphTarget {
        positions: vectors(&value["positions"]),
        normals: vectors(&value["normals"]),
        tangents: vectors(&value["tangents"]),
    };
    let positions = vectors(&mesh["positions"]);
    let triangles = (2..positions.len() as u32).map(|i| [0, i - 1, i]).collect();
    Deformable {
        base: MeshData {
            positions,
            normals: vectors(&mesh["normals"]),
            tangents: tangents(&mesh["tangents"]),
            triangles,
            ..MeshData::default()
        },
        targets: list(&mesh["targets"]).map(target).collect(),
        binding: Some(Binding {
            per_vertex: 2,
            joints: numbers(&mesh["joints"]).into_iter().map(|j| j as u32).collect(),
            weights: numbers(&mesh["joint_weights"]).into_iter().map(|w| w as f32).collect(),
        }),
    }
}

fn animation(channels: &Value) -> Animation {
    let mut animation = Animation::default();
    for (sampler, channel) in list(channels).enumerate() {
        let single = |key: &str| numbers(&channel[key]).into_iter().map(|v| v as f32).collect();
        let interpolation = match channel["interpolation"].as_str().unwrap() {
            "STEP" => Interpolation::Step,
            "LINEAR" => Interpolation::Linear,
            "CUBICSPLINE" => Interpolation::CubicSpline,
            other => panic!("{other}"),
        };
        let path = match channel["path"].as_str().unwrap() {
            "translation" => Path::Translation,
            "rotation" => Path::Rotation,
            "scale" => Path::Scale,
            "weights" => Path::Weights,
            other => panic!("{other}"),
        };
        animation.samplers.push(Sampler::new(interpolation, single("times"), single("values")).unwrap());
        let node = channel["node"].as_u64().unwrap() as usize;
        animation.channels.push(Channel { node, path, sampler });
    }
    animation
}

/// Returns one skinned and morphed mesh on node 3, and a rigid instance on every node to show its position.
fn scene_and_rig(oracle: &Value) -> (Scene, Rig) {
    let nodes: Vec<Node> = list(&oracle["nodes"]).map(node).collect();
    let skin = Skin {
        joints: numbers(&oracle["skin"]["joints"]).into_iter().map(|j| j as usize).collect(),
        inverse_bind_matrices: list(&oracle["skin"]["inverse_bind_matrices"]).map(matrix).collect(),
    };
    let shape = shape(&oracle["mesh"]);
    let instance = Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY };
    let scene = Scene::new(SceneData {
        meshes: vec![Mesh::new(shape.base.clone()).unwrap()],
        materials: vec![Material::default()],
        instances: vec![instance; nodes.len()],
        ..SceneData::default()
    });
    let rig = Rig::new(RigData {
        instances: (0..nodes.len()).map(Some).collect(),
        nodes,
        skins: vec![skin],
        deformed: vec![Deformed { mesh: 0, node: 3, skin: Some(0), shape }],
        animations: vec![animation(&oracle["animation"])],
        ..RigData::default()
    });
    (scene.unwrap(), rig.unwrap())
}

fn worst(ours: impl IntoIterator<Item = f64>, expected: &Value) -> f64 {
    let expected = numbers(expected);
    let ours: Vec<f64> = ours.into_iter().collect();
    assert_eq!(ours.len(), expected.len());
    ours.iter().zip(expected).fold(0.0, |worst, (a, b)| (a - b).abs().max(worst))
}

#[test]
fn poses_follow_the_specification() {
    let oracle = oracle();
    let (mut scene, rig) = scene_and_rig(&oracle);
    let mut greatest = [0.0f64; 4];
    for pose in list(&oracle["poses"]) {
        rig.pose(&mut scene, 0, pose["time"].as_f64().unwrap()).unwrap();
        let mesh = &scene.meshes()[0];
        let rows = |m: &Mat4| (0..16).map(|k| m.columns[k % 4][k / 4]).collect::<Vec<_>>();
        let vectors = |all: &[Vec3]| all.iter().flat_map(|v| v.to_f64().to_array()).collect::<Vec<_>>();
        let errors = [
            worst(scene.instances().iter().flat_map(|i| rows(&i.world_from_object)), &pose["world"]),
            worst(vectors(mesh.positions()), &pose["positions"]),
            worst(vectors(mesh.normals()), &pose["normals"]),
            worst(mesh.tangents().as_flattened().iter().map(|v| f64::from(*v)), &pose["tangents"]),
        ];
        greatest = std::array::from_fn(|i| greatest[i].max(errors[i]));
    }
    println!("greatest errors of matrices, positions, normals, tangents: {greatest:?}");
    assert!(greatest[0] < 1e-12, "matrices are double: {:e}", greatest[0]);
    assert!(greatest[1..].iter().all(|e| *e < 2e-6), "arrays are single: {greatest:?}");
}
