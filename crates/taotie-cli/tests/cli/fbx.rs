//! FBX from reading to the proof: its unit is known, and objects find their namesakes.

use super::balls::{Ball, LOW, SCAN};
use super::place::Place;
use serde_json::{Value, json};

/// Returns balls as ASCII FBX with y up, in a unit of `centimetres`.
fn fbx(balls: &[(&str, Ball)], centimetres: f64) -> String {
    let objects: String =
        balls.iter().enumerate().map(|(i, (name, ball))| object(name, ball, 2 * i + 1)).collect();
    let connections =
        (0..balls.len()).map(|i| format!("C: \"OO\",{1},0\nC: \"OO\",{0},{1}\n", 2 * i + 1, 2 * i + 2));
    let connections: String = connections.collect();
    format!(
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {{\nFBXVersion: 7400\n}}\nGlobalSettings: {{\nProperties70: {{\n\
         P: \"UpAxis\", \"int\", \"Integer\", \"\",1\nP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n\
         P: \"FrontAxis\", \"int\", \"Integer\", \"\",2\nP: \"FrontAxisSign\", \"int\", \"Integer\", \"\",1\n\
         P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\nP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n\
         P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{centimetres}\n}}\n}}\n\
         Objects: {{\n{objects}}}\nConnections: {{\n{connections}}}\n"
    )
}

/// Returns a mesh with this number, and a node with the next one.
fn object(name: &str, ball: &Ball, id: usize) -> String {
    let obj = ball.obj();
    let words = |keyword: &str| -> Vec<String> {
        let lines = obj.lines().filter_map(|line| line.strip_prefix(keyword));
        lines.flat_map(|line| line.split(' ')).map(str::to_owned).collect()
    };
    let (positions, uvs, corners) = (words("v "), words("vt "), words("f "));
    let index =
        |corner: &str, part: usize| corner.split('/').nth(part).map(|i| i.parse::<i64>().unwrap() - 1);
    let ended = |(i, corner): (usize, &String)| {
        let vertex = index(corner, 0).unwrap();
        if i % 3 == 2 { -1 - vertex } else { vertex }
    };
    let polygons: Vec<i64> = corners.iter().enumerate().map(ended).collect();
    let places: Vec<i64> = corners.iter().filter_map(|corner| index(corner, 1)).collect();
    let layer = format!(
        "LayerElementUV: 0 {{\nMappingInformationType: \"ByPolygonVertex\"\nReferenceInformationType: \
         \"IndexToDirect\"\nUV: {}\nUVIndex: {}\n}}\n",
        array(&uvs),
        array(&places)
    );
    format!(
        "Geometry: {id}, \"Geometry::\", \"Mesh\" {{\nVertices: {}\nPolygonVertexIndex: {}\n{}}}\n\
         Model: {}, \"Model::{name}\", \"Mesh\" {{\nVersion: 232\n}}\n",
        array(&positions),
        array(&polygons),
        if uvs.is_empty() { "" } else { &layer },
        id + 1
    )
}

fn array(numbers: &[impl ToString]) -> String {
    let all: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    format!("*{} {{\na: {}\n}}", numbers.len(), all.join(","))
}

#[test]
fn scan_and_low_poly_mesh_may_be_in_different_units() {
    let (inner, outer) = (SCAN, Ball { radius: 1.25, ..SCAN });
    let large = |ball: Ball, factor: f64| Ball { radius: ball.radius * factor, ..ball };
    let scan = fbx(&[("core_high", large(inner, 100.0)), ("shell_high", large(outer, 100.0))], 1.0);
    let place = Place::with("scan.fbx", scan);
    let half = |u: f64, v: f64| [u / 2.0, v];
    let other = |u: f64, v: f64| [u / 2.0 + 0.5, v];
    let low = |ball: Ball| Ball { radius: ball.radius, ..LOW };
    let low = [
        ("shell_low", Ball { uv: Some(half), ..low(outer) }),
        ("core_low", Ball { uv: Some(other), ..low(inner) }),
    ];
    place.write("low.fbx", fbx(&low, 100.0));
    let report = place.json("inspect scan.fbx --json");
    assert_eq!((&report["format"], &report["counts"]["triangles"]), (&json!("FBX"), &json!(2 * 9024)));
    let size = report["bounds"]["size"][1].as_f64().unwrap();
    assert!((2.4..2.6).contains(&size), "in metres: {size}");

    let bake = |line: &str| place.json(&format!("bake {line} --low low.fbx -o out.glb --size 128 --json"));
    let report = bake("scan.fbx");
    assert_eq!(
        (&report["proof"]["unit"], &report["origin"]["groups"]),
        (&json!("m"), &json!(["core", "shell"]))
    );
    check(&report);
    let verified = place.json("verify out.glb --scan scan.fbx --json");
    assert_eq!(verified["proof"]["levels"], report["proof"]["levels"]);

    // The low-poly mesh is read in the unit of another scan.
    place.write("scan.obj", large(inner, 1000.0).obj());
    place.write("low.fbx", fbx(&[("ball", LOW)], 100.0));
    let report = bake("scan.obj --unit mm");
    assert_eq!(report["proof"]["unit"], "mm");
    check(&report);
}

fn check(report: &Value) {
    let missed = report["bake"]["missed_texels"].as_f64().unwrap();
    let warnings = report["warnings"].to_string();
    assert!(missed < 0.01 && !warnings.contains("size shows"), "{missed}: {warnings}");
}
