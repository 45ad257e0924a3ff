//! Triangles with different alpha modes are written as primitives that share their vertices.

use crate::{bumpy, validator};
use serde_json::{Value, json};
use std::path::Path;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{AlphaMode, Scene};
use taotie_io::{GltfAsset, GltfFormat, GltfMaterial, encode_glb, load_levels, write_gltf};

const MODES: [AlphaMode; 3] = [AlphaMode::Opaque, AlphaMode::Mask(0.25), AlphaMode::Blend];

fn modes(mesh: &Mesh) -> Vec<AlphaMode> {
    (0..mesh.triangles().len()).map(|t| MODES[t / 5 % 3]).collect()
}

/// The centres of triangles in the world, sorted.
fn centers(triangles: impl Iterator<Item = [Vec3<f64>; 3]>) -> Vec<[f64; 3]> {
    let center = |[a, b, c]: [Vec3<f64>; 3]| ((a + b + c) * (1.0 / 3.0)).to_array();
    let mut centers: Vec<[f64; 3]> = triangles.map(center).collect();
    centers.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    centers
}

/// The centres of the triangles of a scene in a mode.
fn shown(scene: &Scene, mode: AlphaMode) -> Vec<[f64; 3]> {
    let own = scene.instances().iter().filter(|i| scene.materials()[i.material].alpha == mode);
    centers(own.flat_map(|instance| {
        let (mesh, world) = (&scene.meshes()[instance.mesh], instance.world_from_object);
        let corners = move |t| mesh.corners(t).map(|p| world.transform_point(p.to_f64()));
        (0..mesh.triangles().len()).map(corners)
    }))
}

fn assert_level(path: &Path, level: usize, mesh: &Mesh) {
    let scene = load_levels(path).unwrap().swap_remove(level).scene;
    assert_eq!((scene.instances().len(), scene.triangle_count()), (3, mesh.triangles().len()));
    for mode in MODES {
        let each = modes(mesh);
        let own = (0..each.len()).filter(|t| each[*t] == mode);
        let ours = centers(own.map(|t| mesh.corners(t).map(Vec3::to_f64)));
        let read = shown(&scene, mode);
        assert_eq!(read.len(), ours.len(), "{mode:?}");
        // The quantisation of a packed mesh may change the order of centres that are nearly equal along x.
        let mean = |centers: &[[f64; 3]]| {
            [0, 1, 2].map(|k| centers.iter().map(|c| c[k]).sum::<f64>() / centers.len() as f64)
        };
        let pairs = mean(&read).into_iter().zip(mean(&ours));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-3), "{mode:?}, level {level}");
    }
}

#[test]
fn each_mode_is_a_primitive_and_all_share_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let meshes = [bumpy::sphere(40, 20), bumpy::sphere(20, 10)];
    let alpha_modes: Vec<Vec<AlphaMode>> = meshes.iter().map(modes).collect();
    let levels = meshes.each_ref();
    let color = bumpy::colors(8);
    let material = GltfMaterial {
        name: "leaf",
        alpha: AlphaMode::Blend,
        base_color_map: Some((&color).into()),
        ..GltfMaterial::default()
    };
    let asset = GltfAsset {
        levels: &levels,
        coverages: &[0.5, 0.1],
        material,
        alpha_modes: &alpha_modes,
        ..GltfAsset::default()
    };
    for meshopt in [false, true] {
        let path = folder.path().join("m.gltf");
        write_gltf(&path, &asset, &GltfFormat { meshopt, ..GltfFormat::default() }).unwrap();
        let text = std::fs::read(&path).unwrap();
        let document: Value = serde_json::from_slice(&text).unwrap();
        let materials = document["materials"].as_array().unwrap();
        let said: Vec<&Value> = materials.iter().map(|material| &material["alphaMode"]).collect();
        assert_eq!(said, [&Value::Null, &json!("MASK"), &json!("BLEND")]);
        assert_eq!(materials[1]["alphaCutoff"], json!(0.25));
        for material in materials {
            assert_eq!(material["pbrMetallicRoughness"], materials[0]["pbrMetallicRoughness"]);
        }
        for mesh in document["meshes"].as_array().unwrap() {
            let primitives = mesh["primitives"].as_array().unwrap();
            assert_eq!(primitives.len(), 3);
            for (i, primitive) in primitives.iter().enumerate() {
                assert_eq!(primitive["attributes"], primitives[0]["attributes"]);
                assert_eq!(primitive["material"], json!(i));
                assert!(i == 0 || primitive["indices"] != primitives[0]["indices"]);
            }
        }
        meshes.iter().enumerate().for_each(|(level, mesh)| assert_level(&path, level, mesh));
        validator::assert_valid(&path);
    }
}

#[test]
fn one_mode_for_all_changes_no_byte() {
    let mesh = bumpy::sphere(24, 12);
    let levels = [&mesh];
    for mode in MODES {
        let material = GltfMaterial { alpha: mode, ..GltfMaterial::default() };
        let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
        let same = [vec![mode; mesh.triangles().len()]];
        for meshopt in [false, true] {
            let format = GltfFormat { meshopt, ..GltfFormat::default() };
            let with = encode_glb(&GltfAsset { alpha_modes: &same, ..asset }, &format).unwrap();
            assert!(encode_glb(&asset, &format).unwrap() == with, "{mode:?}, packed: {meshopt}");
        }
    }
}

#[test]
fn modes_that_do_not_fit_the_triangles_are_refused() {
    let mesh = bumpy::sphere(8, 4);
    let levels = [&mesh];
    let count = mesh.triangles().len();
    let cases = [
        (vec![vec![AlphaMode::Blend; count - 1]], "one per triangle"),
        (vec![vec![AlphaMode::Blend; count]; 2], "one per triangle"),
        (vec![vec![AlphaMode::Mask(f32::NAN); count]], "alpha cutoff"),
    ];
    for (alpha_modes, why) in cases {
        let asset = GltfAsset { levels: &levels, alpha_modes: &alpha_modes, ..GltfAsset::default() };
        let error = encode_glb(&asset, &GltfFormat::default()).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}
