//! The Khronos validator finds no errors in the written glTF files.

use crate::{bumpy, rich, validator};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{AlphaMode, Clearcoat, Material};
use taotie_io::{
    CodecSet, GltfAsset, GltfFormat, GltfMaterial, ImageCodec, Provenance, write_gltf, write_scene,
};

/// Messages of the validator for valid files: extensions unknown to it, content used only by them, and attributes
/// that no texture needs.
const KNOWN: [&str; 3] = ["UNSUPPORTED_EXTENSION", "UNUSED_OBJECT", "UNUSED_MESH_TANGENT"];

/// Writes and validates; returns whether the validator was available.
fn check(asset: &GltfAsset, format: &GltfFormat) -> bool {
    let folder = tempfile::tempdir().unwrap();
    ["m.glb", "a m.gltf"].iter().all(|name| {
        let path = folder.path().join(name);
        write_gltf(&path, asset, format).unwrap();
        let Some(infos) = validator::assert_valid(&path) else { return false };
        let unknown: Vec<_> = infos.iter().filter(|i| !KNOWN.iter().any(|k| i.starts_with(k))).collect();
        assert!(unknown.is_empty(), "{unknown:#?}");
        true
    })
}

#[test]
fn every_kind_of_file_is_valid() {
    let maps = (bumpy::colors(16), bumpy::orm(16), bumpy::normals(16, 2), bumpy::deep_normals(16, 2));
    let plain = GltfMaterial {
        name: "clay",
        base_color_map: Some((&maps.0).into()),
        metallic_roughness_map: Some((&maps.1).into()),
        occlusion_map: Some((&maps.1).into()),
        normal_map: Some((&maps.2).into()),
        ..GltfMaterial::default()
    };
    let deep = GltfMaterial { normal_map: Some((&maps.3).into()), ..plain };
    let coat = Clearcoat {
        factor: 0.5,
        factor_texture: None,
        roughness: 0.25,
        roughness_texture: None,
        normal: None,
    };
    let layers = Material { ior: 1.25, clearcoat: Some(coat), ..Material::default() };
    let glowing = GltfMaterial {
        emissive: [4.0, 2.0, 1.0],
        emissive_map: Some((&maps.0).into()),
        alpha: AlphaMode::Mask(0.25),
        layers: Some(&layers),
        ..plain
    };
    let (fine, coarse, large) = (bumpy::sphere(24, 12), bumpy::sphere(12, 6), bumpy::sheet(257, 257));
    let one = [&fine];
    let several = [&fine, &coarse];
    let large = [&large];
    let xmp = Provenance { sources: &[["jug.ply", "00"]], tool: "a tool", parameters: "" }.extend(None);
    let cases: [(&[&Mesh], GltfMaterial); 6] = [
        (&one, GltfMaterial::default()),
        (&one, plain),
        (&one, deep),
        (&one, glowing),
        (&several, plain),
        (&large, GltfMaterial::default()),
    ];
    for (levels, material) in cases {
        let default = GltfFormat::default();
        for format in [
            default,
            GltfFormat { meshopt: true, images: ImageCodec::Jpeg(80).into(), ..default },
            GltfFormat { images: ImageCodec::WebP.into(), ..default },
            GltfFormat { images: ImageCodec::LossyWebP(80).into(), ..default },
            GltfFormat { images: ImageCodec::Ktx2(2).into(), meshopt: true, ..default },
            GltfFormat {
                images: "avif:80/avif:80/avif:80".parse().unwrap(),
                meshopt: true,
                codecs: CodecSet::WebLatest,
                ..default
            },
        ] {
            let asset = GltfAsset {
                name: "ball",
                levels,
                coverages: if levels.len() > 1 { &[0.5, 0.1] } else { &[] },
                material,
                copyright: Some("© nobody"),
                xmp: Some(&xmp),
                ..GltfAsset::default()
            };
            if !check(&asset, &format) {
                return;
            }
        }
    }
}

#[test]
fn a_whole_scene_is_valid() {
    let (folder, scene) = (tempfile::tempdir().unwrap(), rich::scene());
    for (name, meshopt) in [("m.glb", false), ("a m.gltf", false), ("packed.glb", true)] {
        let path = folder.path().join(name);
        let written = write_scene(&path, &scene, &GltfFormat { meshopt, ..GltfFormat::default() }).unwrap();
        assert!(written.warnings.is_empty(), "{:?}", written.warnings);
        let Some(infos) = validator::assert_valid(&path) else { return };
        let unknown: Vec<_> = infos.iter().filter(|i| !KNOWN.iter().any(|k| i.starts_with(k))).collect();
        assert!(unknown.is_empty(), "{unknown:#?}");
    }
}

#[test]
#[should_panic(expected = "ACCESSOR_INDEX_OOB")]
fn a_fault_is_found() {
    let (folder, mesh) = (tempfile::tempdir().unwrap(), bumpy::sheet(5, 5));
    let path = folder.path().join("m.gltf");
    write_gltf(&path, &GltfAsset { levels: &[&mesh], ..GltfAsset::default() }, &GltfFormat::default())
        .unwrap();
    let numbers = folder.path().join("m.bin");
    let mut bytes = std::fs::read(&numbers).unwrap();
    // The last index is at the end; this one refers to vertex 255.
    let end = bytes.len() - 2;
    bytes[end] = 255;
    std::fs::write(&numbers, bytes).unwrap();
    // Without a validator, nothing can be found.
    assert!(validator::assert_valid(&path).is_some(), "skipped: ACCESSOR_INDEX_OOB");
}
