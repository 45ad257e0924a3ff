//! Geometry that is written packed reads back within its quantisation steps.

use crate::bumpy;
use std::collections::BTreeMap;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_io::{
    CodecSet, GltfAsset, GltfFormat, GltfMaterial, Loaded, encode_glb, load_levels, load_model, write_gltf,
};

fn packed(asset: &GltfAsset, name: &str) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write_gltf(&path, asset, &GltfFormat { meshopt: true, ..GltfFormat::default() }).unwrap();
    let loaded = load_model(&path).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded
}

/// Every vertex used by a triangle, by its position in the lattice of uvs with `cells` cells per side.
fn corners(mesh: &Mesh, cells: f32) -> BTreeMap<[i32; 2], usize> {
    let key = |i: usize| [mesh.uvs()[0][i].x, mesh.uvs()[0][i].y].map(|v| (v * cells).round() as i32);
    mesh.triangles().as_flattened().iter().map(|i| (key(*i as usize), *i as usize)).collect()
}

fn angle(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.to_f64(), b.to_f64());
    libm::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}

fn direction([x, y, z, _]: [f32; 4]) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Positions within half a step, normals within 0.05°, tangents within 0.2°, uvs and colours within half a step.
fn assert_near(read: &Mesh, ours: &Mesh, cells: f32, (place, step): (&Mat4, f64)) {
    let (read_corners, our_corners) = (corners(read, cells), corners(ours, cells));
    assert!(read_corners.keys().eq(our_corners.keys()), "the same corners");
    assert_eq!(read.triangles().len(), ours.triangles().len());
    for (a, b) in read_corners.into_iter().map(|(key, a)| (a, our_corners[&key])) {
        let offset = place.transform_point(read.positions()[a].to_f64()) - ours.positions()[b].to_f64();
        let farthest = offset.to_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        assert!(farthest <= step * 0.501, "{} steps", farthest / step);
        assert!(angle(read.normals()[a], ours.normals()[b]) < 0.05);
        if !ours.tangents().is_empty() {
            let (a, b) = (read.tangents()[a], ours.tangents()[b]);
            assert!(angle(direction(a), direction(b)) < 0.2 && a[3] == b[3]);
        }
        let (p, q) = (read.uvs()[0][a], ours.uvs()[0][b]);
        assert!((p.x - q.x).abs().max((p.y - q.y).abs()) <= 0.501 / 65535.0);
        if !ours.colors().is_empty() {
            let pairs = read.colors()[a].into_iter().zip(ours.colors()[b]);
            assert!(pairs.into_iter().all(|(p, q)| (p - q).abs() <= 0.501 / 65535.0));
        }
    }
}

#[test]
fn packed_meshes_are_within_half_a_step() {
    for (mesh, cells, extent) in [(bumpy::sphere(40, 20), 40.0, 3.0), (bumpy::sheet(300, 300), 299.0, 29.9)] {
        for name in ["m.glb", "m.gltf"] {
            let loaded = packed(&GltfAsset { levels: &[&mesh], ..GltfAsset::default() }, name);
            let place = loaded.scene.instances()[0].world_from_object;
            assert_near(&loaded.scene.meshes()[0], &mesh, cells, (&place, extent / 65535.0));
            assert_eq!(loaded.extensions_required, ["EXT_meshopt_compression", "KHR_mesh_quantization"]);
        }
    }
}

/// The newer extension packs the same numbers into fewer bytes.
#[test]
fn both_extensions_hold_the_same_mesh() {
    let mesh = bumpy::sphere(80, 40);
    let asset = GltfAsset { levels: &[&mesh], ..GltfAsset::default() };
    let folder = tempfile::tempdir().unwrap();
    let [portable, latest] = [CodecSet::Portable, CodecSet::WebLatest].map(|codecs| {
        let bytes =
            encode_glb(&asset, &GltfFormat { meshopt: true, codecs, ..GltfFormat::default() }).unwrap();
        let path = folder.path().join("m.glb");
        std::fs::write(&path, &bytes).unwrap();
        (bytes.len(), load_model(&path).unwrap())
    });
    let [ours, theirs] = [&portable, &latest].map(|(_, loaded)| loaded.scene.meshes()[0].clone().into_data());
    assert_eq!(ours.triangles, theirs.triangles);
    assert_eq!((ours.positions, ours.normals, ours.uvs), (theirs.positions, theirs.normals, theirs.uvs));
    assert_eq!(latest.1.extensions_required, ["KHR_mesh_quantization", "KHR_meshopt_compression"]);
    assert!(latest.0 < portable.0, "{} {}", latest.0, portable.0);
}

#[test]
fn uvs_beyond_the_texture_stay_as_they_are() {
    let mut data = bumpy::sheet(9, 9).into_data();
    data.uvs[0].iter_mut().for_each(|uv| *uv = *uv * 3.0);
    let mesh = Mesh::new(data).unwrap();
    let loaded = packed(&GltfAsset { levels: &[&mesh], ..GltfAsset::default() }, "m.glb");
    let sorted = |mesh: &Mesh| {
        let mut uvs: Vec<_> = mesh.uvs()[0].iter().map(|uv| [uv.x.to_bits(), uv.y.to_bits()]).collect();
        uvs.sort_unstable();
        uvs
    };
    assert_eq!(sorted(&loaded.scene.meshes()[0]), sorted(&mesh));
}

#[test]
fn levels_share_one_place_and_material() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.gltf");
    let meshes = [bumpy::sphere(40, 20), bumpy::sphere(20, 10), bumpy::sphere(10, 5)];
    let color = bumpy::colors(8);
    let material = GltfMaterial { base_color_map: Some((&color).into()), ..GltfMaterial::default() };
    for (meshopt, covered) in [(false, true), (true, true), (true, false)] {
        let levels = meshes.each_ref();
        let coverages: &[f32] = if covered { &[0.5, 0.2, 0.01] } else { &[] };
        let asset = GltfAsset { name: "ball", levels: &levels, coverages, material, ..GltfAsset::default() };
        write_gltf(&path, &asset, &GltfFormat { meshopt, ..GltfFormat::default() }).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(json["nodes"][0]["extensions"]["MSFT_lod"]["ids"], serde_json::json!([1, 2]));
        let written = if covered { serde_json::json!([0.5, 0.2, 0.01]) } else { serde_json::Value::Null };
        assert_eq!(json["nodes"][0]["extras"]["MSFT_screencoverage"], written);
        assert_eq!(json["scenes"][0]["nodes"], serde_json::json!([0]));
        assert_eq!(json["materials"].as_array().unwrap().len(), 1);
        let place =
            |node: usize| (json["nodes"][node]["scale"].clone(), json["nodes"][node]["translation"].clone());
        assert!(place(0) == place(1) && place(1) == place(2));
        let loaded = load_model(&path).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!(loaded.scene.triangle_count(), meshes[0].triangles().len(), "only the finest is drawn");
        assert_eq!(loaded.levels, 3);
        let read = load_levels(&path).unwrap();
        assert_eq!(read.len(), 3);
        let bitmap = |of: &Loaded| std::ptr::from_ref(of.scene.textures()[0].bitmap());
        for (mesh, of) in meshes.iter().zip(&read) {
            let scene = &of.scene;
            assert_eq!((scene.meshes().len(), scene.triangle_count()), (1, mesh.triangles().len()));
            assert_eq!(scene.instances()[0].world_from_object, loaded.scene.instances()[0].world_from_object);
            assert_eq!((scene.textures().len(), bitmap(of)), (1, bitmap(&read[0])), "one map, decoded once");
        }
        let one =
            GltfAsset { levels: &levels[..1], coverages: coverages.get(..1).unwrap_or_default(), ..asset };
        write_gltf(&path, &one, &GltfFormat { meshopt, ..GltfFormat::default() }).unwrap();
        assert!(!std::fs::read_to_string(&path).unwrap().contains("MSFT"));
    }
}
