//! Compressed models, and the errors if they cannot be decompressed.

use super::models::square_json;
use super::place::Place;
use serde_json::json;
use snapbox::str;
use std::path::Path;

fn fixture(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/meshes");
    std::fs::read(folder.join(name)).expect("it is in the repository")
}

#[test]
fn a_required_extension_that_is_not_known() {
    let mut json = square_json();
    json["extensionsRequired"] = json!(["KHR_mesh_origami"]);
    let place = Place::with("a.gltf", json.to_string());
    for command in ["render a.gltf -o b.png", "inspect a.gltf"] {
        place.taotie(command).assert().code(2).stdout_eq("").stderr_eq(str![[r#"
taotie: error: a.gltf: the required extension KHR_mesh_origami is not supported: save the model without it

"#]]);
    }
}

#[test]
fn packed_models_are_drawn_without_a_word() {
    let place = Place::new();
    let names =
        ["patch-meshopt-ext", "patch-meshopt-khr", "patch-draco-sequential", "patch-draco-edgebreaker"];
    for name in names {
        place.write("a.glb", fixture(&format!("{name}.glb")));
        place.taotie("render a.glb -o b.png --size 16x12").assert().success().stderr_eq("");
        assert_eq!(place.json("inspect a.glb --json")["counts"]["triangles"], 106, "{name}");
    }
}

#[test]
fn a_packed_stream_that_is_damaged() {
    let mut bytes = fixture("hill-draco-valence.glb");
    let start = bytes.windows(5).position(|w| w == b"DRACO").expect("it is packed");
    bytes[start] = b'T';
    Place::with("a.glb", bytes).taotie("render a.glb -o b.png").assert().code(2).stderr_eq(str![[r#"
taotie: error: a.glb: mesh 0, primitive 0: POSITION: accessor 1: Draco compression: cannot read the stream (Invalid magic); re-export the model

"#]]);
}
