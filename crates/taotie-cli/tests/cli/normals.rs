//! The files and output of `taotie normals`.

use super::models::{Green, square_json, write_ball, write_relief};
use super::pictures::write_square;
use super::place::Place;
use serde_json::json;
use snapbox::str;
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_io::{PngSamples, read_bitmap};

/// A square with UVs at its corners, whose positions are (0, 0), (1, 0), (1, 1) and (0, 1).
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                      f 1/1/1 2/2/1 3/3/1 4/4/1\n";

/// Writes a ramp of 16-bit heights that rises by `step` a texel to the right.
fn write_ramp(place: &Place, name: &str, step: u16) {
    let samples: Vec<u16> = (0..32 * 32).map(|i| (i % 32) as u16 * step).collect();
    write_square(&place.path(name), PngSamples::U16(&samples), Encoding::Linear);
}

fn place_with_relief(green: Green) -> Place {
    let place = Place::with("square.obj", SQUARE);
    write_relief(&place.path("a.png"), green);
    place
}

fn picture(place: &Place, name: &str) -> Bitmap {
    read_bitmap(&place.path(name)).expect("it is a picture")
}

#[test]
fn heights_become_normals() {
    let place = Place::new();
    // 1/64 of white a texel, white is 64 texels high: 45 degrees.
    write_ramp(&place, "h.png", 1024);
    let line = "normals h.png -o n.png --height-scale 64 --border clamp";
    place
        .taotie(line)
        .assert()
        .success()
        .stderr_eq(str![[r#"
taotie: h.png: its pixels look like a height map

"#]])
        .stdout_eq(str![[r#"
wrote n.png: 32x32, 16 bits, tangent space, green up
storing    mean 0.0012°, median 0.0012°, quartiles 0.0012° and 0.0012°, p95 0.0012°, max 0.0012°

"#]]);
    let Texels::U16(texels) = picture(&place, "n.png").texels().clone() else {
        panic!("16 bits are the default")
    };
    let [r, g, b, _] = texels[16 * 32 + 16].map(|c| f64::from(c) / 65535.0 * 2.0 - 1.0);
    let half = 0.5f64.sqrt();
    assert!((r + half).abs() < 1e-3 && g.abs() < 1e-3 && (b - half).abs() < 1e-3, "{r} {g} {b}");
}

#[test]
fn heights_on_a_mesh_are_in_its_units() {
    let place = Place::with("square.obj", SQUARE);
    write_ramp(&place, "h.png", 1024);
    // The square is 1 wide and 32 texels: 64 texels are 2.
    place.json("normals h.png -o flat.png --from height --height-scale 64 --border clamp --json");
    place.json(
        "normals h.png -o mesh.png --from height --height-scale 2 --border clamp --mesh square.obj --json",
    );
    let report = place.json("diff flat.png mesh.png --json");
    assert!(report["metrics"]["angle"]["max"].as_f64().unwrap() < 0.01, "{report}");
}

#[test]
fn object_space_and_back() {
    let place = place_with_relief(Green::Up);
    let there = "normals a.png --to object --mesh square.obj -o object.png";
    place
        .taotie(there)
        .assert()
        .success()
        .stderr_eq(str![[r#"
taotie: a.png: its pixels look like a tangent-space normal map
taotie: a.png: green points up, guessed from its pixels (97 % sure)

"#]])
        .stdout_eq(str![[r#"
wrote object.png: 192x192, 16 bits, object space
storing    mean 0.0005°, median 0.0006°, quartiles 0.0004° and 0.0007°, p95 0.0008°, max 0.0008°
round trip mean 0.0005°, median 0.0006°, quartiles 0.0004° and 0.0007°, p95 0.0008°, max 0.0008°

"#]]);
    let back = "normals object.png --from object --to tangent --mesh square.obj -o back.png";
    place.taotie(back).assert().success().stderr_eq("").stdout_eq(str![[r#"
wrote back.png: 192x192, 16 bits, tangent space, green up
storing    mean 0.0001°, median 0.0000°, quartiles 0.0000° and 0.0000°, p95 0.0006°, max 0.0006°
round trip mean 0.0001°, median 0.0000°, quartiles 0.0000° and 0.0000°, p95 0.0006°, max 0.0006°

"#]]);
    let report = place.json("diff a.png back.png --json");
    assert!(report["metrics"]["angle"]["max"].as_f64().unwrap() < 0.01, "{report}");
    assert_eq!(place.files(), ["a.png", "back.png", "object.png", "square.obj"]);
}

#[test]
fn green_is_turned_to_the_bit() {
    let place = place_with_relief(Green::Down);
    place
        .taotie("normals a.png -o up.png")
        .assert()
        .success()
        .stderr_eq(str![[r#"
taotie: a.png: its pixels look like a tangent-space normal map
taotie: a.png: green points down, guessed from its pixels (97 % sure)

"#]])
        .stdout_eq(str![[r#"
wrote up.png: 192x192, 8 bits, tangent space, green up
conversion mean 0.0000°, median 0.0000°, quartiles 0.0000° and 0.0000°, p95 0.0000°, max 0.0000°

"#]]);
    place.taotie("normals up.png -o down.png --green down").assert().success();
    assert_eq!(picture(&place, "a.png"), picture(&place, "down.png"));
    assert_ne!(picture(&place, "a.png"), picture(&place, "up.png"));
}

#[test]
fn bits_and_dithering() {
    let place = place_with_relief(Green::Up);
    place.json("normals a.png -o wide.png --bits 16 --json");
    let report = place.json("normals wide.png -o narrow.png --bits 8 --dither --json");
    assert_eq!(
        (&report["bits"], &report["dither"], &report["round_trip"]),
        (&json!(8), &json!(true), &json!(null))
    );
    assert_eq!(report["stored"]["max"], json!(0.0), "codes do not change");
    assert_eq!(picture(&place, "a.png"), picture(&place, "narrow.png"));
}

#[test]
fn a_model_of_several_meshes_asks_for_a_part() {
    let place = place_with_relief(Green::Up);
    let mut model = square_json();
    let primitive = model["meshes"][0]["primitives"][0].clone();
    model["meshes"][0]["primitives"] = json!([primitive, primitive]);
    place.write("two.gltf", model.to_string());
    let refused = "normals a.png --from tangent --green-in up --to object --mesh two.gltf -o o.png";
    place.taotie(refused).assert().code(2).stdout_eq("").stderr_eq(str![[r#"
taotie: error: two.gltf: it has 2 meshes; choose one with --part: 0 square, 1 square

"#]]);
    place.taotie(&format!("{refused} --part 7")).assert().code(2).stdout_eq("").stderr_eq(str![[r#"
taotie: error: two.gltf: unknown mesh `7`; expected one of: 0 square, 1 square

"#]]);
    place.taotie(&format!("{refused} --part square")).assert().code(2).stdout_eq("").stderr_eq(str![[r#"
taotie: error: two.gltf: several meshes are named `square`; use the number: 0 square, 1 square

"#]]);
    place.taotie(&format!("{refused} --part 1")).assert().success();
}

#[test]
fn shared_texels_are_said() {
    let place = Place::with("twice.obj", format!("{SQUARE}v 0 0 1\nv 1 0 1\nv 1 1 1\nf 5/1/1 6/2/1 7/3/1\n"));
    write_relief(&place.path("a.png"), Green::Up);
    let line = "normals a.png --from tangent --green-in up --to object --mesh twice.obj -o o.png";
    place.taotie(line).assert().success().stderr_eq(str![[r#"
taotie: warning: texels covered by several triangles: the map holds only the normal of the first (18336 times)

"#]]);
}

#[test]
fn what_cannot_be_done_is_refused() {
    let place = place_with_relief(Green::Up);
    write_ball(&place.path("ball.png"));
    write_ramp(&place, "h.png", 100);
    place.write("plain.obj", super::models::TRIANGLE);
    place.write("color.tga", [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 32, 1, 2, 3]);
    let before = place.files();
    let refused = |line: &str, stderr: snapbox::data::Inline| {
        place.taotie(line).assert().code(2).stdout_eq("").stderr_eq(stderr);
        assert_eq!(place.files(), before, "{line}");
    };
    refused(
        "normals h.png -o n.png",
        str![[r#"
taotie: h.png: its pixels look like a height map
taotie: error: --height-scale is needed for heights: the height of white in texels, or in model units with --mesh

"#]],
    );
    refused(
        "normals color.tga -o n.png",
        str![[r#"
taotie: error: color.tga: it looks like neither a normal map nor heights; specify its content with --from

"#]],
    );
    refused(
        "normals ball.png --to tangent -o n.png",
        str![[r#"
taotie: ball.png: its pixels look like an object-space normal map
taotie: error: changing the space needs the mesh; name the model with --mesh

"#]],
    );
    refused(
        "normals ball.png --to tangent --mesh plain.obj -o n.png",
        str![[r#"
taotie: ball.png: its pixels look like an object-space normal map
taotie: error: plain.obj: uv set 0 for tangents: the mesh has 0

"#]],
    );
    refused(
        "normals h.png --height-scale 1 --to object -o n.png",
        str![[r#"
taotie: h.png: its pixels look like a height map
taotie: error: object space needs the mesh; name the model with --mesh

"#]],
    );
    refused(
        "normals a.png -o n.jpg",
        str![[r#"
taotie: error: n.jpg: normal maps are written as .png

"#]],
    );
    refused(
        "normals a.png -o n.png --bits 12",
        str![[r#"
error: invalid value '12' for '--bits <BITS>'
  [possible values: 8, 16]

For more information, try '--help'.

"#]],
    );
    refused(
        "normals a.png -o n.png --part 1",
        str![[r#"
error: the following required arguments were not provided:
  --mesh <MODEL>

Usage: taotie normals --output <OUT> --mesh <MODEL> --part <NAME|N> <INPUT>

For more information, try '--help'.

"#]],
    );
    refused(
        "normals none.png -o n.png",
        str![[r#"
taotie: error: none.png: No such file or directory (os error 2)

"#]],
    );
}
