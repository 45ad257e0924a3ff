//! FBX from reading to the proof: its unit is known, and objects find their namesakes.

use super::balls::{Ball, LOW, SCAN};
use super::place::Place;
use serde_json::{Value, json};

/// Returns a ball as ASCII FBX with y up, as an object with this name, in a unit of so many centimetres.
fn fbx(ball: &Ball, name: &str, centimetres: f64) -> String {
    let obj = ball.obj();
    let numbers = |keyword: &str| {
        let lines = obj.lines().filter_map(|line| line.strip_prefix(keyword));
        lines.flat_map(|line| line.split(' ').map(str::to_owned).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let (positions, uvs, corners) = (numbers("v "), numbers("vt "), numbers("f "));
    let index =
        |corner: &String, part: usize| corner.split('/').nth(part).map(|i| i.parse::<i64>().unwrap() - 1);
    let last = |i: usize, vertex: i64| if i % 3 == 2 { -1 - vertex } else { vertex };
    let polygons: Vec<i64> = corners.iter().enumerate().map(|(i, c)| last(i, index(c, 0).unwrap())).collect();
    let places: Vec<i64> = corners.iter().filter_map(|c| index(c, 1)).collect();
    let layer = format!(
        "LayerElementUV: 0 {{\nMappingInformationType: \"ByPolygonVertex\"\nReferenceInformationType: \
         \"IndexToDirect\"\nUV: {}\nUVIndex: {}\n}}\n",
        array(&uvs),
        array(&places)
    );
    format!(
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {{\nFBXVersion: 7400\n}}\nGlobalSettings: {{\nProperties70: {{\n\
         P: \"UpAxis\", \"int\", \"Integer\", \"\",1\nP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n\
         P: \"FrontAxis\", \"int\", \"Integer\", \"\",2\nP: \"FrontAxisSign\", \"int\", \"Integer\", \"\",1\n\
         P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\nP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n\
         P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{centimetres}\n}}\n}}\n\
         Objects: {{\nGeometry: 1, \"Geometry::\", \"Mesh\" {{\nVertices: {}\nPolygonVertexIndex: {}\n{}}}\n\
         Model: 2, \"Model::{name}\", \"Mesh\" {{\nVersion: 232\n}}\n}}\n\
         Connections: {{\nC: \"OO\",2,0\nC: \"OO\",1,2\n}}\n",
        array(&positions),
        array(&polygons),
        if uvs.is_empty() { "" } else { &layer }
    )
}

fn array(numbers: &[impl ToString]) -> String {
    let all: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    format!("*{} {{\na: {}\n}}", numbers.len(), all.join(","))
}

#[test]
fn scan_and_low_poly_mesh_may_be_in_different_units() {
    let place = Place::with("scan.fbx", fbx(&Ball { radius: 100.0, ..SCAN }, "ball_high", 1.0));
    place.write("low.fbx", fbx(&LOW, "ball_low", 100.0));
    let report = place.json("inspect scan.fbx --json");
    assert_eq!((&report["format"], &report["counts"]["triangles"]), (&json!("FBX"), &json!(9024)));
    let size = report["bounds"]["size"][1].as_f64().unwrap();
    assert!((1.9..2.1).contains(&size), "in metres: {size}");

    let bake = |line: &str| place.json(&format!("bake {line} --low low.fbx -o out.glb --size 128 --json"));
    let report = bake("scan.fbx");
    assert_eq!((&report["proof"]["unit"], &report["origin"]["groups"]), (&json!("m"), &json!(["ball"])));
    check(&report);
    let verified = place.json("verify out.glb --scan scan.fbx --json");
    assert_eq!(verified["proof"]["levels"], report["proof"]["levels"]);

    // The low-poly mesh is read in the unit of another scan.
    place.write("scan.obj", Ball { radius: 1000.0, ..SCAN }.obj());
    let report = bake("scan.obj --unit mm");
    assert_eq!(report["proof"]["unit"], "mm");
    check(&report);
}

fn check(report: &Value) {
    assert!(report["warnings"].as_array().is_some_and(Vec::is_empty), "{}", report["warnings"]);
    let missed = report["rays"]["missed"].as_u64();
    assert_eq!(missed, Some(0), "{report}");
}
