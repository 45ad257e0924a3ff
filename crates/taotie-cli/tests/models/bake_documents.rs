//! `taotie bake` onto third-party models that move.

use crate::command::{json, number};
use crate::files::data_files;
use crate::glb::{Glb, assert_same};
use serde_json::{Value, json as value};
use std::path::Path;
use std::process::Command;
use taotie_engine::mesh::Mesh;
use taotie_io::load_model;

/// Adds the missing UVs to the first mesh's first primitive: projected from the side, front and back apart.
fn with_uvs(glb: &mut Glb) {
    let position = glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap();
    let (_, places) = glb.accessors().swap_remove(position as usize);
    let floats: Vec<f32> =
        places.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let uv = |p: &[f32]| {
        let side = if p[1] < 0.0 { 0.0 } else { 0.5 };
        [0.25 + p[0] * 0.24 + side, 0.5 + p[2] * 0.1]
    };
    let uvs: Vec<u8> = floats.chunks_exact(3).flat_map(uv).flat_map(f32::to_le_bytes).collect();
    let count = floats.len() / 3;
    let mut push = |list: &str, item: Value| {
        let items = glb.json[list].as_array_mut().unwrap();
        items.push(item);
        items.len() - 1
    };
    let view = push(
        "bufferViews",
        value!({ "buffer": 0, "byteOffset": glb.bytes.len(), "byteLength": uvs.len(), "target": 34962 }),
    );
    let accessor = push(
        "accessors",
        value!({ "bufferView": view, "componentType": 5126, "count": count, "type": "VEC2" }),
    );
    glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = accessor.into();
    glb.bytes.extend(uvs);
    glb.json["buffers"][0]["byteLength"] = glb.bytes.len().into();
}

#[test]
fn a_skin_and_its_animation_stay() {
    for model in data_files("khronos-gltf-sample-assets/RiggedSimple", &["glb"]) {
        let folder = tempfile::tempdir().unwrap();
        let [low, out] = ["low.glb", "out.glb"].map(|name| folder.path().join(name));
        let mut glb = Glb::read(&std::fs::read(&model).unwrap());
        with_uvs(&mut glb);
        std::fs::write(&low, glb.file()).unwrap();
        let scan = model.to_str().expect("a path of text");
        let report =
            json(&["bake", scan, "--low", "low.glb", "-o", "out.glb", "--size", "64"], folder.path());
        assert!(
            number(&report, "/proof/levels/0/surface_angles/mean") < 1.0,
            "the scan is the low-poly mesh"
        );
        let mut after = Glb::read(&std::fs::read(&out).unwrap());
        // Tangents are written, since no vertex has to be split for them.
        let attributes = &mut after.json["meshes"][0]["primitives"][0]["attributes"];
        attributes.as_object_mut().unwrap().remove("TANGENT");
        assert_same(&glb, &after, &["nodes", "skins", "animations", "meshes", "scenes"]);
        let [mut a, mut b] = [&low, &out].map(|path| load_model(path).unwrap());
        assert_eq!(b.moving, Some("a skin"));
        assert!(b.scene.materials()[0].normal.is_some());
        let (of_a, of_b) = (a.rig.take().unwrap(), b.rig.take().unwrap());
        let bits = |mesh: &Mesh| -> Vec<[u32; 3]> {
            mesh.positions().iter().map(|p| p.to_array().map(f32::to_bits)).collect()
        };
        for seconds in [0.0, 0.7, 2.0] {
            of_a.pose(&mut a.scene, 0, seconds).unwrap();
            of_b.pose(&mut b.scene, 0, seconds).unwrap();
            assert_eq!(bits(&a.scene.meshes()[0]), bits(&b.scene.meshes()[0]), "at {seconds} s");
        }
    }
}

#[test]
fn motion_without_uvs_is_refused() {
    for model in data_files("khronos-gltf-sample-assets/RiggedSimple", &["glb"]) {
        let folder = tempfile::tempdir().unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
            .arg("bake")
            .args([model.as_path(), Path::new("--low"), model.as_path()])
            .args(["-o", "out.glb", "--size", "64"])
            .current_dir(folder.path())
            .output()
            .expect("the command runs");
        let said = String::from_utf8_lossy(&run.stderr);
        let why = "a low-poly mesh with a skin is not supported: parts of it have no uvs, and adding them would break";
        assert!(said.contains(why), "{said}");
        assert_eq!((run.status.code(), std::fs::read_dir(folder.path()).unwrap().count()), (Some(2), 0));
    }
}
