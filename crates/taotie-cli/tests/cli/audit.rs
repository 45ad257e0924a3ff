//! `taotie inspect --audit`.

use super::models::{TRIANGLE, gltf, square_json};
use super::place::Place;
use super::schemas;
use serde::Deserialize;
use serde_json::{Value, json};
use snapbox::str;

/// A square of two triangles in `a.gltf`, whose normal map is missing, and a schema in `s.json`.
fn square_with(schema: &str) -> Place {
    let place = Place::with("a.gltf", square_json().to_string());
    place.write("s.json", schema);
    place
}

const STRICT: &str = r#"{
  "version": "1.0.4",
  "materials": { "maximum": 1 },
  "model": { "triangles": { "maximum": 1 }, "requireManifoldEdges": true },
  "product": { "dimensions": { "height": { "maximum": 1, "percentTolerance": 2 } } },
  "uvs": { "requireNotInverted": true, "requireRangeZeroToOne": true }
}"#;

#[test]
fn a_failed_check_is_exit_code_1() {
    let place = square_with(STRICT);
    place.taotie("inspect a.gltf --audit s.json").assert().code(1).stderr_eq("").stdout_eq(str![[r#"
model   a.gltf
schema  s.json, version 1.0.4
result  1 failed, 5 passed, 20 not tested

Checks
  not tested  gltf validator          not part of a schema; run the Khronos glTF validator
  not tested  file size               2 KiB
  fail        triangle count          2 (at most 1)
  pass        material count          1 (at most 1)
  not tested  node count              4
  not tested  mesh count              1
  not tested  primitive count         1
  not tested  clean root transform    root nodes neither move, rotate nor scale
  not tested  beveled edges           not required
  pass        manifold edges          0 edges of more than two faces (at most 0), 4 edges open
  pass        overall dimensions      length 1 m, width 0 m, height 1 m (at most 1)
  not tested  product dimensions      no product info given
  not tested  pbr color maximum       no base colour textures
  not tested  pbr color minimum       no base colour textures
  not tested  texture height maximum  no textures
  not tested  texture height minimum  no textures
  not tested  texture width maximum   no textures
  not tested  texture width minimum   no textures
  not tested  power of two textures   no textures
  not tested  square textures         no textures
  not tested  texel density maximum   no textured triangles
  not tested  texel density minimum   no textured triangles
  pass        uv range                u 0 to 1, v 0 to 1 (0 to 1)
  pass        inverted uvs            0 triangles mirrored in uv (at most 0)
  not tested  overlapping uvs         not required
  not tested  gutter width            not required

Warnings
  1×  ignored extension EXT_nobody_knows
  1×  skipped image 0: the file 'normals.png' is missing
  1×  skipped image 1: the file 'missing.png' is missing

"#]]);
    place.write(
        "s.json",
        STRICT.replace(r#""triangles": { "maximum": 1 }"#, r#""triangles": { "maximum": 2 }"#),
    );
    place.taotie("inspect a.gltf --audit s.json").assert().code(0);
    assert_eq!(place.files(), ["a.gltf", "s.json"]);
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Report {
    schema: u32,
    version: String,
    model: String,
    audit_schema: String,
    schema_version: String,
    passed: bool,
    checks: Vec<Check>,
    warnings: Vec<Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Check {
    name: String,
    status: String,
    message: String,
    value: Option<f64>,
    minimum: Option<f64>,
    maximum: Option<f64>,
}

fn report(place: &Place, line: &str, code: i32) -> Report {
    let assert = place.taotie(line).assert().code(code).stderr_eq("");
    let document = serde_json::from_slice(&assert.get_output().stdout).expect("stdout is one JSON document");
    schemas::check("inspect-audit", &document);
    serde_json::from_value(document).expect("the document has this form")
}

#[test]
fn json_has_every_check() {
    let place = square_with(STRICT);
    let report = report(&place, "inspect a.gltf --audit s.json --json", 1);
    assert_eq!((report.schema, report.version.as_str()), (1, env!("CARGO_PKG_VERSION")));
    assert_eq!((report.model.as_str(), report.audit_schema.as_str()), ("a.gltf", "s.json"));
    assert_eq!((report.schema_version.as_str(), report.passed), ("1.0.4", false));
    assert_eq!((report.checks.len(), report.warnings.len()), (26, 3));
    let failed: Vec<&Check> = report.checks.iter().filter(|check| check.status == "fail").collect();
    let [Check { name, message, value, minimum, maximum, .. }] = failed.as_slice() else {
        panic!("{} checks failed", failed.len())
    };
    assert_eq!((name.as_str(), message.as_str()), ("triangle-count", "2 (at most 1)"));
    assert_eq!((*value, *minimum, *maximum), (Some(2.0), None, Some(1.0)));
}

/// Nodes, meshes and materials count though the scene does not show them; a triangle strip has two triangles less
/// than corners; points have none.
#[test]
fn the_document_is_counted_whole() {
    let place = Place::new();
    let mut model: Value = serde_json::from_str(&gltf(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        &[0, 1, 2, 2, 1, 3],
    ))
    .unwrap();
    let primitive = model["meshes"][0]["primitives"][0].clone();
    let with_mode = |mode: u32| {
        let mut primitive = primitive.clone();
        primitive["mode"] = json!(mode);
        primitive
    };
    model["meshes"] = json!([{ "primitives": [primitive] }, { "primitives": [with_mode(5), with_mode(0)] }]);
    model["materials"] = json!([{}, {}, {}]);
    model["nodes"] = json!([{ "children": [1], "name": "top", "translation": [0, 1, 0] }, { "mesh": 0 }, { "mesh": 1 }, {}]);
    place.write("a.gltf", model.to_string());
    place.write("s.json", r#"{ "version": "1", "model": { "requireCleanRootNodeTransform": true } }"#);
    let report = report(&place, "inspect a.gltf --audit s.json --json", 1);
    let of = |name: &str| report.checks.iter().find(|check| check.name == name).unwrap();
    let value = |name: &str| of(name).value.unwrap();
    assert_eq!(value("triangle-count"), 6.0);
    assert_eq!(value("material-count"), 3.0);
    assert_eq!(value("node-count"), 4.0);
    assert_eq!(value("mesh-count"), 2.0);
    assert_eq!(value("primitive-count"), 3.0);
    assert_eq!(of("clean-root-transform").status, "fail");
    assert_eq!(of("clean-root-transform").message, "'top' moves by 0 1 0");
}

/// The files that a model names count with it.
#[test]
fn the_file_size_is_that_of_all_files() {
    let place = Place::with("a.obj", format!("mtllib a.mtl\n{TRIANGLE}"));
    place.write("a.mtl", format!("# {}\nnewmtl a\n", "x".repeat(100 << 10)));
    place.write("s.json", r#"{ "version": "1", "fileSizeInKb": { "maximum": 99 } }"#);
    place.taotie("inspect a.obj --audit s.json").assert().code(1).stdout_eq(str![[r#"
...
  fail        file size               100 KiB (at most 99)
...
"#]]);
}

#[test]
fn products_are_compared() {
    let place = square_with(STRICT);
    place.write("s.json", STRICT.replace(r#""maximum": 1 }"#, r#""maximum": 9 }"#));
    let line = "inspect a.gltf --audit s.json --product-info p.json";
    place.write("p.json", r#"{ "dimensions": { "height": 1.01 } }"#);
    place.taotie(line).assert().code(0);
    place.write("p.json", r#"{ "dimensions": { "height": 1.1 } }"#);
    place.taotie(line).assert().code(1).stdout_eq(str![[r#"
...
  fail        product dimensions      height 1 m (1.1 m ± 2 %)
...
"#]]);
}

#[test]
fn wrong_schemas_are_exit_code_2() {
    let place = square_with(r#"{ "version": "1", "uvs": { "requireInverted": true } }"#);
    place.taotie("inspect a.gltf --audit s.json").assert().code(2).stdout_eq("").stderr_eq(str![[r#"
taotie: error: s.json: line 1, column 44: unknown field `requireInverted`, expected one of `gutterWidth`, `pixelsPerMeter`, `requireNotInverted`, `requireNotOverlapping`, `requireRangeZeroToOne`

"#]]);
    place.taotie("inspect a.gltf --audit none.json").assert().code(2).stdout_eq("");
    place.taotie("inspect a.gltf --product-info p.json").assert().code(2).stdout_eq("");
    place.write("s.json", STRICT);
    place.write("p.json", "{}");
    place.taotie("inspect a.gltf --audit s.json --product-info p.json").assert().code(2).stdout_eq("");
}

/// The schema in `docs/audit.md` is one that is read, and turns on what it names.
#[test]
fn the_documented_schema_is_read() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/audit.md");
    let page = std::fs::read_to_string(page).expect("the page is there");
    let schema = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next());
    let place = square_with(schema.expect("the page has a schema"));
    let report = report(&place, "inspect a.gltf --audit s.json --json", 0);
    let tested = report.checks.iter().filter(|check| check.status == "pass").count();
    assert_eq!(tested, 9);
}
