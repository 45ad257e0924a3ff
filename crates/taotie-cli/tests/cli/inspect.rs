//! The output of `taotie inspect`.

use super::models::{Green, TRIANGLE, coated_square, square, square_json, write_ball, write_relief};
use super::place::Place;
use serde_json::json;
use snapbox::str;

fn square_with_relief(green: Green) -> Place {
    let place = Place::with("a.gltf", square());
    write_relief(&place.path("normals.png"), green);
    place
}

#[test]
fn everything_a_model_can_have() {
    let place = square_with_relief(Green::Up);
    place.taotie("inspect a.gltf").assert().success().stderr_eq("").stdout_eq(str![[r#"
model      a.gltf
format     glTF
generator  by hand
copyright  nobody
bounds     0 0 0 to 1 1 0
size       1 × 1 × 0

Counts
  meshes           1
  instances        1
  triangles        2
  triangles drawn  2
  vertices         4
  materials        1
  textures         1
  lights           1
  cameras          2
  animations       0

Bytes
                bytes  GPU bytes
  JSON          1,730
  NORMAL           48         48
  POSITION         48         48
  TANGENT          64         64
  TEXCOORD_0       32         32
  indices          12         12
  normals.png  51,196    196,600
  missing.png       0          0
  all          53,130    196,804

Meshes
  #  name    triangles  zero-area  vertices  uv sets  normals  tangents  colours  material
  0  square          2          0         4        1  flat     yes       no       0

Uv sets
  #  mesh    set  outside [0, 1]  no area  mirrored
  0  square    0           0.0 %        0     0.0 %

Tangents of the file
  #  mesh    not unit  not perpendicular  mixed handedness  against MikkTSpace
  0  square         0                  0                 0  mean 0.00°, max 0.00°, 0 corners of opposite handedness

Materials
  0  stone: base colour 0.5 0.25 0.125 1, metallic 0, roughness 0.75, mask at 0.25, double-sided
      normal  normals.png  192×192  8-bit RGB  linear  uv 0
      normal map by its pixels: tangent-space, green up (97.2 % sure), 0 of 36,864 texels invalid; drawn as tangent-space, green up, scale 0.5

Lights
  0  point  lamp

Cameras
  0  perspective   front
  1  orthographic

Extensions
  KHR_lights_punctual
  EXT_nobody_knows

Missing files
  missing.png

Warnings
  1×  ignored extension EXT_nobody_knows
  1×  skipped image 1: the file 'missing.png' is missing

"#]]);
    assert_eq!(place.files(), ["a.gltf", "normals.png"]);
}

#[test]
fn layers_of_a_material() {
    let place = Place::with("a.gltf", coated_square());
    write_relief(&place.path("normals.png"), Green::Up);
    place.taotie("inspect a.gltf").assert().success().stdout_eq(str![[r#"
...
  0  stone: base colour 0.5 0.25 0.125 1, metallic 0, roughness 0.75, mask at 0.25, double-sided, ior 1.25, specular factor 0.5, specular colour 1 0.5 2, clearcoat 0.75 with roughness 0.125 and normal map scale 0.25, anisotropy 0.5 at 90.0°, sheen 0.5 0.25 0 with roughness 0.5, transmission 0.5, volume 2 with attenuation distance 4 with attenuation color 0.5 1 0.25, iridescence 0.75 with ior 1.5 with thickness minimum 100 with thickness maximum 400, dispersion 1.25
      normal            normals.png  192×192  8-bit RGB  linear  uv 0
      specular-color    normals.png  192×192  8-bit RGB  sRGB    uv 0
      clearcoat-normal  normals.png  192×192  8-bit RGB  linear  uv 0
      transmission      normals.png  192×192  8-bit RGB  linear  uv 0
...
"#]]);
}

#[test]
fn a_bare_model() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("inspect a.obj").assert().success().stderr_eq("").stdout_eq(str![[r#"
model   a.obj
format  OBJ
bounds  0 0 0 to 1 1 0
size    1 × 1 × 0

Counts
  meshes           1
  instances        1
  triangles        1
  triangles drawn  1
  vertices         3
  materials        1
  textures         0
  lights           0
  cameras          0
  animations       0

Meshes
  #  name    triangles  zero-area  vertices  uv sets  normals  tangents  colours  material
  0  mesh 0          1          0         3        0  missing  no        no       0

Materials
  0  (no name): base colour 0.6 0.6 0.6 1, metallic 0, roughness 0.6, opaque, double-sided

"#]]);
}

#[test]
fn every_format() {
    let place = Place::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
               endfacet\nendsolid a\n";
    place.write("a.obj", TRIANGLE);
    place.write("a.ply", ply);
    place.write("a.stl", stl);
    place.write("a.gltf", super::models::gltf(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[0, 1, 2]));
    for (file, format) in [("a.obj", "OBJ"), ("a.ply", "PLY"), ("a.stl", "STL"), ("a.gltf", "glTF")] {
        let report = place.json(&format!("inspect {file} --json"));
        assert_eq!(report["format"], format);
        assert_eq!(report["counts"]["triangles"], 1, "{file}");
        assert_eq!(report["counts"]["vertices"], 3, "{file}");
        assert_eq!(report["bounds"]["size"], json!([1.0, 1.0, 0.0]), "{file}");
    }
}

#[test]
fn green_down_is_seen() {
    let place = square_with_relief(Green::Down);
    let report = place.json("inspect a.gltf --json");
    let map = &report["materials"][0]["normal_map"];
    assert_eq!((&map["green"], &map["green_by_pixels"]), (&json!("up"), &json!("down")));
    assert!(map["green_confidence"].as_f64().unwrap() > 0.9, "{map}");
    assert!(report["hints"][0].as_str().unwrap().contains("--green down"), "{report}");
}

#[test]
fn an_object_space_map_is_seen() {
    let place = Place::with("a.gltf", square());
    write_ball(&place.path("normals.png"));
    let report = place.json("inspect a.gltf --json");
    let map = &report["materials"][0]["normal_map"];
    assert_eq!((&map["space"], &map["kind_by_pixels"]), (&json!("tangent"), &json!("object")));
    assert_eq!((&map["green_by_pixels"], &map["invalid_texels"]), (&json!(null), &json!(null)));
    assert!(report["hints"][0].as_str().unwrap().contains("--normal-space object"), "{report}");
}

#[test]
fn faults_of_tangents_are_counted() {
    let place = square_with_relief(Green::Up);
    let mut model = square_json();
    // Positions used as normals lean towards the tangents, which point along x.
    model["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(0);
    place.write("a.gltf", model.to_string());
    let report = place.json("inspect a.gltf --json");
    let mesh = &report["meshes"][0];
    assert!(mesh["tangents"]["not_perpendicular"].as_u64().unwrap() > 0, "{mesh}");
}

#[test]
fn zero_area_triangles_are_counted() {
    let place = Place::with("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
    let report = place.json("inspect a.obj --json");
    assert_eq!(report["meshes"][0]["zero_area_triangles"], 1);
    assert_eq!(report["warnings"][0]["count"], 1, "{report}");
}
