//! Sizes and lists in every form that people use.

use super::balls::{LOW, SCAN};
use super::models::TRIANGLE;
use super::place::Place;
use serde_json::{Value, json};
use taotie_io::read_bitmap;

/// Bakes with maps of this size; returns the report.
fn bake(place: &Place, size: &str) -> Value {
    let line =
        ["bake", "scan.obj", "--low", "low.obj", "-o", "out.gltf", "--maps", "normal, height", "--json"];
    let arguments: Vec<&str> = line.into_iter().chain(["--size", size]).collect();
    let assert = place.taotie_with(&arguments).assert().success();
    serde_json::from_slice(&assert.get_output().stdout).expect("stdout is one JSON document")
}

#[test]
fn maps_may_be_wider_than_high() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let mean = |report: &Value| {
        report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().expect("it is measured")
    };
    let square = bake(&place, "64");
    assert_eq!((&square["size"], &square["parameters"]["size"]), (&json!([64, 64]), &json!(64)));
    let wide = bake(&place, "128x64");
    assert_eq!((&wide["size"], &wide["parameters"]["size"]), (&json!([128, 64]), &json!([128, 64])));
    for name in ["out_normal.png", "out.height.png"] {
        let bitmap = read_bitmap(&place.path(name)).expect("it is a picture");
        assert_eq!((bitmap.width(), bitmap.height()), (128, 64), "{name}");
    }
    assert!(mean(&wide) < mean(&square), "more texels show more: {} {}", mean(&wide), mean(&square));
}

#[test]
fn the_size_of_maps_may_be_chosen() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let chosen = bake(&place, "auto");
    let side = chosen["size"][0].as_u64().expect("a number of texels");
    assert!(side >= 256 && side.is_power_of_two(), "{side}");
    assert_eq!(chosen["parameters"]["size"], side);
    let lost = chosen["warnings"].to_string();
    assert!(!lost.contains("coarser than the scan's detail"), "{lost}");
}

#[test]
fn one_number_is_both_sides() {
    let place = Place::with("a.obj", TRIANGLE);
    for size in ["16", "16x16", " 16 × 16"] {
        let render = ["render", "a.obj", "-o", "a.exr", "--size", size, "--aov", "depth, normals"];
        place.taotie_with(&render).assert().success();
        place.taotie_with(&["render", "a.obj", "-o", "a.png", "--size", size]).assert().success();
        let bitmap = read_bitmap(&place.path("a.png")).expect("it is a picture");
        assert_eq!((bitmap.width(), bitmap.height()), (16, 16), "{size}");
    }
}

#[test]
fn lists_take_spaces() {
    let place = Place::with("a.obj", TRIANGLE);
    let lists = ["--method", "facet, smooth", "--shading", "ggx, lambert"];
    let line: Vec<&str> =
        ["compare", "a.obj", "-o", "out", "--size", "16", "--json"].into_iter().chain(lists).collect();
    let assert = place.taotie_with(&line).assert().success();
    let report: Value = serde_json::from_slice(&assert.get_output().stdout).expect("it is JSON");
    assert_eq!(report["methods"].as_array().map(Vec::len), Some(2), "{report}");
    assert_eq!(report["methods"][0]["pictures"].as_array().map(Vec::len), Some(2), "{report}");
}
