//! The files of `taotie render`.

use super::models::{Green, TRIANGLE, square, write_relief};
use super::place::Place;
use snapbox::str;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::SimdLevel;
use taotie_engine::names::Named;
use taotie_io::read_bitmap;

fn picture(place: &Place, name: &str) -> Bitmap {
    read_bitmap(&place.path(name)).expect("it is a picture")
}

#[test]
fn writes_the_named_file_and_no_other() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("render a.obj -o b.png --size 40x30").assert().success().stderr_eq("").stdout_eq(str![[
        r#"
b.png

"#
    ]]);
    assert_eq!(place.files(), ["a.obj", "b.png"]);
    let png = picture(&place, "b.png");
    assert_eq!((png.width(), png.height(), png.bits(), png.channels()), (40, 30, 8, 3));
}

#[test]
fn a_transparent_background_has_alpha() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("render a.obj -o b.png --size 40x30 --background transparent --bits 16").assert().success();
    let png = picture(&place, "b.png");
    let Texels::U16(texels) = png.texels() else { panic!("16 bits were asked for") };
    assert_eq!(texels[0][3], 0);
    // Left of and below the middle, through which the longest edge runs.
    assert_eq!(texels[20 * 40 + 15][3], u16::MAX);
}

#[test]
fn exr_is_linear_float() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("render a.obj -o b.exr --size 16x16").assert().success().stderr_eq("").stdout_eq(str![[
        r#"
b.exr

"#
    ]]);
    assert_eq!(place.read("b.exr")[..4], [0x76, 0x2f, 0x31, 0x01]);
    assert_eq!(picture(&place, "b.exr").bits(), 32);
}

#[test]
fn output_variables_are_named_after_the_picture() {
    let place = Place::with("a.obj", TRIANGLE);
    let line = "render a.obj -o b.png --size 16x16 --aov normals,depth";
    place.taotie(line).assert().success().stderr_eq("").stdout_eq(str![[r#"
b.png
b.normals.exr
b.normals.png
b.depth.exr
b.depth.png

"#]]);
    let files = ["a.obj", "b.depth.exr", "b.depth.png", "b.normals.exr", "b.normals.png", "b.png"];
    assert_eq!(place.files(), files);
}

#[test]
fn triangles_without_area_are_counted() {
    let place = Place::with("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 2 4 2\n");
    let line = "render a.obj -o b.png --size 16x16";
    place.taotie(line).assert().success().stdout_eq("b.png\n").stderr_eq(str![[r#"
taotie: warning: triangles without area (2 times)

"#]]);
}

#[test]
fn a_missing_texture_of_the_model_is_said_and_drawn_without() {
    let place = Place::with("a.obj", format!("mtllib a.mtl\nusemtl m\n{TRIANGLE}"));
    place.write("a.mtl", "newmtl m\nKd 1 1 1\nnorm none.png\n");
    let line = "render a.obj -o b.png --size 16x16";
    place.taotie(line).assert().success().stdout_eq("b.png\n").stderr_eq(str![[r#"
taotie: warning: skipped texture 'none.png': file not found

"#]]);
}

#[test]
fn cameras_of_the_file_go_by_name_or_number() {
    let place = Place::with("a.gltf", square());
    write_relief(&place.path("normals.png"), Green::Up);
    for camera in ["front", "1"] {
        let line = format!("render a.gltf -o {camera}.png --size 16x16 --camera {camera}");
        place.taotie(&line).assert().success();
    }
    assert_eq!(place.files(), ["1.png", "a.gltf", "front.png", "normals.png"]);
    let unknown = place.taotie("render a.gltf -o b.png --camera back").assert();
    unknown.code(2).stderr_eq(str![[r#"
taotie: error: --camera back: the file has no such camera; it has: front, 1

"#]]);
}

#[test]
fn threads_and_simd_levels_change_no_byte() {
    let place = Place::with("a.gltf", square());
    write_relief(&place.path("normals.png"), Green::Up);
    let bytes = |option: &str| {
        let line = format!("render a.gltf -o b.png --size 97x83 --shadows --orbit 30,20 {option}");
        place.taotie(&line).assert().success();
        place.read("b.png")
    };
    let first = bytes("--threads 1");
    assert!(first == bytes("--threads 4"), "the number of threads changes the picture");
    for level in SimdLevel::available() {
        assert!(first == bytes(&format!("--simd {}", level.name())), "{} changes the picture", level.name());
    }
}

#[test]
fn the_reference_depends_on_its_seed_and_not_on_threads() {
    let place = Place::with("a.obj", TRIANGLE);
    let bytes = |name: &str, more: &str| {
        let line = format!("render a.obj -o {name} --size 40x30 --integrator reference --spp 3 {more}");
        place.taotie(&line).assert().success().stderr_eq("");
        place.read(name)
    };
    let first = bytes("a.png", "--threads 1");
    assert!(first == bytes("b.png", "--threads 3 --simd scalar"));
    assert!(first == bytes("c.png", "--seed 0 --bounces 4 --shadows"), "these are the defaults");
    assert!(first != bytes("d.png", "--seed 1"));
}
