//! The examples on the help page of `taotie bake` run as they stand there, but on small meshes and maps.

use super::balls::{LOW, SCAN};
use super::place::Place;
use std::fmt::Write;
use taotie::io::{GltfAsset, GltfFormat, GltfLevel, load_model, write_gltf};
use taotie::mesh::Mesh;

/// A folder with the files that the examples name.
fn place() -> Place {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let mesh = |name: &str| load_model(&place.path(name)).expect("it is sound").scene.meshes()[0].clone();
    place.write("scan.ply", ply(&mesh("scan.obj")));
    let levels = [GltfLevel { mesh: &mesh("low.obj"), coverage: None }];
    let low = GltfAsset { levels: &levels, ..GltfAsset::default() };
    write_gltf(&place.path("low.glb"), &low, &GltfFormat::default()).expect("it can be written");
    place
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

/// The lines under `Examples:`.
fn examples(place: &Place) -> Vec<String> {
    let assert = place.taotie("bake --help").assert().success();
    let page = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    let lines = page.lines().skip_while(|line| *line != "Examples:").skip(1);
    let lines = lines.map_while(|line| line.strip_prefix("  taotie "));
    lines.map(str::to_owned).collect()
}

/// Returns an example with maps of 64 texels and a hundredth of the triangles.
fn small(line: &str) -> String {
    let mut before = "";
    let mut words = Vec::new();
    for word in line.split_whitespace() {
        words.push(match before {
            "--size" => "64".to_owned(),
            "--triangles" | "--lods" => word.split(',').map(hundredth).collect::<Vec<_>>().join(","),
            _ => word.to_owned(),
        });
        before = word;
    }
    // A search chooses both.
    let lacks = |option: &str| !line.contains("--error") && !line.contains(option);
    words.extend(lacks("--size").then(|| "--size 64".to_owned()));
    words.extend((lacks("--triangles") && lacks("--low")).then(|| "--triangles 1500".to_owned()));
    words.join(" ")
}

fn hundredth(count: &str) -> String {
    let count: u32 = count.parse().expect("a number of triangles");
    (count / 100).to_string()
}

#[test]
fn the_examples_of_the_help_page_run() {
    let place = place();
    let examples = examples(&place);
    assert!(examples.len() >= 4, "{examples:?}");
    for line in &examples {
        let small = small(line);
        let output =
            line.split_whitespace().skip_while(|word| *word != "-o").nth(1).expect("it writes a file");
        place.taotie(&small).assert().success();
        std::fs::remove_file(place.path(output)).unwrap_or_else(|error| panic!("{small}: {error}"));
    }
}
