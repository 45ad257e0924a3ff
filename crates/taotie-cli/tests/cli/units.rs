//! `--unit`: assets in metres, lengths with units, and figures that are the same without it.

use super::bake_document::{put, ship, ship_draft, start};
use super::balls::{Ball, SCAN};
use super::glb::Glb;
use super::place::Place;
use super::validator::assert_valid;
use serde_json::{Value, json};

/// A proof that takes little time.
const QUICK: &str = "--proof-points 20000 --proof-view 96 --json";

/// A folder with a ball of 80 mm.
fn ball() -> Place {
    Place::with("scan.obj", Ball { radius: 40.0, ..SCAN }.obj())
}

/// Returns the proof of the pair without the unit and the bytes of the asset, which differ.
fn figures(report: &Value) -> Value {
    let mut proof = report["proof"].clone();
    for name in ["unit", "metres_per_unit", "bytes_out"] {
        proof.as_object_mut().unwrap().remove(name).unwrap();
    }
    proof
}

fn stderr(assert: &snapbox::cmd::OutputAssert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

#[test]
fn an_asset_of_a_scan_in_millimetres_is_in_metres() {
    let place = ball();
    let line = "bake scan.obj --triangles 2000 --size 64 --json";
    let plain = place.json(&format!("{line} -o plain.glb"));
    let gate = "--require hausdorff=2mm,silhouette=2mm,texel=5mm";
    let report = place.json(&format!("{line} -o out.glb --unit mm {gate}"));
    assert_eq!((&plain["proof"]["unit"], &plain["proof"]["metres_per_unit"]), (&Value::Null, &Value::Null));
    assert_eq!(
        (&report["proof"]["unit"], &report["proof"]["metres_per_unit"]),
        (&json!("mm"), &json!(0.001))
    );
    assert_eq!(figures(&report), figures(&plain), "to the bit");

    let json = Glb::read(&place.read("out.glb")).json;
    assert_eq!(json["scenes"][0]["nodes"], json!([0]));
    assert_eq!(
        (&json["nodes"][0]["scale"], &json["nodes"][0]["children"]),
        (&json!([0.001, 0.001, 0.001]), &json!([1]))
    );
    assert_eq!(json["nodes"][1]["mesh"], 0);
    let [with, without] = ["out.glb", "plain.glb"].map(|name| Glb::read(&place.read(name)));
    assert_eq!(with.bytes, without.bytes, "vertices and texels are the same");
    assert_valid(&place.path("out.glb"));

    let distance = report["certificate"]["required"][0].clone();
    let upper = report["proof"]["levels"][0]["hausdorff"]["upper"].as_f64().unwrap();
    assert_eq!(distance["is_length"], true);
    // Reading JSON may change the last bit.
    let value = distance["value"].as_f64().unwrap();
    assert!((value / (upper * 1e-3) - 1.0).abs() < 1e-14, "metres: {value}, {upper}");

    // The asset records the unit.
    let verified = place.json(&format!("verify out.glb --scan scan.obj {QUICK} {gate}"));
    assert_eq!(verified["proof"], report["proof"]);
    assert_eq!(verified["certificate"]["required"], report["certificate"]["required"]);
    let page = place
        .taotie(&format!("verify out.glb --scan scan.obj {}", QUICK.trim_end_matches(" --json")))
        .assert();
    let text = String::from_utf8_lossy(&page.get_output().stdout).into_owned();
    assert!(text.contains(" dpi) wide") && text.contains(" mm (") && !text.contains("model units"), "{text}");
    // The option overrides the record: in inches the asset is far too small.
    let assert =
        place.taotie(&format!("verify out.glb --scan scan.obj --unit in {QUICK} --require missed=50%"));
    assert.assert().code(1);
}

#[test]
fn a_length_needs_a_unit() {
    let place = ball();
    for line in [
        "bake scan.obj -o out.glb --require hausdorff=0.2mm",
        "bake scan.obj -o out.glb --require texel=50um",
    ] {
        let said = stderr(&place.taotie(line).assert().code(2));
        assert!(
            said.contains("--unit mm") && (said.contains("hausdorff=0.2 mm") || said.contains("texel=50 µm")),
            "{said}"
        );
    }
    let asset = "bake scan.obj -o out.glb --triangles 2000 --size 64 --no-verify";
    place.taotie(asset).assert().success();
    let said =
        stderr(&place.taotie("verify out.glb --scan scan.obj --require hausdorff=0.2mm").assert().code(2));
    assert!(said.contains("--unit mm"), "{said}");
    // The asset was not written in metres.
    let said = stderr(&place.taotie("verify out.glb --scan scan.obj --unit mm").assert().code(2));
    assert!(said.contains("out.glb: glTF is in metres, but its size shows that it is in mm"), "{said}");
    place.taotie("bake scan.obj -o a.glb --unit ft").assert().code(2);
}

#[test]
fn packed_levels_of_detail_are_scaled_each() {
    let place = ball();
    let line = "bake scan.obj --triangles 2000 --lods 800 --size 64 --meshopt --json";
    let plain = place.json(&format!("{line} -o plain.glb"));
    let report = place.json(&format!("{line} -o out.glb --unit in"));
    assert_eq!(figures(&report), figures(&plain), "to the bit");
    let nodes = Glb::read(&place.read("out.glb")).json["nodes"].clone();
    assert_eq!(
        nodes[0]["extensions"]["MSFT_lod"]["ids"],
        json!([2]),
        "the level has its own map, and so its own file"
    );
    assert_eq!([&nodes[0]["children"], &nodes[2]["children"]], [&json!([1]), &json!([3])]);
    assert!(nodes[0]["scale"] == nodes[2]["scale"] && nodes[0]["scale"][0] == json!(0.0254), "{nodes}");
    assert!(nodes[1]["scale"].is_array() && nodes[3]["scale"].is_array(), "steps of positions");
    assert_valid(&place.path("out.glb"));
}

#[test]
fn a_file_that_stays_is_in_metres_too() {
    let (place, low) = start();
    let line = "bake scan.obj --low low.glb -o out.glb --size 64 --json";
    place.write("low.glb", ship(&low));
    let plain = place.json(line);

    // As large as the scan in inches: it is scaled, with a warning.
    let report = place.json(&format!("{line} --unit in"));
    assert_eq!(figures(&report), figures(&plain));
    let warnings = report["warnings"].to_string();
    assert!(
        warnings.contains("low.glb: glTF is in metres, but its size shows that it is in in"),
        "{warnings}"
    );
    let json = Glb::read(&place.read("out.glb")).json;
    assert_eq!(json["scenes"][0]["nodes"], json!([4]));
    assert_eq!(
        json["nodes"][4],
        json!({ "name": "metres", "scale": [0.0254, 0.0254, 0.0254], "children": [0] })
    );
    assert_valid(&place.path("out.glb"));
    let verified = place.json(&format!("verify out.glb --scan scan.obj {QUICK}"));
    assert_eq!(figures(&verified)["levels"], figures(&plain)["levels"]);

    // Already in metres: its nodes stay as they are.
    let mut draft = ship_draft(&low);
    let nodes = json!([
        { "name": "ship", "children": [1, 2], "scale": [0.0254, 0.0254, 0.0254] },
        { "name": "hull", "mesh": 0 },
        { "name": "sail", "mesh": 1, "translation": [2.0, 0.0, 0.0] },
    ]);
    put(&mut draft, "nodes", &nodes);
    put(&mut draft, "cameras", &Value::Null);
    let mut file = Glb::read(&draft.encode_glb().unwrap());
    file.json.as_object_mut().unwrap().remove("cameras");
    place.write("low.glb", file.file());
    let report = place.json(&format!("{line} --unit in"));
    assert_eq!(figures(&report)["levels"], figures(&plain)["levels"]);
    let json = Glb::read(&place.read("out.glb")).json;
    assert_eq!((&json["nodes"], &json["scenes"][0]["nodes"]), (&nodes, &json!([0])));
    assert_valid(&place.path("out.glb"));
}

#[test]
fn a_gltf_scan_is_in_metres_unless_it_is_stated() {
    let place = ball();
    let scene = taotie_io::load_model(place.path("scan.obj")).unwrap().scene;
    taotie_io::write_scene(&place.path("scan.glb"), &scene, &taotie_io::GltfFormat::default()).unwrap();
    let line = "bake scan.glb -o out.glb --triangles 2000 --size 64 --json";
    let report = place.json(&format!("{line} --require hausdorff=2m"));
    assert_eq!(report["proof"]["unit"], "m");
    assert!(Glb::read(&place.read("out.glb")).json["nodes"][0]["scale"].is_null(), "nothing is scaled");
    let stated = place.json(&format!("{line} --unit cm"));
    assert_eq!((&stated["proof"]["unit"], &stated["parameters"]["unit"]), (&json!("cm"), &json!("cm")));
    assert_eq!(figures(&stated), figures(&report));
    assert_eq!(place.json(&format!("verify out.glb --scan scan.glb {QUICK}"))["proof"], stated["proof"]);
}
