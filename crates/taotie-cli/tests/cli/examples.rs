//! The examples on the help pages run as written, but with small meshes and pictures.

use super::balls::{LOW, SCAN};
use super::models::{Green, moving_square, write_ball, write_relief};
use super::pictures::write_square;
use super::place::Place;
use serde_json::{Value, json};
use std::fmt::Write;
use taotie_engine::image::{Encoding, Texels};
use taotie_engine::mesh::Mesh;
use taotie_io::{
    ExrLayer, GltfAsset, GltfFormat, GltfMaterial, PngSamples, load_model, read_bitmap, write_exr, write_gltf,
};

/// A square with UVs.
const STATUE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                      f 1/1/1 2/2/1 3/3/1 4/4/1\n";

/// Returns a folder with the files that the examples use.
fn place() -> Place {
    let place = Place::with("statue.obj", STATUE);
    pictures(&place);
    models(&place);
    scan_and_low(&place);
    place.write("schema.json", r#"{ "version": "1.0.4", "model": { "triangles": { "maximum": 100000 } } }"#);
    place
}

fn pictures(place: &Place) {
    let same = ["normals", "statue_normals", "scan_normals", "baked_normals", "before", "after"];
    for name in same {
        write_relief(&place.path(&format!("{name}.png")), Green::Up);
    }
    write_relief(&place.path("directx.png"), Green::Down);
    write_ball(&place.path("object.png"));
    let ramp: Vec<u16> = (0..32 * 32).map(|i| i % 32 * 1024).collect();
    write_deep(place, "height.png", &ramp);
    let relief = read_bitmap(&place.path("normals.png")).expect("it is a picture");
    let Texels::U8(texels) = relief.texels() else { panic!("8 bits") };
    let deep: Vec<u16> =
        texels.iter().flat_map(|texel| [0, 1, 2].map(|i| u16::from(texel[i]) * 257)).collect();
    write_deep(place, "normals16.png", &deep);
    for name in ["high.normals.exr", "low.normals.exr"] {
        let samples = [0.0f32, 0.0, 1.0, 1.0].repeat(16);
        let layer = ExrLayer { name: "", channels: &["R", "G", "B", "A"], samples: &samples };
        write_exr(&place.path(name), (4, 4), &[layer]).expect("the folder can be written to");
    }
}

/// Writes a square picture in 16 bits: heights, or colours if there are three numbers a pixel.
fn write_deep(place: &Place, name: &str, samples: &[u16]) {
    write_square(&place.path(name), PngSamples::U16(samples), Encoding::Linear);
}

/// Writes a square with a normal map, a base colour, and an animation that walks.
fn models(place: &Place) {
    let mut model: Value = serde_json::from_str(&moving_square()).expect("it is JSON");
    model["animations"][0]["name"] = json!("Walk");
    model["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    for name in ["model.glb", "statue.glb", "vessel.glb"] {
        place.write(name, model.to_string());
    }
}

fn scan_and_low(place: &Place) {
    place.write("ball.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let mesh = |name: &str| load_model(place.path(name)).expect("it is sound").scene.meshes()[0].clone();
    place.write("scan.ply", ply(&mesh("ball.obj")));
    place.write("body_high.ply", ply(&mesh("ball.obj")));
    place.write("lid_high.ply", ply(&mesh("low.obj")));
    let normals = read_bitmap(&place.path("normals.png")).expect("it is a picture");
    let material = GltfMaterial { normal_map: Some((&normals).into()), ..GltfMaterial::default() };
    let levels = [&mesh("low.obj")];
    let low = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    write_gltf(&place.path("low.glb"), &low, &GltfFormat::default()).expect("it can be written");
}

fn ply(mesh: &Mesh) -> String {
    let (vertices, faces) = (mesh.positions().len(), mesh.triangles().len());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    for p in mesh.positions() {
        let _ = writeln!(text, "{} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in mesh.triangles() {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}

/// Returns the command lines under `Examples:` on a command's help page, which breaks long ones.
fn examples(place: &Place, command: &str) -> Vec<String> {
    let assert = place.taotie(&format!("{command} --help")).assert().success();
    let page = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    let lines = page.lines().skip_while(|line| *line != "Examples:").skip(1);
    let block: String = lines.take_while(|line| !line.is_empty()).map(|line| format!("\n{line}")).collect();
    block.split("\n  taotie ").skip(1).map(|example| example.replace('\n', " ")).collect()
}

/// Returns the words of a command line; quotes hold words together.
fn words(line: &str) -> Vec<String> {
    let part = |(i, part): (usize, &str)| match i % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
        _ => vec![part.to_owned()],
    };
    line.split('"').enumerate().flat_map(part).collect()
}

/// Returns an example with small pictures and maps, few rays, and a hundredth of the triangles.
fn small(line: &str) -> Vec<String> {
    let mut small = words(line);
    for i in 1..small.len() {
        let word = match small[i - 1].as_str() {
            "--size" if small[i].contains('x') => "64x64".to_owned(),
            "--size" => "64".to_owned(),
            "--spp" | "--turntable" => "3".to_owned(),
            "--triangles" | "--lods" => small[i].split(',').map(hundredth).collect::<Vec<_>>().join(","),
            _ => continue,
        };
        small[i] = word;
    }
    let lacks = |option: &str| !small.iter().any(|word| word == option);
    let more: &[&str] = match small[0].as_str() {
        // A search chooses its sizes itself.
        "bake"
            if ["--error", "--bytes", "--preset", "--size", "--triangles", "--low"]
                .into_iter()
                .all(lacks) =>
        {
            &["--size", "64", "--triangles", "1500"]
        }
        "bake" if ["--error", "--bytes", "--preset", "--size"].into_iter().all(lacks) => &["--size", "64"],
        "render" | "compare" if lacks("--size") && lacks("--paper") => &["--size", "64x64"],
        _ => &[],
    };
    small.extend(more.iter().map(|word| (*word).to_owned()));
    small
}

/// Returns a hundredth of a number of triangles; pixels stay.
fn hundredth(count: &str) -> String {
    count.parse::<u32>().map_or_else(|_| count.to_owned(), |count| (count / 100).to_string())
}

/// All except `demo`, which makes two million triangles; the tests of models run it.
const COMMANDS: [&str; 8] =
    ["bake", "render", "compare", "inspect", "normals", "diff", "shader", "materials"];

#[test]
fn the_examples_of_every_help_page_run() {
    let place = place();
    for command in COMMANDS {
        let examples = examples(&place, command);
        assert!(!examples.is_empty(), "{command}");
        for line in examples {
            let small = small(&line);
            let arguments: Vec<&str> = small.iter().map(String::as_str).collect();
            let run = place.taotie_with(&arguments).env("TAOTIE_CACHE_DIR", place.path("cache"));
            let output = run.output().expect("it starts");
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{line}, run as {small:?}: {said}");
        }
    }
}
