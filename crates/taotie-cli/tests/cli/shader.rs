//! The files and output of `taotie shader`.

use super::models::{TRIANGLE, square_json};
use super::place::Place;
use super::schemas;
use serde_json::{Value, json};
use snapbox::str;
use taotie_io::{ExrLayer, write_exr};

/// Returns two squares with a material each, `stone` and one that `change` makes from it.
fn two_stones(change: impl FnOnce(&mut Value)) -> Place {
    let mut model = square_json();
    let mut other = model["materials"][0].clone();
    other["name"] = json!("other");
    change(&mut other);
    model["materials"] = json!([model["materials"][0], other, { "name": "nowhere" }]);
    let mut primitive = model["meshes"][0]["primitives"][0].clone();
    primitive["material"] = json!(1);
    model["meshes"] = json!([model["meshes"][0], { "name": "second", "primitives": [primitive] }]);
    model["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1 }]);
    model["scenes"] = json!([{ "nodes": [0, 1] }]);
    Place::with("a.gltf", model.to_string())
}

/// Returns the names in a folder of a place, sorted.
fn names(place: &Place, folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(place.path(folder)).expect("the folder exists");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn read_json(place: &Place, name: &str) -> Value {
    let document = serde_json::from_slice(&place.read(name)).expect("it is JSON");
    schemas::check("shader-interface", &document);
    document
}

#[test]
fn a_plain_material_needs_no_model() {
    let place = Place::new();
    let line = "shader --shading cook-torrance --surface tangent-normal --target wgsl -o out";
    place.taotie(line).assert().success().stderr_eq("").stdout_eq(str![[r#"
out/cook-torrance-tangent-normal.wgsl
out/albedo-tables.bin
out/cook-torrance-tangent-normal.json
out/index.html

"#]]);
    let text = String::from_utf8(place.read("out/cook-torrance-tangent-normal.wgsl")).expect("it is text");
    assert!(text.contains("fn fragment_main(") && text.contains("normal_texture"), "{text}");
    let described = read_json(&place, "out/cook-torrance-tangent-normal.json");
    let kinds = [&described["shading"], &described["surface"], &described["target"]].map(Value::as_str);
    assert_eq!(kinds, [Some("cook-torrance"), Some("tangent-normal"), Some("wgsl")]);
    let plain = &described["surfaces"][0];
    assert_eq!((&plain["uniforms"]["metallic"], &plain["instances"]), (&json!([0.0]), &json!([])));
    let tables = &described["tables"];
    let bytes = tables["width"].as_u64().unwrap() * tables["height"].as_u64().unwrap() * 16;
    assert_eq!(place.read("out/albedo-tables.bin").len() as u64, bytes);
    let names: Vec<_> =
        described["interface"]["textures"].as_array().unwrap().iter().map(|t| &t["name"]).collect();
    assert_eq!(names, ["albedo_tables", "normal_texture"]);
}

#[test]
fn every_language_has_files_of_its_own() {
    let cases: [(&str, &[&str]); 5] = [
        ("wgsl", &["ggx-smooth.wgsl"]),
        ("glsl-es", &["ggx-smooth.frag", "ggx-smooth.vert", "material.js"]),
        ("hlsl", &["ggx-smooth.hlsl"]),
        ("msl", &["ggx-smooth.metal"]),
        ("spirv", &["ggx-smooth.spv"]),
    ];
    for (target, own) in cases {
        let place = Place::new();
        place.taotie(&format!("shader --target {target} -o out")).assert().success();
        let mut expected = [own, &["albedo-tables.bin", "ggx-smooth.json", "index.html"]].concat();
        expected.sort_unstable();
        assert_eq!(names(&place, "out"), expected, "{target}");
    }
}

#[test]
fn only_what_is_read_is_written() {
    let place = Place::new();
    place.taotie("shader --shading lambert --target wgsl -o out").assert().success();
    assert_eq!(names(&place, "out"), ["index.html", "lambert-smooth.json", "lambert-smooth.wgsl"]);
    assert!(read_json(&place, "out/lambert-smooth.json")["tables"].is_null());
}

#[test]
fn materials_of_one_variant_share_a_shader() {
    let place = two_stones(|other| other["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.5));
    let report = place.json("shader a.gltf --target wgsl -o out --json");
    let shaders = report["shaders"].as_array().expect("a list");
    assert_eq!(shaders.len(), 1, "{report}");
    assert_eq!(shaders[0]["name"], "stone");
    let surfaces = read_json(&place, "out/stone.json")["surfaces"].clone();
    let value = |i: usize, name: &str| surfaces[i]["uniforms"][name].clone();
    assert_eq!([&surfaces[0]["material"], &surfaces[1]["material"]], ["stone", "other"]);
    assert_eq!((value(0, "roughness"), value(1, "roughness")), (json!([0.75]), json!([0.5])));
    assert_eq!((value(0, "base_color"), value(0, "cutoff")), (json!([0.5, 0.25, 0.125]), json!([0.25])));
    assert_eq!((&surfaces[0]["alpha"], &surfaces[0]["double_sided"]), (&json!("mask"), &json!(true)));
}

#[test]
fn the_page_says_how_to_bind_them_and_fetches_nothing() {
    let place = two_stones(|other| other["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.5));
    place.taotie("shader a.gltf --target glsl-es -o out").assert().success();
    let page = String::from_utf8(place.read("out/index.html")).expect("it is text");
    for word in
        ["material.js", "stone.frag", "FrameBlock", "clip_from_world", "material 1 other on instance 1"]
    {
        assert!(page.contains(word), "{word}: {page}");
    }
    assert!(page.contains("default-src 'none'") && !page.contains("src=\"http"), "{page}");
}

#[test]
fn the_page_shows_code_as_code() {
    let place = Place::new();
    place.taotie("shader --surface tangent-normal --target glsl-es -o out").assert().success();
    let page = String::from_utf8(place.read("out/index.html")).expect("it is text");
    // The data of the page; its script makes `pre` and `code` of it.
    let data = page
        .split_once("id=\"data\">")
        .and_then(|(_, rest)| rest.split_once("</script>"))
        .expect("it has data")
        .0;
    let data: Value = serde_json::from_str(data).expect("it is JSON");
    let codes: Vec<_> =
        data["sections"].as_array().unwrap().iter().filter_map(|s| s["code"]["code"].as_str()).collect();
    let [code] = codes.as_slice() else { panic!("one example: {codes:?}") };
    for line in [
        "import { loadMaterial, normalTexture } from \"./material.js\";",
        "    normal_texture: normalTexture(mesh.material.normalMap, renderer),",
        "mesh.material = await loadMaterial(\"ggx-tangent-normal\", { textures });",
    ] {
        assert!(code.lines().any(|each| each == line), "{line}: {code}");
    }
}

#[test]
fn other_variants_have_shaders_of_their_own() {
    let place = two_stones(|other| {
        other["name"] = json!("Stone");
        other["alphaMode"] = json!("BLEND");
    });
    let report = place.json("shader a.gltf --target spirv -o out --json");
    let named: Vec<_> = report["shaders"].as_array().expect("a list").iter().map(|s| &s["name"]).collect();
    assert_eq!(named, ["stone", "Stone-2"]);
    let one = place.json("shader a.gltf --material Stone --target spirv -o one --json");
    assert_eq!(one["shaders"].as_array().map(Vec::len), Some(1), "{one}");
    assert_eq!(one["shaders"][0]["materials"][0]["number"], 1);
    assert_eq!(
        place.json("shader a.gltf --material 1 --target spirv -o two --json")["shaders"],
        one_in(&one)
    );
}

/// Returns the shaders of a report.
fn one_in(report: &Value) -> Value {
    report["shaders"].clone()
}

#[test]
fn a_material_that_is_not_there_is_an_error() {
    let place = two_stones(|_| ());
    let refused = |asked: &str| {
        let line = format!("shader a.gltf --material {asked} --target wgsl -o out");
        let assert = place.taotie(&line).assert().code(2).stdout_eq("");
        String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
    };
    let unknown = refused("marble");
    assert!(
        unknown.contains("a.gltf: unknown material `marble`; expected one of: 0 stone, 1 other, 2 nowhere"),
        "{unknown}"
    );
    assert!(refused("7").contains("unknown material `7`"));
    assert!(refused("nowhere").contains("no mesh uses the material `nowhere`"));
    assert!(!place.path("out").exists(), "a refused run leaves nothing");
}

#[test]
fn options_without_effect_are_told() {
    let place = Place::with("a.obj", TRIANGLE);
    let refused = |line: &str| {
        let assert = place.taotie(line).assert().code(2).stdout_eq("");
        String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
    };
    assert!(refused("shader --material stone --target wgsl -o out").contains("were not provided"));
    assert!(
        refused("shader a.obj --surface smooth --bump-scale 2 --target wgsl -o out")
            .contains("--bump-scale: --surface")
    );
    assert!(refused("shader --surface bump --bump-scale 2 --target wgsl -o out").contains("without a model"));
    assert!(refused("shader --shading lambert --energy single --target wgsl -o out").contains("--energy"));
    place
        .taotie("shader a.obj --surface bump --bump-scale 2 --target wgsl -o out")
        .assert()
        .success()
        .stderr_eq(str![[r#"
...
taotie: warning: --bump-scale has no effect: no material has a height map
...
"#]]);
    let described = read_json(&place, "out/material-0.json");
    assert_eq!(described["surface"], "smooth", "as it is drawn");
}

#[test]
fn an_environment_is_written_as_shaders_read_it() {
    let place = Place::new();
    let samples: Vec<f32> = [0.5, 0.25, 0.125].into_iter().cycle().take(16 * 8 * 3).collect();
    let layer = ExrLayer { name: "", channels: &["R", "G", "B"], samples: &samples };
    write_exr(&place.path("sky.exr"), (16, 8), &[layer]).unwrap();
    let run = |line: &str| {
        place.taotie(line).env("TAOTIE_CACHE_DIR", place.path("cache")).assert().success().stderr_eq("");
    };
    run("shader --env sky.exr --target glsl-es -o out");
    let described = read_json(&place, "out/ggx-smooth.json")["environment"].clone();
    for (texture, file) in [("maps", "environment-maps.bin"), ("picture", "environment-picture.bin")] {
        let [width, height] = ["width", "height"].map(|side| described[texture][side].as_u64().unwrap());
        assert_eq!(described[texture]["file"], file);
        assert_eq!(place.read(&format!("out/{file}")).len() as u64, width * height * 8, "{described}");
    }
    assert_eq!(described["levels"].as_array().map(Vec::len), Some(32));
    assert!(described["count"].as_u64().unwrap() > 1 && described["smoothest_alpha"].as_f64().unwrap() > 0.0);
    run("shader --env none --target wgsl -o dark");
    assert!(read_json(&place, "dark/ggx-smooth.json")["environment"].is_null());
}

#[test]
fn nothing_that_is_read_is_written_over() {
    let place = Place::with("out", "a file");
    let assert = place.taotie("shader --target wgsl -o out").assert().code(2).stdout_eq("");
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("out: expected a folder, found a file"), "{said}");
    assert_eq!(place.read("out"), b"a file");
}
