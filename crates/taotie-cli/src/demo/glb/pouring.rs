//! The pouring vessel with its skin and animation.

use super::{Buffer, U8, document, material};
use crate::jue::pour;
use anyhow::Result;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use taotie::math::Mat4;
use taotie::mesh::Mesh;
use taotie::scene::Scene;
use taotie::scene::animation::{Node, RigData, Sampler, Transform};

/// Writes `jue-pouring.glb` into `folder`; returns the file.
///
/// # Errors
/// Those of writing.
pub fn write(folder: &Path, scene: &Scene) -> Result<PathBuf> {
    let path = folder.join("jue-pouring.glb");
    let mut buffer = Buffer::default();
    let json = pouring(&mut buffer, &scene.meshes[0]);
    super::write(&path, &json, &buffer)?;
    Ok(path)
}

fn pouring(buffer: &mut Buffer, mesh: &Mesh) -> Value {
    let rig = pour::rig(mesh);
    let data = rig.data();
    let attributes = attributes(buffer, mesh, data);
    let indices = buffer.triangles(mesh);
    let skin = &data.skins[0];
    let binds = skin.inverse_bind_matrices.iter().flat_map(columns);
    let binds = buffer.floats(binds.collect::<Vec<_>>(), "MAT4");
    let animation = animation(buffer, data);
    let mut material = material();
    material["normalTexture"] = json!({ "index": 2 });
    let mut json = document(buffer, &["jue_normal.png"], &material);
    // The joints' nodes come first and the one that shows the mesh last, so that the rig's numbers hold.
    let mut nodes: Vec<Value> = (0..data.nodes.len()).map(|i| node(&data.nodes, i)).collect();
    nodes.push(json!({ "name": "jue", "mesh": 0, "skin": 0 }));
    let primitive = json!({ "attributes": attributes, "indices": indices, "material": 0 });
    json["scenes"] = json!([{ "nodes": [0, nodes.len() - 1] }]);
    json["nodes"] = json!(nodes);
    json["meshes"] = json!([{ "name": "jue", "primitives": [primitive] }]);
    json["skins"] = json!([{ "joints": skin.joints, "inverseBindMatrices": binds }]);
    json["animations"] = json!([animation]);
    json
}

fn attributes(buffer: &mut Buffer, mesh: &Mesh, data: &RigData) -> Value {
    let mut attributes = buffer.vertices(mesh);
    if let Some(binding) = &data.deformed[0].shape.binding {
        // glTF counts joints and weights by fours.
        let fours =
            |i: usize| (0..4).map(move |k| (k < binding.per_vertex).then_some(i * binding.per_vertex + k));
        let places = || (0..mesh.positions().len()).flat_map(fours);
        // Joints that a vertex does not follow are joint 0.
        let followed = |at: &usize| binding.weights[*at] > 0.0;
        let joints: Vec<u8> =
            places().map(|at| at.filter(followed).map_or(0, |at| binding.joints[at] as u8)).collect();
        attributes["JOINTS_0"] = buffer.add(&joints, U8, "VEC4").into();
        let weights = places().map(|at| at.map_or(0.0, |at| binding.weights[at]));
        attributes["WEIGHTS_0"] = buffer.floats(weights.collect::<Vec<_>>(), "VEC4").into();
    }
    attributes
}

fn columns(m: &Mat4) -> [f32; 16] {
    std::array::from_fn(|i| m.columns[i / 4][i % 4] as f32)
}

fn node(nodes: &[Node], index: usize) -> Value {
    let children: Vec<usize> = (0..nodes.len()).filter(|i| nodes[*i].parent == Some(index)).collect();
    let mut node = json!({ "name": if index == 0 { "foot" } else { "cup" } });
    if let Transform::Parts { translation, .. } = nodes[index].local {
        node["translation"] = json!(translation.to_array());
    }
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}

fn animation(buffer: &mut Buffer, data: &RigData) -> Value {
    let animation = &data.animations[0];
    let mut sampler = |sampler: &Sampler| {
        let times: Vec<[f32; 1]> = sampler.times().iter().map(|time| [*time]).collect();
        json!({
            "input": buffer.bounded(&times, "SCALAR"),
            "output": buffer.floats(sampler.values().iter().copied(), "VEC4"),
            "interpolation": "CUBICSPLINE",
        })
    };
    let samplers: Vec<Value> = animation.samplers.iter().map(&mut sampler).collect();
    let channels: Vec<Value> = animation
        .channels
        .iter()
        .map(|c| json!({ "sampler": c.sampler, "target": { "node": c.node, "path": "rotation" } }))
        .collect();
    json!({ "name": animation.name, "channels": channels, "samplers": samplers })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::export;
    use crate::jue;
    use taotie::io;
    use taotie::scene::Material;

    #[test]
    fn the_file_moves_as_the_vessel_does() {
        let folder = tempfile::tempdir().unwrap();
        let scene = jue::scene(64);
        export::write(folder.path(), &scene).unwrap();
        let mut loaded = io::load_model(&write(folder.path(), &scene).unwrap()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let (read, ours) = (&loaded.scene.materials[0], &scene.materials[0]);
        let look = |m: &Material| (m.base_color, m.metallic, m.roughness, m.occlusion_strength);
        assert_eq!(look(read), look(ours));
        assert_eq!(read.normal, ours.normal);
        let rig = loaded.rig.unwrap();
        assert_eq!((rig.animations()[0].name.as_str(), rig.animations()[0].seconds()), ("pour", 2.0));
        let own = pour::rig(&scene.meshes[0]);
        for seconds in [0.0, 0.3, pour::POURED, 1.7] {
            let mut expected = scene.clone();
            own.pose(&mut expected, 0, seconds).unwrap();
            rig.pose(&mut loaded.scene, 0, seconds).unwrap();
            let positions = loaded.scene.corners().zip(expected.corners());
            let farthest = positions.map(|(p, q)| (p - q).length()).fold(0.0, f64::max);
            assert!(farthest < 1e-6, "{farthest} metres at {seconds} seconds");
        }
    }
}
