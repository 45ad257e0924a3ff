//! Moving models: third-party files pose and move, and small files made here move as glTF 2.0 specifies.

use crate::common::data_folder;
use crate::files::data_files;
use crate::gltf::{Maker, TRIANGLE, load, triangle, v, warned};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::{LightKind, Scene};
use taotie_io::Loaded;

// ---------------------------------------------------------------------------------------------- third-party files

/// The largest displacement of any triangle corner, in model units.
fn greatest_way(a: &Scene, b: &Scene) -> f64 {
    a.corners().zip(b.corners()).map(|(p, q)| (p - q).length()).fold(0.0, f64::max)
}

/// Every animation of every model moves something visible, unless it has no channels; `load` checks that poses are
/// valid and that the rest pose equals the file's to the last bit.
#[test]
fn animated_models_by_others_move() {
    let mut moved = 0;
    for sub in ["khronos-gltf-sample-assets", "gltf-asset-generator", "polyhaven-models"] {
        for path in data_files(sub, &["gltf", "glb"]) {
            let Ok(Loaded { scene, rig: Some(rig), warnings, .. }) = load(&path) else { continue };
            assert!(
                warnings.iter().all(|(what, _)| !what.contains("skipped") && !what.contains("malformed")),
                "{}",
                path.display()
            );
            for (i, animation) in rig.animations().iter().enumerate() {
                let mut posed = scene.clone();
                let parts = [0.0, 0.25, 0.5, 0.75, 1.0];
                let ways = parts.map(|part| {
                    rig.pose(&mut posed, i, part * animation.seconds()).unwrap();
                    greatest_way(&scene, &posed)
                });
                let farthest = ways.into_iter().fold(0.0, f64::max);
                let size = scene.bounds().unwrap().diagonal();
                println!("{}: '{}' moves {farthest:.3} of {size:.3}", path.display(), animation.name);
                assert!(farthest > 1e-3 * size, "{}", path.display());
                moved += 1;
            }
        }
    }
    assert!(moved > 0 || data_folder("khronos-gltf-sample-assets").is_none(), "no model is animated");
}

// ------------------------------------------------------------------------------------------------ made here

/// A triangle on node 0 and the given animation.
fn animated(maker: &Maker, nodes: &str, animation: &str) -> Loaded {
    maker.load(&format!(
        r#""nodes":{nodes},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{"name":"move",{animation}}}]"#
    ))
}

/// The matrix of instance 0 at a time.
fn matrix_at(loaded: &Loaded, seconds: f64) -> Mat4 {
    let mut scene = loaded.scene.clone();
    loaded.rig.as_ref().unwrap().pose(&mut scene, 0, seconds).unwrap();
    scene.instances()[0].world_from_object
}

/// A triangle, times 1 and 3 (accessor 1), and a translation (2), rotation (3) and scale (4) for each.
fn keyframes() -> Maker {
    let mut maker = triangle();
    maker.floats(&[1.0, 3.0], "SCALAR");
    maker.floats(&[0.0, 0.0, 0.0, 4.0, 2.0, 0.0], "VEC3");
    let half = std::f32::consts::FRAC_1_SQRT_2;
    maker.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half], "VEC4");
    maker.floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0], "VEC3");
    maker
}

const ALL_PATHS: &str = r#""channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
    {"sampler":1,"target":{"node":0,"path":"rotation"}},{"sampler":2,"target":{"node":0,"path":"scale"}}],
    "samplers":[{"input":1,"output":2},{"input":1,"output":3},{"input":1,"output":4,"interpolation":"STEP"}]"#;

fn close(m: &Mat4, expected: &Mat4) {
    for (a, b) in m.columns.iter().flatten().zip(expected.columns.iter().flatten()) {
        assert!((a - b).abs() < 1e-7, "{m:?} instead of {expected:?}");
    }
}

#[test]
fn nodes_are_at_their_keyframes_and_between_them() {
    let loaded = animated(&keyframes(), r#"[{"mesh":0,"translation":[9,9,9],"scale":[3,3,3]}]"#, ALL_PATHS);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let animation = &loaded.rig.as_ref().unwrap().animations()[0];
    assert_eq!((animation.name.as_str(), animation.seconds()), ("move", 3.0));
    let parts = |x: f64, y: f64, degrees: f64, scale: f64| {
        Mat4::translation(Vec3::new(x, y, 0.0))
            * Mat4::rotation_about(Vec3::new(0.0, 0.0, 1.0), degrees.to_radians())
            * Mat4::scale(Vec3::splat(scale))
    };
    for early in [-1.0, 0.0, 1.0] {
        close(&matrix_at(&loaded, early), &parts(0.0, 0.0, 0.0, 1.0));
    }
    close(&matrix_at(&loaded, 1.5), &parts(1.0, 0.5, 22.5, 1.0));
    for late in [3.0, 4.0, 1e30] {
        close(&matrix_at(&loaded, late), &parts(4.0, 2.0, 90.0, 2.0));
    }
}

#[test]
fn what_hangs_on_a_moving_node_goes_with_it() {
    let mut maker = keyframes();
    maker.floats(&[0.0], "SCALAR");
    let nodes = r#"[{"children":[1,2]},{"mesh":0,"translation":[0,0,1]},
        {"camera":0,"translation":[0,0,5],"extensions":{"KHR_lights_punctual":{"light":0}}}]"#;
    let rest = format!(
        r#""cameras":[{{"type":"perspective","perspective":{{"yfov":1,"znear":0.1}}}}],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","spot":{{}}}}]}}}},
        "nodes":{nodes},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{{ALL_PATHS}}}]"#
    );
    let mut loaded = maker.load(&rest);
    loaded.rig.unwrap().pose(&mut loaded.scene, 0, 3.0).unwrap();
    let scene = loaded.scene;
    let at = |m: &Mat4| m.axis(3).to_f32();
    assert!((at(&scene.instances()[0].world_from_object) - v(4.0, 2.0, 2.0)).length() < 1e-6);
    let camera = &scene.cameras()[0].world_from_view;
    assert!((at(camera) - v(4.0, 2.0, 10.0)).length() < 1e-6);
    assert!((camera.axis(0).to_f32() - v(0.0, 1.0, 0.0)).length() < 1e-6, "turned, but not scaled");
    let LightKind::Spot { position, direction, .. } = scene.lights()[0].kind else { panic!("a spot") };
    assert!((position - v(4.0, 2.0, 10.0)).length() + (direction - v(0.0, 0.0, -1.0)).length() < 1e-6);
}

/// Two nodes show one mesh; only the weights of one are animated, and the other keeps its own.
#[test]
fn weights_move_the_node_s_mesh_and_no_other() {
    let mut maker = triangle();
    maker.floats(&[0.0, 0.0, 1.0].repeat(3), "VEC3");
    maker.floats(&[0.0, 2.0], "SCALAR");
    maker.floats(&[0.0, 0.0, 1.0, 0.5], "SCALAR");
    let mut loaded = maker.load(
        r#""meshes":[{"weights":[0.25,0],"primitives":[{"attributes":{"POSITION":0},
        "targets":[{"POSITION":1},{"POSITION":0}]}]}],"nodes":[{"mesh":0},{"mesh":0},{"mesh":0,"weights":[1,0]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"weights"}}],
        "samplers":[{"input":2,"output":3}]}]"#,
    );
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let corner = |scene: &Scene, i: usize| scene.meshes()[scene.instances()[i].mesh].positions()[1];
    assert_eq!([0, 1, 2].map(|i| corner(&loaded.scene, i).z), [0.25, 0.25, 1.0], "at rest");
    loaded.rig.unwrap().pose(&mut loaded.scene, 0, 1.0).unwrap();
    assert_eq!([0, 1, 2].map(|i| corner(&loaded.scene, i).z), [0.25, 0.5, 1.0]);
    assert_eq!(corner(&loaded.scene, 1).x, 1.25, "the second target has a weight of a quarter");
}

/// Without normals, shading is flat: normals are those of the triangle's current pose.
#[test]
fn flat_normals_are_those_of_the_deformed_faces() {
    let mut maker = triangle();
    maker.floats(&[0., 0., 0., 0., 0., 0., 0., -1., 1.], "VEC3");
    maker.floats(&[0.0, 1.0], "SCALAR");
    let mut loaded = maker.load(
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":1}]}]}],"nodes":[{"mesh":0}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],
        "samplers":[{"input":2,"output":2}]}]"#,
    );
    assert_eq!(loaded.scene.meshes()[0].normals(), [v(0.0, 0.0, 1.0); 3]);
    loaded.rig.unwrap().pose(&mut loaded.scene, 0, 1.0).unwrap();
    assert_eq!(loaded.scene.meshes()[0].normals(), [v(0.0, -1.0, 0.0); 3]);
}

/// Its joint turns the mesh; the mesh's own node, also animated, has no effect.
#[test]
fn a_skin_moves_by_its_joints_alone() {
    let mut maker = keyframes();
    maker.accessor(&[0; 12], (3, 5121, "VEC4"), "");
    maker.floats(&[1.0, 0.0, 0.0, 0.0].repeat(3), "VEC4");
    maker.floats(&[0.0, 0.0, 1.0].repeat(3), "VEC3");
    let mut loaded = maker.load(
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":7,"JOINTS_0":5,"WEIGHTS_0":6}}]}],
        "nodes":[{"mesh":0,"skin":0},{"children":[2]},{"rotation":[0,0.70710678,0,0.70710678]}],
        "skins":[{"joints":[2]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
          {"sampler":0,"target":{"node":1,"path":"translation"}},{"sampler":1,"target":{"node":1,"path":"rotation"}}],
          "samplers":[{"input":1,"output":2},{"input":1,"output":3}]}]"#,
    );
    loaded.rig.unwrap().pose(&mut loaded.scene, 0, 3.0).unwrap();
    assert_eq!(loaded.scene.instances()[0].world_from_object, Mat4::IDENTITY);
    let mesh = &loaded.scene.meshes()[0];
    // First 90° about y: x to −z, z to x; then 90° about z: x to y, y to −x; then moved by (4, 2, 0).
    let expected = [v(4.0, 2.0, 0.0), v(4.0, 2.0, -1.0), v(3.0, 2.0, 0.0)];
    for (p, q) in mesh.positions().iter().zip(expected) {
        assert!((*p - q).length() < 1e-6, "{p:?} instead of {q:?}");
    }
    assert!((mesh.normals()[0] - v(0.0, 1.0, 0.0)).length() < 1e-6);
}

#[test]
fn models_without_animations_have_no_rig() {
    let rest = r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},
        "targets":[{"POSITION":0}]}],"weights":[1]}]"#;
    assert!(triangle().load(rest).rig.is_none());
    assert!(triangle().load(&format!(r#"{rest},"animations":[]"#)).rig.is_none());
}

/// Every invalid channel is skipped with a counted reason; the valid one next to it stays.
#[test]
fn wrong_channels_are_left_out_one_by_one() {
    let mut maker = keyframes();
    maker.floats(&[3.0, 1.0], "SCALAR"); // 5: falling times
    maker.floats(&[f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0], "VEC3"); // 6
    maker.floats(&[0.0; 15], "VEC3"); // 7: five values
    let cases = [
        (r#"{"sampler":1,"target":{"node":7,"path":"scale"}}"#, "node does not exist"),
        (r#"{"sampler":9,"target":{"node":0,"path":"scale"}}"#, "sampler 9"),
        (r#"{"sampler":1,"target":{"path":"scale"}}"#, "malformed"),
        (r#"{"sampler":1,"target":{"node":0,"path":"color"}}"#, "path 'color'"),
        (r#"{"sampler":1,"target":{"path":"pointer"}}"#, "KHR_animation_pointer"),
        (r#"{"sampler":1,"target":{"node":0,"path":"rotation"}}"#, "3 components, expected 4"),
        (r#"{"sampler":1,"target":{"node":0,"path":"weights"}}"#, "no morph targets"),
        (r#"{"sampler":1,"target":{"node":1,"path":"scale"}}"#, "matrix"),
        (r#"{"sampler":2,"target":{"node":0,"path":"scale"}}"#, "times must not decrease"),
        (r#"{"sampler":3,"target":{"node":0,"path":"scale"}}"#, "infinite or NaN"),
        (r#"{"sampler":4,"target":{"node":0,"path":"scale"}}"#, "15 numbers for 2"),
        (r#"{"sampler":5,"target":{"node":0,"path":"scale"}}"#, "interpolation"),
        (r#"{"sampler":6,"target":{"node":0,"path":"scale"}}"#, "accessor 99"),
        (r#"{"sampler":7,"target":{"node":0,"path":"scale"}}"#, "must be scalars"),
        (r#"{"sampler":0,"target":{"node":0,"path":"translation"}}"#, "an earlier channel"),
        (r#"{"sampler":"x"}"#, "malformed"),
    ];
    let samplers = r#""samplers":[{"input":1,"output":2},{"input":1,"output":4},{"input":5,"output":4},
        {"input":1,"output":6},{"input":1,"output":7},{"input":1,"output":4,"interpolation":"ODD"},
        {"input":1,"output":99},{"input":4,"output":4}]"#;
    let nodes = r#"[{"mesh":0},{"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}]"#;
    for (channel, why) in cases {
        let channels = format!(
            r#""channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}},{channel},{channel}]"#
        );
        let loaded = animated(&maker, nodes, &format!("{channels},{samplers}"));
        assert_eq!(warned(&loaded, why), 2, "{channel}: {:?}", loaded.warnings);
        assert_eq!(loaded.rig.as_ref().unwrap().animations()[0].channels.len(), 1);
        assert!((matrix_at(&loaded, 3.0).axis(3) - Vec3::new(4.0, 2.0, 0.0)).length() < 1e-6);
    }
}

#[test]
fn odd_animations_are_kept_without_channels() {
    for json in
        [r#"[{}]"#, r#"[3]"#, r#"[{"channels":[{}],"samplers":[{}]}]"#, r#"[{"channels":7,"name":8}]"#]
    {
        let loaded = triangle().load(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"animations":{json}"#
        ));
        let rig = loaded.rig.unwrap();
        assert_eq!((rig.animations()[0].channels.len(), rig.animations()[0].seconds()), (0, 0.0), "{json}");
    }
}

/// An unreadable morph target without weight at rest is skipped; one with a weight makes its primitive fail, as
/// usual.
#[test]
fn a_bad_morph_target_is_left_out_unless_it_weighs_something() {
    let mut maker = triangle();
    maker.floats(&TRIANGLE[..6], "VEC3");
    maker.floats(&[0.0, 1.0], "SCALAR");
    let rest = |weight: f32| {
        format!(
            r#""meshes":[{{"weights":[{weight}],"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{{"POSITION":1}}]}}]}}],
            "nodes":[{{"mesh":0}}],"animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}],
            "samplers":[{{"input":2,"output":2}}]}}]"#
        )
    };
    let loaded = maker.load(&rest(0.0));
    assert_eq!(warned(&loaded, "morph target 0: 2 elements for 3 positions"), 1);
    assert!(maker.try_load(&rest(0.5)).unwrap_err().contains("morph target 0"));
}

#[test]
fn unknown_animations_and_other_scenes_are_refused() {
    let loaded = animated(&keyframes(), r#"[{"mesh":0}]"#, ALL_PATHS);
    let rig = loaded.rig.unwrap();
    let why = rig.pose(&mut loaded.scene.clone(), 1, 0.0).unwrap_err().to_string();
    assert!(why.contains("animation 1") && why.contains("there are 1"), "{why}");
    assert!(rig.pose(&mut Scene::default(), 0, 0.0).unwrap_err().to_string().contains("another scene"));
}
