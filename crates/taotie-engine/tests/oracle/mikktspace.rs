//! Tangents compared with those of the MikkTSpace reference, corner by corner.

use crate::common::data_folder;
use serde_json::Value;
use std::path::Path;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::surface::{TangentMethod, Tangented, with_tangents};

#[test]
fn mikktspace_vectors() {
    let Some(folder) = data_folder("mikktspace-vectors") else { return };
    let index: Value = serde_json::from_slice(&std::fs::read(folder.join("index.json")).unwrap()).unwrap();
    let entries = index.as_array().unwrap();
    assert!(!entries.is_empty());
    for entry in entries {
        let file = entry["file"].as_str().unwrap();
        let model = folder.parent().unwrap().join(entry["model"].as_str().unwrap());
        let number = |key: &str| entry[key].as_u64().unwrap() as usize;
        let expected = read_tangents(&folder.join(file));
        let (mesh, uv_set) = read_primitive(&model, number("mesh"), number("primitive"));
        let made = with_tangents(&mesh, uv_set, TangentMethod::MikkTSpace).unwrap();
        assert_eq!(expected.len(), number("corners"), "{file}");
        assert_eq!(corner_tangents(&made).len(), expected.len(), "{file}");
        compare(file, &corner_tangents(&made), &expected);
        keeps_the_mesh(file, &mesh, &made.mesh);
    }
}

fn compare(file: &str, ours: &[[f32; 4]], expected: &[[f32; 4]]) {
    let mut worst = 1.0f64;
    let mut equal = 0;
    for (corner, (a, b)) in ours.iter().zip(expected).enumerate() {
        let wide = |t: &[f32; 4]| Vec3::new(t[0], t[1], t[2]).to_f64();
        let cos = wide(a).dot(wide(b)) / (wide(a).length() * wide(b).length());
        assert!(cos >= 0.9999, "{file}, corner {corner}: {a:?} against {b:?}");
        assert_eq!(a[3], b[3], "{file}, corner {corner}: the sign");
        worst = worst.min(cos);
        equal += usize::from(a == b);
    }
    println!("{file}: {} corners, least cos {worst:.9}, {equal} equal to the bit", ours.len());
}

fn keeps_the_mesh(file: &str, old: &Mesh, new: &Mesh) {
    assert_eq!(old.triangles().len(), new.triangles().len(), "{file}");
    for (a, b) in old.triangles().iter().zip(new.triangles()) {
        for (a, b) in a.iter().zip(b) {
            let (a, b) = (*a as usize, *b as usize);
            assert_eq!(old.positions()[a], new.positions()[b], "{file}");
            assert_eq!(old.normals()[a], new.normals()[b], "{file}");
            assert_eq!(old.uvs()[0][a], new.uvs()[0][b], "{file}");
        }
    }
}

fn corner_tangents(made: &Tangented) -> Vec<[f32; 4]> {
    made.mesh.triangles().iter().flatten().map(|v| made.mesh.tangents()[*v as usize]).collect()
}

fn read_tangents(path: &Path) -> Vec<[f32; 4]> {
    let bytes = std::fs::read(path).unwrap();
    let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    bytes.chunks_exact(16).map(|t| [0, 4, 8, 12].map(|i| number(&t[i..]))).collect()
}

/// Reads the mesh of a primitive, and the UV set of its normal texture.
fn read_primitive(path: &Path, mesh: usize, primitive: usize) -> (Mesh, usize) {
    let bytes = std::fs::read(path).unwrap();
    let gltf::Gltf { document, mut blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let buffers: Vec<Vec<u8>> = document
        .buffers()
        .map(|buffer| match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().unwrap(),
            gltf::buffer::Source::Uri(uri) => std::fs::read(path.with_file_name(uri)).unwrap(),
        })
        .collect();
    let primitive = document.meshes().nth(mesh).unwrap().primitives().nth(primitive).unwrap();
    let uv_set = primitive.material().normal_texture().map_or(0, |t| t.tex_coord());
    let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
    let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from_array).collect();
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..positions.len() as u32).collect(),
    };
    let data = MeshData {
        normals: reader.read_normals().unwrap().map(Vec3::from_array).collect(),
        uvs: vec![reader.read_tex_coords(uv_set).unwrap().into_f32().map(|[u, v]| Vec2::new(u, v)).collect()],
        triangles: indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        positions,
        ..MeshData::default()
    };
    (Mesh::new(data).unwrap(), 0)
}
