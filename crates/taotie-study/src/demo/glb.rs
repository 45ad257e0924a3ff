//! The vessel as GLB files, with the texture files written by [`super::export`] next to them: with its relief as
//! geometry, and pouring, with its skin and animation.

use super::{Output, Vessel};
use crate::jue::pour;
use serde_json::{Value, json};
use std::path::PathBuf;
use taotie_engine::Result;
use taotie_engine::math::Mat4;
use taotie_engine::mesh::Mesh;
use taotie_engine::mesh::deform::Binding;
use taotie_engine::scene::animation::{Node, RigData, Sampler, Transform};
use taotie_io::{GltfAsset, GltfDraft, GltfFormat, GltfImage, GltfMaterial, Json};

/// The index of the rig's first node in the file.
const FIRST: usize = 1;

/// Writes `mesh`, the vessel with its relief as geometry, to `jue-high.glb`; returns the file.
///
/// # Errors
/// Those of writing files.
pub fn write_high(output: &Output<'_>, mesh: &Mesh) -> Result<PathBuf> {
    let path = output.folder.join("jue-high.glb");
    draft(mesh, None)?.write_glb_in(output.files, &path)?;
    Ok(path)
}

/// Writes `jue-pouring.glb`, the vessel with its skin and animation; returns the file.
///
/// # Errors
/// Those of writing files.
pub fn write_pouring(output: &Output<'_>, vessel: &Vessel) -> Result<PathBuf> {
    let path = output.folder.join("jue-pouring.glb");
    let mut draft = draft(vessel.mesh(), Some("jue_normal.png"))?;
    let rig = pour::rig(vessel.mesh());
    add_rig(&mut draft, rig.data())?;
    draft.write_glb_in(output.files, &path)?;
    Ok(path)
}

/// Starts a file for the vessel with the texture files of its scene; `normals` is the one for its relief.
fn draft(mesh: &Mesh, normals: Option<&str>) -> Result<GltfDraft> {
    let levels = [mesh];
    let asset =
        GltfAsset { name: "jue", levels: &levels, material: material(normals), ..GltfAsset::default() };
    GltfDraft::new(&asset, &GltfFormat::default())
}

/// Returns the material of the vessel's scene.
fn material(normals: Option<&str>) -> GltfMaterial<'_> {
    let orm = Some(GltfImage::File("jue_orm.png"));
    GltfMaterial {
        name: "excavated bronze",
        metallic: 1.0,
        roughness: 1.0,
        base_color_map: Some(GltfImage::File("jue_color.png")),
        metallic_roughness_map: orm,
        occlusion_map: orm,
        occlusion_strength: 0.7,
        normal_map: normals.map(GltfImage::File),
        ..GltfMaterial::default()
    }
}

/// Attaches the mesh, which is node 0, to the rig, whose nodes come after it.
fn add_rig(draft: &mut GltfDraft, data: &RigData) -> Result<()> {
    let skin = &data.skins[0];
    if let Some(binding) = &data.deformed[0].shape.binding {
        add_binding(draft, binding)?;
    }
    let binds: Vec<[f32; 16]> = skin.inverse_bind_matrices.iter().map(columns).collect();
    let binds = draft.floats(&binds);
    let animation = animation(draft, data);
    draft.put("/nodes/0", "skin", Json::of(&0)?)?;
    for index in 0..data.nodes.len() {
        draft.put("/nodes", "-", Json::of(&node(&data.nodes, index))?)?;
    }
    draft.put("", "scenes", Json::of(&json!([{ "nodes": [FIRST, 0] }]))?)?;
    let joints: Vec<usize> = skin.joints.iter().map(|joint| FIRST + joint).collect();
    let skins = json!([{ "joints": joints, "inverseBindMatrices": binds }]);
    draft.put("", "skins", Json::of(&skins)?)?;
    draft.put("", "animations", Json::of(&[animation])?)
}

/// Adds joints and weights in fours, as glTF requires; unused entries are joint 0.
fn add_binding(draft: &mut GltfDraft, binding: &Binding) -> Result<()> {
    let vertices = binding.weights.len() / binding.per_vertex;
    let followed = |vertex: usize, k: usize| {
        let at = (k < binding.per_vertex).then_some(vertex * binding.per_vertex + k)?;
        (binding.weights[at] > 0.0).then(|| (binding.joints[at] as u8, binding.weights[at]))
    };
    let fours = |vertex: usize| [0, 1, 2, 3].map(|k| followed(vertex, k).unwrap_or_default());
    let joints: Vec<[u8; 4]> = (0..vertices).map(|vertex| fours(vertex).map(|(joint, _)| joint)).collect();
    let weights: Vec<[f32; 4]> =
        (0..vertices).map(|vertex| fours(vertex).map(|(_, weight)| weight)).collect();
    let added = [("JOINTS_0", draft.bytes(&joints)), ("WEIGHTS_0", draft.floats(&weights))];
    for (name, accessor) in added {
        draft.mark_vertices(accessor);
        draft.put("/meshes/0/primitives/0/attributes", name, Json::of(&accessor)?)?;
    }
    Ok(())
}

fn columns(m: &Mat4) -> [f32; 16] {
    std::array::from_fn(|i| m.columns[i / 4][i % 4] as f32)
}

fn node(nodes: &[Node], index: usize) -> Value {
    let below = (0..nodes.len()).filter(|i| nodes[*i].parent == Some(index));
    let children: Vec<usize> = below.map(|i| FIRST + i).collect();
    let mut node = json!({ "name": if index == 0 { "foot" } else { "cup" } });
    if let Transform::Parts { translation, .. } = nodes[index].local {
        node["translation"] = json!(translation.to_array());
    }
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}

fn animation(draft: &mut GltfDraft, data: &RigData) -> Value {
    let animation = &data.animations[0];
    let mut sampler = |sampler: &Sampler| {
        let times: Vec<[f32; 1]> = sampler.times().iter().map(|time| [*time]).collect();
        json!({
            "input": draft.bounded_floats(&times),
            "output": draft.floats(sampler.values().as_chunks::<4>().0),
            "interpolation": "CUBICSPLINE",
        })
    };
    let samplers: Vec<Value> = animation.samplers.iter().map(&mut sampler).collect();
    let channels: Vec<Value> = animation
        .channels
        .iter()
        .map(|c| json!({ "sampler": c.sampler, "target": { "node": FIRST + c.node, "path": "rotation" } }))
        .collect();
    json!({ "name": animation.name, "channels": channels, "samplers": samplers })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::export;
    use crate::jue;
    use taotie_engine::scene::Material;

    #[test]
    fn the_file_contains_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let ours = &jue::displaced_mesh(0.004);
        let written = taotie_io::FileSet::one(|files| {
            let output = Output { files, folder: folder.path(), side: 64 };
            export::write(&output, &Vessel::new(64))?;
            write_high(&output, ours)
        });
        let loaded = taotie_io::load_model(written.unwrap()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let read = &loaded.scene.meshes()[0];
        assert_eq!(read.positions(), ours.positions());
        assert_eq!((read.uvs(), read.triangles()), (ours.uvs(), ours.triangles()));
        // The reader normalises normals to the last bit.
        let mut normals = read.normals().iter().zip(ours.normals());
        assert!(normals.all(|(a, b)| (*a - *b).length() < 1e-6));
        assert!(loaded.scene.materials()[0].normal.is_none());
    }

    #[test]
    fn the_file_moves_as_the_vessel_does() {
        let folder = tempfile::tempdir().unwrap();
        let vessel = Vessel::new(64);
        let scene = vessel.scene();
        let written = taotie_io::FileSet::one(|files| {
            let output = Output { files, folder: folder.path(), side: 64 };
            export::write(&output, &vessel)?;
            write_pouring(&output, &vessel)
        });
        let mut loaded = taotie_io::load_model(written.unwrap()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let (read, ours) = (&loaded.scene.materials()[0], &scene.materials()[0]);
        let look = |m: &Material| (m.base_color, m.metallic, m.roughness, m.occlusion_strength);
        assert_eq!(look(read), look(ours));
        assert_eq!(read.normal, ours.normal);
        let rig = loaded.rig.unwrap();
        assert_eq!((rig.animations()[0].name.as_str(), rig.animations()[0].seconds()), ("pour", 2.0));
        let own = pour::rig(vessel.mesh());
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
