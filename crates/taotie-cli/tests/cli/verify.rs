//! `taotie verify`: compares assets of any kind with their scans.

use crate::balls::{Ball, SCAN};
use crate::place::Place;
use serde_json::{Value, json};

/// Returns the triangles of a hexagonal prism, three corners each.
fn prism() -> Vec<[f32; 3]> {
    let corner = |i: usize, z: f32| {
        let [x, y] =
            [[1.0, 0.0], [0.5, 0.866], [-0.5, 0.866], [-1.0, 0.0], [-0.5, -0.866], [0.5, -0.866]][i % 6];
        [x, y, z]
    };
    let side = |i: usize| {
        let (near, far) = ([corner(i, 0.0), corner(i, 1.0)], [corner(i + 1, 0.0), corner(i + 1, 1.0)]);
        let ends = [[0.0, 0.0, 1.0], near[1], far[1], [0.0; 3], far[0], near[0]];
        [[near[0], far[0], far[1]], [near[0], far[1], near[1]]].concat().into_iter().chain(ends)
    };
    (0..6).flat_map(side).collect()
}

fn stl() -> String {
    let corner = |[x, y, z]: &[f32; 3]| format!("vertex {x} {y} {z}\n");
    let facet = |t: &[[f32; 3]]| {
        let corners: String = t.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid\n{}endsolid\n", prism().chunks(3).map(facet).collect::<String>())
}

/// Writes the prism as glTF with shared vertices, and neither normals nor UVs.
fn write_gltf(place: &Place, name: &str) {
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    let mut vertex = |corner: [f32; 3]| {
        let known = vertices.iter().position(|at| *at == corner);
        known.unwrap_or_else(|| {
            vertices.push(corner);
            vertices.len() - 1
        }) as u16
    };
    let indices: Vec<u16> = prism().into_iter().map(&mut vertex).collect();
    let mut bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let start = bytes.len();
    bytes.extend(vertices.iter().flatten().flat_map(|v| v.to_le_bytes()));
    let document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("{name}.bin") }],
        "bufferViews": [
            { "buffer": 0, "byteLength": start },
            { "buffer": 0, "byteOffset": start, "byteLength": bytes.len() - start },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5123, "count": indices.len(), "type": "SCALAR" },
            { "bufferView": 1, "componentType": 5126, "count": vertices.len(), "type": "VEC3",
              "min": [-1.0, -0.866, 0.0], "max": [1.0, 0.866, 1.0] },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 1 }, "indices": 0 }] }],
        "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "scene": 0,
    });
    place.write(&format!("{name}.gltf"), document.to_string());
    place.write(&format!("{name}.bin"), bytes);
}

fn mean_angle(report: &Value) -> f64 {
    report.pointer("/proof/levels/0/overview/angles/summary/mean").and_then(Value::as_f64).expect("measured")
}

#[test]
fn an_asset_without_normals_and_uvs_is_flat_and_the_scan_is_read_as_asked() {
    let place = Place::with("nut.stl", stl());
    write_gltf(&place, "low");
    let of = |options: &str| place.json(&format!("verify low.gltf --scan nut.stl --json {options}"));
    let flat = of("--flat -o flat.html");
    assert!(mean_angle(&flat) < 0.01, "glTF requires flat normals: {}", mean_angle(&flat));
    assert!(mean_angle(&of("--crease-angle 180")) > 5.0, "a smooth scan is not a nut");
    assert!(flat.pointer("/proof/levels/0/resolution").is_some_and(Value::is_null), "it has no texels");
    assert_eq!(place.files(), ["flat.html", "flat.json", "low.bin", "low.gltf", "nut.stl"]);
    let refused = place.taotie("verify low.gltf --scan nut.stl --flat --crease-angle 30").assert().code(2);
    let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(said.contains("cannot be used with"), "{said}");
}

#[test]
fn a_baked_asset_with_levels_has_the_proof_of_its_bake() {
    let scan = Ball { rings: 24, meridians: 48, waves: 0.01, ..SCAN };
    let place = Place::with("scan.obj", format!("mtllib gone.mtl\n{}", scan.obj()));
    let line = "bake scan.obj -o out.glb --triangles 400 --lods 100 --size 64 --json";
    let baked = place.json(line);
    let verified = place.json("verify out.glb --scan scan.obj --json");
    let warned = verified["warnings"].to_string();
    assert!(warned.contains("gone.mtl"), "warnings of reading the scan are in the report: {warned}");
    assert_eq!(verified.pointer("/proof/levels").and_then(Value::as_array).map(Vec::len), Some(2));
    assert_eq!(verified["proof"].to_string(), baked["proof"].to_string());
}
