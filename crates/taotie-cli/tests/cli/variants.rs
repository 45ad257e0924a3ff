//! Material variants of a file.

use super::models::square_json;
use super::place::Place;
use serde_json::json;
use snapbox::str;
use taotie_engine::image::Texels;
use taotie_io::read_bitmap;

/// Returns the square, black as authored and glowing in the variants `amber` and `jade`.
fn variants() -> String {
    let mut json = square_json();
    let glow = |color: [f32; 3]| json!({ "emissiveFactor": color, "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1] } });
    json["materials"] = json!([glow([0.0; 3]), glow([1.0, 0.5, 0.0]), glow([0.0, 1.0, 0.5])]);
    json["extensionsUsed"] = json!(["KHR_materials_variants", "KHR_lights_punctual"]);
    json["extensions"]["KHR_materials_variants"] =
        json!({ "variants": [{ "name": "amber" }, { "name": "jade" }] });
    json["meshes"][0]["primitives"][0]["extensions"] = json!({
        "KHR_materials_variants": {
            "mappings": [{ "material": 1, "variants": [0] }, { "material": 2, "variants": [1] }],
        },
    });
    json.to_string()
}

#[test]
fn inspect_lists_them() {
    let place = Place::with("a.gltf", variants());
    assert_eq!(place.json("inspect a.gltf --json")["variants"], json!(["amber", "jade"]));
    place.taotie("inspect a.gltf").assert().success().stdout_eq(str![[r#"
...
Variants
  amber
  jade
...
"#]]);
}

#[test]
fn render_shows_the_one_asked_for() {
    let place = Place::with("a.gltf", variants());
    let middle = |variant: &str| {
        let line = format!("render a.gltf {variant} -o b.png --size 9x9 --tone linear --camera front");
        place.taotie(&line).assert().success();
        let picture = read_bitmap(&place.path("b.png")).expect("it is a picture");
        let Texels::U8(texels) = picture.texels() else { panic!("8 bits") };
        texels[4 * 9 + 4]
    };
    let [authored, amber, jade] = [middle(""), middle("--variant amber"), middle("--variant jade")];
    assert!(authored[0] < 60 && authored[1] < 60, "{authored:?}");
    assert!(amber[0] == 255 && amber[2] < 60, "{amber:?}");
    assert!(jade[1] == 255 && jade[0] < 60, "{jade:?}");
}

#[test]
fn bake_tells_that_they_are_left_out() {
    let place = Place::with("a.gltf", variants());
    let report = place.json("bake a.gltf -o b.glb --size 16 --no-verify --json");
    let warnings = report["warnings"].as_array().expect("a list");
    let left_out = warnings
        .iter()
        .find(|warning| warning["what"].as_str().is_some_and(|w| w.contains("material variants")));
    assert_eq!(left_out.expect("a warning")["count"], 2, "{warnings:?}");
}

#[test]
fn an_unknown_one_is_refused() {
    let place = Place::with("a.gltf", variants());
    for command in ["render a.gltf -o b.png", "compare a.gltf -o b"] {
        let line = format!("{command} --variant ruby");
        place.taotie(&line).assert().code(2).stderr_eq(str![[r#"
taotie: error: a.gltf: unknown variant 'ruby': expected one of: amber, jade

"#]]);
    }
}
