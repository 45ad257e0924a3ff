//! What is refused, in which words, and that nothing is written then.

use super::models::{TRIANGLE, gltf};
use super::place::Place;
use snapbox::data::Inline;
use snapbox::str;

/// Runs in `place` a line that has to be refused with `stderr`, and looks whether no file came or went.
fn refused(place: &Place, line: &str, stderr: Inline) {
    let before = place.files();
    place.taotie(line).assert().code(2).stdout_eq("").stderr_eq(stderr);
    assert_eq!(place.files(), before, "{line}");
}

/// As [`refused`], beside a sound model `a.obj`.
fn refused_beside_a_model(line: &str, stderr: Inline) {
    refused(&Place::with("a.obj", TRIANGLE), line, stderr);
}

#[test]
fn unknown_shading() {
    refused_beside_a_model("render a.obj -o a.png --shading gxx", str![]);
}

#[test]
fn unknown_surface() {
    refused_beside_a_model("render a.obj -o a.png --surface rough", str![]);
}

#[test]
fn unknown_preset() {
    refused_beside_a_model("render a.obj -o a.png --material unobtainium", str![]);
}

#[test]
fn unknown_key_of_a_material_file() {
    let place = Place::with("a.obj", TRIANGLE);
    place.write("m.toml", "roughness = 0.5\nshinyness = 3\n");
    refused(&place, "render a.obj -o a.png --material m.toml", str![]);
}

#[test]
fn unknown_camera() {
    refused_beside_a_model("render a.obj -o a.png --camera front", str![]);
}

#[test]
fn a_size_that_is_none() {
    refused_beside_a_model("render a.obj -o a.png --size huge", str![]);
}

#[test]
fn an_empty_size() {
    refused_beside_a_model("render a.obj -o a.png --size 0x10", str![]);
}

#[test]
fn an_absurd_size() {
    refused_beside_a_model("render a.obj -o a.png --size 100000x100000", str![]);
}

#[test]
fn unknown_samples() {
    refused_beside_a_model("render a.obj -o a.png --samples 5", str![]);
}

#[test]
fn unknown_light() {
    let place = Place::with("a.obj", TRIANGLE);
    let arguments = ["render", "a.obj", "-o", "a.png", "--light", "sun from=0,0"];
    place.taotie_with(&arguments).assert().code(2).stdout_eq("").stderr_eq(str![]);
    assert_eq!(place.files(), ["a.obj"]);
}

#[test]
fn unknown_background() {
    refused_beside_a_model("render a.obj -o a.png --background mauve-ish", str![]);
}

#[test]
fn unknown_picture_format() {
    refused_beside_a_model("render a.obj -o a.bmp", str![]);
}

#[test]
fn unknown_output_variable() {
    refused_beside_a_model("render a.obj -o a.png --aov normals,curvature", str![]);
}

#[test]
fn unknown_simd_level() {
    refused_beside_a_model("render a.obj -o a.png --simd mmx", str![]);
}

#[test]
fn no_threads() {
    refused_beside_a_model("render a.obj -o a.png --threads 0", str![]);
}

#[test]
fn no_angle_of_view() {
    refused_beside_a_model("render a.obj -o a.png --fov-deg 180", str![]);
}

#[test]
fn unknown_subcommand() {
    refused_beside_a_model("paint a.obj", str![]);
}

#[test]
fn a_model_that_is_not_there() {
    refused(&Place::new(), "render none.glb -o a.png", str![]);
    refused(&Place::new(), "inspect none.glb", str![]);
}

#[test]
fn a_model_of_an_unknown_format() {
    refused(&Place::with("a.fbx", "Kaydara"), "render a.fbx -o a.png", str![]);
}

#[test]
fn a_model_that_is_a_folder() {
    let place = Place::new();
    std::fs::create_dir(place.path("a.obj")).unwrap();
    refused(&place, "render a.obj -o a.png", str![]);
}

#[test]
fn a_normal_map_that_is_not_there() {
    refused_beside_a_model("render a.obj -o a.png --normal-map none.png", str![]);
}

#[test]
fn an_empty_mesh() {
    refused(&Place::with("a.obj", ""), "render a.obj -o a.png", str![]);
    refused(&Place::with("a.gltf", gltf(&[], &[])), "render a.gltf -o a.png", str![]);
}

const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn an_index_out_of_range() {
    refused(&Place::with("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"), "render a.obj -o a.png", str![]);
    refused(&Place::with("a.gltf", gltf(&CORNERS, &[0, 1, 9])), "render a.gltf -o a.png", str![]);
}

#[test]
fn a_position_that_is_nan() {
    refused(&Place::with("a.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"), "render a.obj -o a.png", str![]);
    let mut corners = CORNERS;
    corners[1][2] = f32::NAN;
    refused(&Place::with("a.gltf", gltf(&corners, &[0, 1, 2])), "render a.gltf -o a.png", str![]);
}

#[test]
fn an_output_folder_that_is_not_there() {
    refused_beside_a_model("render a.obj -o no/such/a.png", str![]);
}

#[test]
fn an_output_that_is_a_folder() {
    let place = Place::with("a.obj", TRIANGLE);
    std::fs::create_dir(place.path("a.png")).unwrap();
    refused(&place, "render a.obj -o a.png --size 8x8", str![]);
}
