//! Maps without a model: `bake -o normal.png`.

use super::bake_carried::{colored, write_scan};
use super::bake_document::{ship, start};
use super::balls::{Ball, LOW, SCAN};
use super::place::Place;
use serde_json::{Value, json};
use taotie_engine::image::Texels;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene};
use taotie_io::{GltfFormat, load_model, read_bitmap, write_scene};

fn scan_and_low() -> Place {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    place
}

/// The options of all successful bakes.
const LINE: &str = "bake scan.obj --low low.obj --size 64";

fn baked(place: &Place, options: &str) -> Value {
    place.json(&format!("{LINE} {options} --json"))
}

fn texels(place: &Place, name: &str) -> Vec<[u8; 4]> {
    let bitmap = read_bitmap(&place.path(name)).expect("it is a picture");
    let Texels::U8(texels) = bitmap.texels() else { panic!("{name}: 8 bits") };
    texels.clone()
}

#[test]
fn the_map_is_that_of_a_model_and_measured_alike() {
    let place = scan_and_low();
    let with_model = baked(&place, "-o asset.gltf");
    let standalone = baked(&place, "-o normal.png");
    assert!(texels(&place, "normal.png") == texels(&place, "asset_normal.png"));
    let mean = |report: &Value| {
        report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().expect("it is measured")
    };
    let [expected, measured] = [&with_model, &standalone].map(mean);
    assert!((expected - measured).abs() < 0.02 * expected, "{expected} with a model, {measured} standalone");
    let bare = standalone["proof"]["levels"][0]["without_map"]["mean"].as_f64().expect("it is measured");
    assert!(measured < 0.8 * bare, "the map was used: {measured} with it, {bare} without");
    assert_eq!(standalone["files"], json!(["normal.png", "normal.report.html", "normal.report.json"]));
    assert_eq!(
        (&standalone["maps"][0]["map"], &standalone["maps"][0]["file"]),
        (&json!("normal"), &json!("normal.png"))
    );
}

#[test]
fn the_first_requested_map_is_the_file_itself() {
    let place = scan_and_low();
    let report = baked(&place, "-o out.png --maps height,ao --no-verify");
    let file = |map: &str| {
        let maps = report["maps"].as_array().expect("it is a list");
        maps.iter().find(|note| note["map"] == map).map(|note| note["file"].clone())
    };
    assert_eq!((file("height"), file("ao")), (Some(json!("out.png")), Some(json!("out.ao.png"))));
    let output =
        place.taotie(&format!("{LINE} -o output.png --maps height --no-verify")).output().expect("it runs");
    let output = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.contains("range of height  black is ") && output.contains("model units"), "{output}");
    assert_eq!(read_bitmap(&place.path("out.png")).expect("it is a picture").channels(), 1);
}

/// Returns the mean angle on the surface.
fn surface_mean(report: &Value) -> f64 {
    report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().expect("it is measured")
}

#[test]
fn every_material_gets_its_own_set() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    let line = "bake scan.obj --low low.glb --size 64 --maps normal,ao --ao-rays 4 --json -o";
    let [model, report] = ["asset.glb", "out.png"].map(|out| place.json(&format!("{line} {out}")));
    let labels = ["wood", "iron", "cloth"];
    let mut files: Vec<String> =
        labels.iter().flat_map(|label| ["png", "ao.png"].map(|end| format!("out.{label}.{end}"))).collect();
    let maps: Vec<Value> =
        report["maps"].as_array().expect("a list").iter().map(|map| map["file"].clone()).collect();
    assert_eq!(json!(maps), json!(files));
    assert_eq!((&report["maps"][3]["material"], &report["maps"][3]["map"]), (&json!("iron"), &json!("ao")));
    files.extend(["out.report.html", "out.report.json"].map(str::to_owned));
    assert_eq!(report["files"], json!(files));
    assert!(!place.path("out.png").exists(), "it would hold no material's map");
    let scene = load_model(place.path("asset.glb")).expect("it is sound").scene;
    for (material, label) in scene.materials().iter().zip(labels) {
        let normal = material.normal.expect("it has one").texture.texture;
        let written = read_bitmap(&place.path(&format!("out.{label}.png"))).expect("it is a picture");
        assert!(written == *scene.textures()[normal].bitmap(), "{label}");
    }
    let [expected, measured] = [&model, &report].map(surface_mean);
    assert!((expected - measured).abs() < 0.02 * expected, "{expected} with a model, {measured} standalone");
    let parts = report["proof"]["parts"].as_array().expect("a list");
    let names: Vec<&Value> = parts.iter().map(|part| &part["material"]).collect();
    assert_eq!(json!(names), json!(labels));
    // Each map is proved on its own material, in object space too.
    let object =
        place.json("bake scan.obj --low low.glb --size 64 --maps normal --space object --json -o object.png");
    let [object, tangent] = [&object, &report].map(surface_mean);
    assert!(object < 2.0 * tangent, "{object} {tangent}");
}

#[test]
fn names_of_materials_are_made_safe_and_unique() {
    let place = scan_and_low();
    let faces = LOW.obj();
    let (vertices, faces) = faces.split_at(faces.find("\nf ").expect("it has faces") + 1);
    let half = faces[faces.len() / 2..].find("\nf ").expect("it has faces") + faces.len() / 2 + 1;
    let (one, other) = faces.split_at(half);
    place.write("low.obj", format!("mtllib low.mtl\n{vertices}usemtl a/b\n{one}usemtl a_b\n{other}"));
    place.write("low.mtl", "newmtl a/b\nKd 1 0 0\nnewmtl a_b\nKd 0 1 0\n");
    let report = baked(&place, "-o out.exr --green down --no-verify");
    assert_eq!(report["files"], json!(["out.a_b.exr", "out.a_b1.exr"]));
    assert_eq!(report["warnings"], json!([]));
}

#[test]
fn further_maps_lie_beside_the_first() {
    let place = scan_and_low();
    let report = baked(&place, "-o out.png --maps normal,ao,height --ao-rays 4 --bits 16");
    let files = ["out.png", "out.ao.png", "out.height.png", "out.report.html", "out.report.json"];
    assert_eq!(report["files"], json!(files));
    let bits = |name: &str| read_bitmap(&place.path(name)).expect("it is a picture").bits();
    assert_eq!(files[..3].iter().map(|name| bits(name)).collect::<Vec<_>>(), [16, 8, 16]);
    let height = report["maps"].as_array().unwrap().iter().find(|note| note["map"] == "height").unwrap();
    assert!(height["black"].as_f64().unwrap() < height["white"].as_f64().unwrap());
    assert_eq!((&height["file"], &height["unit"]), (&json!("out.height.png"), &json!("model units")));
}

#[test]
fn webp_holds_the_same_texels() {
    let place = scan_and_low();
    baked(&place, "-o a.png --maps normal,ao --ao-rays 4");
    let report = baked(&place, "-o b.webp --maps normal,ao --ao-rays 4");
    assert_eq!((&report["files"][0], &report["files"][1]), (&json!("b.webp"), &json!("b.ao.webp")));
    assert!(texels(&place, "a.png") == texels(&place, "b.webp"));
    // A grey PNG has one channel, a WebP three equal ones.
    let red = |name: &str| texels(&place, name).iter().map(|texel| texel[0]).collect::<Vec<_>>();
    assert!(red("a.ao.png") == red("b.ao.webp"));
    assert!(report["proof"]["levels"][0]["surface_angles"]["mean"].is_number());
}

/// Returns the numbers of an OpenEXR file.
fn numbers(place: &Place, name: &str) -> Vec<[f32; 4]> {
    let bitmap = read_bitmap(&place.path(name)).expect("it is a picture");
    let Texels::F32(texels) = bitmap.texels() else { panic!("{name}: floats") };
    texels.clone()
}

#[test]
fn openexr_holds_the_numbers_themselves() {
    let place = scan_and_low();
    let fine = baked(&place, "-o a.png --maps normal,height --bits 16");
    let mean = |report: &Value| {
        report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().expect("it is measured")
    };
    for green in ["up", "down"] {
        let report = baked(&place, &format!("-o b.exr --maps normal,height --green {green}"));
        assert!((mean(&fine) - mean(&report)).abs() < 1e-3, "{} {}", mean(&fine), mean(&report));
        let length = |[x, y, z, _]: &[f32; 4]| (x * x + y * y + z * z).sqrt();
        let normals = numbers(&place, "b.exr");
        let unit = normals.iter().filter(|normal| (length(normal) - 1.0).abs() < 1e-3).count();
        assert!(10 * unit > 9 * normals.len(), "{unit} of {}", normals.len());
    }
    let object = baked(&place, "-o c.exr --space object");
    assert!(mean(&object) < 2.0 * mean(&fine), "{} {}", mean(&object), mean(&fine));
    let note = |name: &str| fine["maps"][1][name].as_f64().expect("a number of the height map");
    let heights = numbers(&place, "b.height.exr");
    let most = heights.iter().fold(f32::NEG_INFINITY, |most, [height, ..]| most.max(*height));
    assert!((f64::from(most) - note("white")).abs() < 1e-4 * (note("white") - note("black")), "{most}");
}

#[test]
fn green_down_is_in_the_map_itself_and_the_proof_knows() {
    let place = scan_and_low();
    let up = baked(&place, "-o up.png");
    let down = baked(&place, "-o down.png --green down");
    let turned: Vec<[u8; 4]> =
        texels(&place, "up.png").iter().map(|[r, g, b, a]| [*r, 255 - g, *b, *a]).collect();
    assert!(texels(&place, "down.png") == turned);
    assert_eq!(down["files"][1], "down.report.html", "and no second normal map");
    let mean = |report: &Value| {
        report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().expect("it is measured")
    };
    assert!((mean(&up) - mean(&down)).abs() < 1e-6, "{} {}", mean(&up), mean(&down));
}

#[test]
fn object_space_is_measured_too() {
    let place = scan_and_low();
    let [tangent, object] =
        ["tangent", "object"].map(|space| baked(&place, &format!("-o {space}.png --space {space}")));
    let mean = |report: &Value| {
        report["proof"]["levels"][0]["surface_angles"]["mean"].as_f64().expect("it is measured")
    };
    assert!(mean(&object) < 2.0 * mean(&tangent), "{} {}", mean(&object), mean(&tangent));
    assert!(place.files().contains(&"object.png".to_owned()));
}

#[test]
fn colours_are_measured_where_a_map_holds_them() {
    let place = Place::with("scan.obj", colored(SCAN));
    place.write("low.obj", LOW.obj());
    let with_model = baked(&place, "-o asset.glb");
    let standalone = baked(&place, "-o out.png");
    assert_eq!(standalone["files"][1], "out.albedo.png");
    let color = |report: &Value| {
        report["proof"]["levels"][0]["material"]["color"]["mean"].as_f64().expect("it is measured")
    };
    let [expected, measured] = [&with_model, &standalone].map(color);
    assert!((expected - measured).abs() < 0.05 * expected, "{expected} with a model, {measured} standalone");
    let grey = baked(&place, "-o grey.png --maps normal");
    assert!(grey["proof"]["levels"][0]["material"]["color"].is_null(), "no map holds it");
    assert_eq!(grey["proof"]["levels"][0]["full_views"], json!([]));
    let unseen = grey["proof"]["unseen"].to_string();
    assert!(unseen.contains("colour and material, for which no map is baked"), "{unseen}");
}

#[test]
fn factors_that_no_map_holds_are_told() {
    let place = scan_and_low();
    write_scan(&place, vec![Material { metallic: 1.0, roughness: 0.3, ..Material::default() }]);
    let line = "bake scan.glb --low low.obj --size 64 -o out.png";
    let assert = place.taotie(line).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("standalone maps cannot store the scan's material factors: "), "{said}");
    let report: Value = serde_json::from_slice(&place.read("out.report.json")).expect("it is JSON");
    assert_eq!(report["carried"], json!([]));
}

#[test]
fn a_material_that_does_not_show_them_is_told() {
    let place = Place::with("scan.obj", SCAN.obj());
    let unlit = Material { unlit: true, ..Material::default() };
    let low = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), unlit).unwrap();
    write_scene(&place.path("low.glb"), &low, &GltfFormat::default()).unwrap();
    let is_told = |maps: &str| {
        let line = format!("bake scan.obj --low low.glb --size 64 --maps {maps} -o out.png --json");
        place.json(&line)["warnings"].to_string().contains("materials are unlit (KHR_materials_unlit)")
    };
    assert_eq!(["normal", "albedo,normal", "albedo"].map(is_told), [true, true, false]);
}

#[test]
fn what_only_a_model_has_is_refused_before_the_work() {
    let place = scan_and_low();
    place.write("bare.obj", Ball { uv: None, ..LOW }.obj());
    place.write("rights.json", "{}");
    let standalone = "normal.png holds only maps, not a model; leave it out, or write a .glb";
    let options =
        ["--meshopt", "--lods 100", "--images webp", "--images jpeg:80", "--provenance rights.json"];
    let before = place.files();
    let refused = |line: &str, words: &str| {
        let assert = place.taotie(line).assert().code(2).stdout_eq("");
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words), "{line}: {said}");
        assert_eq!(place.files(), before, "{line}");
    };
    for option in options {
        refused(&format!("{LINE} -o normal.png {option}"), standalone);
    }
    refused(
        "bake scan.obj -o normal.png --size 64",
        "standalone maps need a mesh with UVs: give one with --low",
    );
    refused("bake scan.obj -o normal.png --triangles 500", "--triangles: normal.png holds only maps");
    refused(
        "bake scan.obj --low bare.obj -o normal.png --size 64",
        "standalone maps: no file would store generated uvs",
    );
    refused(&format!("{LINE} -o normal.bmp"), "standalone maps as .png, .tiff, .exr, .tga, .dds or .webp");
    refused(&format!("{LINE} -o normal.exr --bits 16"), "--bits: an .exr stores floats");
    refused(&format!("{LINE} -o normal.webp --bits 16"), "--bits 16: a .webp stores 8 bits; write a .png");
    refused(&format!("{LINE} -o normal.webp --maps normal,height"), "--maps height: it needs 16 bits");
}
