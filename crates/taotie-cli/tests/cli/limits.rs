//! Hostile files and absurd numbers: each is refused with a message, or works, in bounded time and memory. None
//! panics, and none controls the terminal.

use super::models::TRIANGLE;
use super::pictures::write_square;
use super::place::Place;
use std::fmt::Write;
use std::time::Duration;
use taotie_engine::image::Encoding;
use taotie_io::PngSamples;

/// Returns the stderr of a run that must be refused.
#[track_caller]
fn refused(place: &Place, line: &str) -> String {
    let before = place.files();
    let assert = place.taotie(line).timeout(Duration::from_secs(60)).assert().code(2).stdout_eq("");
    assert_eq!(place.files(), before, "{line}");
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(!said.contains("panicked"), "{said}");
    said
}

#[test]
fn numbers_out_of_range_are_refused() {
    let place = Place::with("a.obj", TRIANGLE);
    let cases = [
        ("render a.obj -o a.png --ambient=-1", "between 0 and 1e12"),
        ("render a.obj -o a.png --ambient=1e39", "at most 1e18"),
        ("render a.obj -o a.png --ambient=1e13", "between 0 and 1e12"),
        ("render a.obj -o a.png --base-color=-0.5", "between 0 and 1e12"),
        ("render a.obj -o a.png --env studio --env-intensity 1e15", "between 0 and 1e12"),
        ("render a.obj -o a.png --target 0,0,1e39", "at most 1e18"),
        ("render a.obj -o a.png --orbit 0,0,1e39", "at most 1e18"),
        ("render a.obj -o a.png --shading phong --shininess 1e12", "between 0 and 1e9"),
        ("render a.obj -o a.png --threads 20000", "at most 1024"),
        ("compare a.obj -o out --threads 20000", "at most 1024"),
        ("bake a.obj -o a.glb --threads 20000", "at most 1024"),
        ("bake a.obj -o a.glb --dilation 2147483648", "0 to 16384 texels"),
        ("demo --threads 20000", "at most 1024"),
    ];
    for (line, why) in cases {
        let said = refused(&place, line);
        assert!(said.contains(why), "{line}: {said}");
    }
    for light in
        ["point at=0,0,1 strength=1e39", "directional from=0,0 strength=1e15", "point at=0,0,1 color=-1"]
    {
        let arguments = ["render", "a.obj", "-o", "a.png", "--light", light];
        place.taotie_with(&arguments).assert().code(2).stdout_eq("");
    }
    assert_eq!(place.files(), ["a.obj"]);
}

#[test]
fn pictures_larger_than_the_memory_are_refused_before_they_are_begun() {
    let place = Place::with("a.obj", TRIANGLE);
    for line in [
        "render a.obj -o a.png --size 16384x16384 --aov depth --memory-limit 8G",
        "compare a.obj -o out --size 16384x16384 --memory-limit 8G",
        "render a.obj -o a.png --memory-limit 10M",
    ] {
        let said = refused(&place, line);
        assert!(
            said.contains("of memory, but the limit is") && said.contains("--memory-limit"),
            "{line}: {said}"
        );
    }
    place.taotie("render a.obj -o a.png --size 16 --memory-limit 1G").assert().success();
}

/// `ulimit -v` lets allocations fail, which ends a process, unless the work is refused before.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_on_the_address_space_limits_the_memory() {
    /// 7,938 triangles, 60 million in 7,500 nodes.
    const SIDE: u16 = 64;
    let points = (0..SIDE * SIDE).map(|i| [f32::from(i % SIDE), f32::from(i / SIDE), 0.0].map(|x| x / 63.0));
    let corners = (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE + 1 < SIDE);
    let squares = corners.flat_map(|i| [i, i + 1, i + SIDE, i + 1, i + SIDE + 1, i + SIDE]);
    let mesh = super::models::gltf(&points.collect::<Vec<_>>(), &squares.collect::<Vec<_>>());
    let mut model: serde_json::Value = serde_json::from_str(&mesh).unwrap();
    model["nodes"] =
        (0..7500).map(|i| serde_json::json!({ "mesh": 0, "translation": [i % 100, i / 100, 0] })).collect();
    model["scenes"][0]["nodes"] = (0..7500).collect();
    let place = Place::with("a.gltf", model.to_string());
    place.write("b.obj", TRIANGLE);
    let run = |limit: u32, line: &str| {
        let limited = format!("ulimit -v {limit} && exec '{}' {line}", env!("CARGO_BIN_EXE_taotie"));
        let mut process = std::process::Command::new("sh");
        let ended = process.args(["-c", &limited]).current_dir(place.path("")).output().unwrap();
        (ended.status.code(), String::from_utf8_lossy(&ended.stderr).into_owned())
    };
    let before = place.files();
    for line in ["render a.gltf -o a.png --size 16", "view a.gltf -o a.html", "bake a.gltf -o a.glb"] {
        let (code, said) = run(2_000_000, line);
        assert!(code == Some(2) && said.contains("of memory, but the limit is"), "{line}: {code:?}, {said}");
        assert!(said.contains("`ulimit -v` limits the process to 1.9 GiB"), "{line}: {said}");
    }
    assert_eq!(place.files(), before);
    for line in ["render b.obj -o b.png --size 16", "inspect b.obj", "shader b.obj --target wgsl -o shaders"]
    {
        let (code, said) = run(1_000_000, line);
        assert_eq!(code, Some(0), "{line}: {said}");
    }
}

#[test]
fn files_larger_than_the_memory_are_refused_from_their_headers() {
    let place = Place::with("a.obj", TRIANGLE);
    let samples = vec![0; 2048 * 2048];
    write_square(&place.path("black.png"), PngSamples::U8(&samples), Encoding::Linear);
    for line in [
        "diff black.png black.png --memory-limit 20M",
        "diff black.png black.png --memory-limit 200M",
        "normals black.png -o n.png --from height --height-scale 1 --memory-limit 20M",
    ] {
        let said = refused(&place, line);
        assert!(said.contains("black.png") && said.contains("of memory, but the limit is"), "{line}: {said}");
    }
}

#[test]
fn coordinates_that_overflow_are_drawn_or_refused() {
    for size in ["1e10", "1e15", "1e19", "1e20", "1e30", "1e37", "3e38", "1e-30", "1e-38"] {
        let mut obj = String::new();
        for [x, y, z] in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] {
            let at = |v: i32| if v == 0 { "0" } else { size };
            let _ = writeln!(obj, "v {} {} {}", at(x), at(y), at(z));
        }
        obj.push_str("f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
        let place = Place::with("a.obj", obj);
        for line in [
            "render a.obj -o a.png --size 16",
            "render a.obj -o a.png --size 16 --shadows --ground",
            "inspect a.obj",
        ] {
            let assert = place.taotie(line).timeout(Duration::from_secs(60)).assert();
            let output = assert.get_output();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(
                matches!(output.status.code(), Some(0 | 2)) && !said.contains("panicked"),
                "{size} {line}: {said}"
            );
        }
        let said = refused_bake(&place);
        assert!(said.contains("scale it to between 1e-6 and 1e9"), "{size}: {said}");
    }
}

/// Returns the stderr of a bake that must be refused, regardless of its requirements.
fn refused_bake(place: &Place) -> String {
    let line = "bake a.obj -o b.glb --triangles 4 --size 16 --require hausdorff=1";
    let assert = place.taotie(line).timeout(Duration::from_secs(60)).assert().code(2);
    assert!(!place.files().contains(&"b.glb".to_owned()));
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

/// Returns a triangle as glTF with further members.
fn gltf(asset: &str, rest: &str) -> String {
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{"asset":{{"version":"2.0"{asset}}},"buffers":[{{"byteLength":36,"uri":"data:;base64,{data}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "accessors":[{{"bufferView":0,"count":3,"componentType":5126,"type":"VEC3"}}],
        "nodes":[{{"mesh":0}}]{rest}}}"#
    )
}

const MESH: &str = r#","meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;

#[test]
fn texts_of_a_file_are_cut() {
    let generator = "g".repeat(1 << 16);
    let place = Place::with("a.gltf", gltf(&format!(r#","generator":"{generator}""#), MESH));
    let assert = place.taotie("inspect a.gltf").assert().success();
    let printed = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(printed.contains("gggg") && printed.lines().all(|line| line.chars().count() < 1000));
    let whole = place.json("inspect a.gltf --json");
    assert_eq!(whole["generator"].as_str().map(str::len), Some(1 << 16), "JSON has all of it");
}

#[test]
fn texts_of_a_file_do_not_rule_the_terminal() {
    let header = "ply\nformat ascii 1.0\ncomment TextureFile \u{1b}]0;owned\u{7}\u{9b}31m.png\nelement vertex 3\n\
        property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let place = Place::with("a.ply", format!("{header}0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"));
    for line in ["render a.ply -o a.png --size 16", "inspect a.ply"] {
        let assert = place.taotie(line).assert().success();
        let output = assert.get_output();
        let printed =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat();
        assert!(printed.contains("owned"), "{printed}");
        assert!(!printed.chars().any(|c| c.is_control() && c != '\n'), "{printed:?}");
    }
}

#[test]
fn many_materials_take_time_in_proportion() {
    let count = 300_000;
    let material = r#"{"pbrMetallicRoughness":{"roughnessFactor":7}}"#;
    let materials = vec![material; count].join(",");
    let primitives = vec![r#"{"attributes":{"POSITION":0},"material":1}"#; 1000].join(",");
    let rest = format!(r#","materials":[{materials}],"meshes":[{{"primitives":[{primitives}]}}]"#);
    let place = Place::with("a.gltf", gltf("", &rest));
    place.taotie("inspect a.gltf").timeout(Duration::from_secs(60)).assert().success();
}

#[test]
fn a_model_names_no_file_outside_its_folder_unless_it_may() {
    let place = Place::new();
    std::fs::create_dir(place.path("model")).unwrap();
    let text = gltf("", MESH);
    let start = text.find("data:").unwrap();
    let end = start + text[start..].find('"').unwrap();
    place.write("model/a.gltf", format!("{}../secret.bin{}", &text[..start], &text[end..]));
    let floats = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    place.write("secret.bin", floats.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
    for line in [
        "inspect model/a.gltf",
        "render model/a.gltf -o a.png --size 16",
        "compare model/a.gltf -o out --size 16",
        "bake model/a.gltf -o a.glb --triangles 4 --size 16",
    ] {
        let said = refused(&place, line);
        assert!(said.contains("secret.bin") && said.contains("--allow-outside"), "{line}: {said}");
    }
    place.taotie("inspect model/a.gltf --allow-outside").assert().success();
    place.taotie("render model/a.gltf -o a.png --size 16 --allow-outside").assert().success();
}
