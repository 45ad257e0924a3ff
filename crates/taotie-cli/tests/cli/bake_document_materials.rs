//! `taotie bake` onto the materials of a glTF file that stays, whose extensions would hide what is baked, or be
//! hidden.

use super::bake_document::{put, ship_draft, start};
use super::glb::Glb;
use super::place::Place;
use super::validator::assert_valid;
use serde_json::{Value, json};
use taotie_engine::scene::{Clearcoat, Material};
use taotie_io::{GltfFormat, load_model, write_scene};

/// Writes a ship whose three materials have this extension.
fn write_ship(place: &Place, low: &taotie_engine::mesh::Mesh, name: &str, extension: &Value) {
    let mut draft = ship_draft(low);
    let material = |number: usize| json!({ "name": format!("m{number}"), "extensions": { name: extension } });
    put(&mut draft, "materials", &json!([0, 1, 2].map(material)));
    put(&mut draft, "extensionsUsed", &json!([name]));
    place.write("low.glb", draft.encode_glb().unwrap());
}

/// Writes the scan with a material as `scan.glb`.
fn write_scan(place: &Place, material: Material) {
    let mut scene = load_model(place.path("scan.obj")).unwrap().scene;
    scene.edit(|scene| scene.materials = vec![material]).unwrap();
    write_scene(&place.path("scan.glb"), &scene, &GltfFormat::default()).unwrap();
}

/// Returns the report of a bake.
fn report(place: &Place, line: &str) -> Value {
    place.json(&format!("bake {line} --low low.glb -o out.glb --size 64 --no-verify --json"))
}

#[test]
fn a_layer_of_the_scan_stands_where_the_file_has_it_switched_off() {
    let (place, low) = start();
    let coat = Clearcoat {
        factor: 0.75,
        factor_texture: None,
        roughness: 0.5,
        roughness_texture: None,
        normal: None,
    };
    write_scan(&place, Material { clearcoat: Some(coat), ..Material::default() });
    let name = "KHR_materials_clearcoat";
    for off in [json!({}), json!({ "clearcoatFactor": 0, "clearcoatRoughnessFactor": 0.5 })] {
        write_ship(&place, &low, name, &off);
        let report = report(&place, "scan.glb");
        // The scan is a dielectric, and the file's materials are the default of glTF, a metal.
        let carried = json!(["clearcoat", "metallic-roughness"]);
        assert_eq!((&report["carried"], &report["left"]), (&carried, &json!([])));
        let materials = load_model(place.path("out.glb")).unwrap().scene.materials().to_vec();
        let is_coated = |m: &Material| m.clearcoat == Some(coat) && (m.metallic, m.roughness) == (0.0, 0.6);
        assert!(materials.len() == 3 && materials.iter().all(is_coated), "{materials:?}");
        assert_valid(&place.path("out.glb"));
    }
    // Its own layer stays, with a warning.
    write_ship(&place, &low, name, &json!({ "clearcoatFactor": 0.25 }));
    let report = report(&place, "scan.glb");
    assert_eq!(
        (&report["carried"], &report["left"][0]["what"]),
        (&json!(["metallic-roughness"]), &json!("clearcoat"))
    );
    let json = Glb::read(&place.read("out.glb")).json;
    assert_eq!(json["materials"][0]["extensions"][name], json!({ "clearcoatFactor": 0.25 }));
}

/// Returns how often a report warns about this.
fn times_warned(report: &Value, what: &str) -> u64 {
    let warnings = report["warnings"].as_array().expect("there is a list");
    let text = |warning: &Value| warning["what"].as_str().is_some_and(|text| text.contains(what));
    warnings.iter().filter(|warning| text(warning)).map(|warning| warning["count"].as_u64().unwrap()).sum()
}

#[test]
fn colours_and_gloss_that_would_hide_what_is_baked_go() {
    let (place, low) = start();
    let name = "KHR_materials_pbrSpecularGlossiness";
    write_ship(&place, &low, name, &json!({ "diffuseFactor": [1.0, 0.0, 0.0, 1.0] }));
    let after = |maps: &str| {
        let report = report(&place, &format!("scan.obj --maps {maps}"));
        (
            times_warned(&report, &format!("dropped {name} of the low-poly mesh's materials")),
            Glb::read(&place.read("out.glb")).json,
        )
    };
    let (count, json) = after("normal");
    assert_eq!((count, &json["extensionsUsed"][0]), (0, &json!(name)), "normals are shown with it");
    assert_eq!(json["materials"][2]["extensions"][name]["diffuseFactor"], json!([1.0, 0.0, 0.0, 1.0]));
    let (count, json) = after("normal,albedo");
    assert_eq!(count, 3);
    assert!(!json.to_string().contains(name), "{json}");
    assert_valid(&place.path("out.glb"));
}

#[test]
fn maps_that_an_unlit_material_does_not_show_are_told() {
    let (place, low) = start();
    write_ship(&place, &low, "KHR_materials_unlit", &json!({}));
    let count = |maps: &str| {
        let report = report(&place, &format!("scan.obj --maps {maps}"));
        let unlit = load_model(place.path("out.glb")).unwrap().scene.materials().iter().all(|m| m.unlit);
        assert!(unlit, "the look of the file stays");
        times_warned(
            &report,
            "materials are unlit (KHR_materials_unlit): viewers show only their base colour map",
        )
    };
    assert_eq!(["normal,albedo", "albedo"].map(count), [3, 0]);
}
