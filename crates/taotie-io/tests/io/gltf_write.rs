//! Models written as glTF read back unchanged.

use crate::bumpy;
use std::path::Path;
use taotie_engine::image::{Bitmap, Encoding, MipFilter, Texels, Wrap};
use taotie_engine::mesh::Mesh;
use taotie_io::{
    GltfAsset, GltfFormat, GltfImage, GltfMaterial, Json, Loaded, encode_glb, load_model, write_gltf,
};

struct Maps {
    color: Bitmap,
    orm: Bitmap,
    normal: Bitmap,
}

impl Maps {
    fn new() -> Self {
        Self { color: bumpy::colors(16), orm: bumpy::orm(8), normal: bumpy::deep_normals(32, 4) }
    }

    fn material(&self) -> GltfMaterial<'_> {
        GltfMaterial {
            name: "clay",
            base_color: [0.9, 0.8, 0.7, 1.0],
            metallic: 0.1,
            roughness: 0.7,
            base_color_map: Some((&self.color).into()),
            metallic_roughness_map: Some((&self.orm).into()),
            occlusion_map: Some((&self.orm).into()),
            occlusion_strength: 0.6,
            normal_map: Some((&self.normal).into()),
            normal_scale: 1.5,
            double_sided: true,
            ..GltfMaterial::default()
        }
    }
}

fn read(path: &Path) -> Loaded {
    let loaded = load_model(path).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded
}

fn assert_same_mesh(read: &Mesh, ours: &Mesh) {
    assert_eq!(read.positions(), ours.positions());
    assert_eq!((read.uvs(), read.triangles()), (ours.uvs(), ours.triangles()));
    assert_eq!((read.colors(), read.tangents().len()), (ours.colors(), ours.tangents().len()));
    // The reader normalises normals and tangents to the last bit.
    let close = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(read.normals().iter().zip(ours.normals()).all(|(a, b)| close(&a.to_array(), &b.to_array())));
    assert!(read.tangents().iter().zip(ours.tangents()).all(|(a, b)| close(a, b)));
}

fn assert_same_material(loaded: &Loaded, maps: &Maps) {
    let material = &loaded.scene.materials()[0];
    assert_eq!(loaded.scene.materials().len(), 1);
    assert_eq!((material.name.as_str(), material.double_sided), ("clay", true));
    assert_eq!(material.base_color, [0.9, 0.8, 0.7, 1.0]);
    assert_eq!((material.metallic, material.roughness, material.occlusion_strength), (0.1, 0.7, 0.6));
    let normal = material.normal.expect("a normal map");
    assert_eq!(normal.scale, 1.5);
    let slots = [
        (material.base_color_texture, &maps.color, Encoding::Srgb),
        (material.metallic_roughness_texture, &maps.orm, Encoding::Linear),
        (material.occlusion_texture, &maps.orm, Encoding::Linear),
        (Some(normal.texture), &maps.normal, Encoding::Normal),
    ];
    assert_eq!(loaded.scene.textures().len(), 3, "the packed texture is written once");
    for (slot, bitmap, encoding) in slots {
        let slot = slot.expect("a texture");
        let texture = &loaded.scene.textures()[slot.texture];
        assert_eq!((texture.bitmap(), texture.encoding()), (bitmap, encoding));
        assert_eq!((slot.sampler.wrap_u, slot.sampler.wrap_v), (Wrap::Clamp, Wrap::Clamp));
        assert_eq!(slot.sampler.mip, MipFilter::Linear);
    }
}

#[test]
fn both_containers_read_back_as_written() {
    let (folder, maps, mesh) = (tempfile::tempdir().unwrap(), Maps::new(), bumpy::sphere(24, 12));
    let levels = [&mesh];
    let extras = Json::parse(r#"{"baked":true}"#).unwrap();
    let packet = r#"{"@context":{"x":"https://x/"},"x:a":1.0,"x:b":{"extras":[2.5]}}"#;
    let xmp = Json::parse(packet).unwrap();
    let asset = GltfAsset {
        name: "ball",
        levels: &levels,
        material: maps.material(),
        copyright: Some("© nobody"),
        xmp: Some(&xmp),
        extras: Some(&extras),
        ..GltfAsset::default()
    };
    for name in ["a ball.glb", "a ball.gltf", "UPPER.GLB"] {
        let path = folder.path().join(name);
        write_gltf(&path, &asset, &GltfFormat::default()).unwrap();
        let loaded = read(&path);
        assert_same_mesh(&loaded.scene.meshes()[0], &mesh);
        assert_same_material(&loaded, &maps);
        assert_eq!(loaded.mesh_names, ["ball"]);
        assert_eq!(loaded.copyright.as_deref(), Some("© nobody"));
        assert_eq!(loaded.generator.as_deref(), Some(concat!("taotie ", env!("CARGO_PKG_VERSION"))));
        assert_eq!(loaded.extensions_used, ["KHR_xmp_json_ld"]);
        assert_eq!(loaded.xmp, std::slice::from_ref(&xmp));
        // A packet is written unchanged.
        assert_eq!(loaded.xmp[0].to_string(), packet);
    }
    let text = std::fs::read_to_string(folder.path().join("a ball.gltf")).unwrap();
    assert!(text.contains(r#""extras":{"baked":true}"#) && text.contains("a%20ball.bin"), "{text}");
    let mut files: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    files.sort();
    let models = ["UPPER.GLB", "a ball.bin", "a ball.glb", "a ball.gltf"];
    let textures = ["a ball_color.png", "a ball_normal.png", "a ball_orm.png"];
    assert_eq!(files, [&models[..], &textures].concat());
    let bytes = encode_glb(&asset, &GltfFormat::default()).unwrap();
    assert!(bytes == std::fs::read(folder.path().join("UPPER.GLB")).unwrap());
}

#[test]
fn indices_are_as_wide_as_they_must_be() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.gltf");
    for (columns, rows, component) in [(255, 257, 5123), (256, 256, 5125)] {
        let mesh = bumpy::sheet(columns, rows);
        let (levels, asset) = ([&mesh], GltfAsset::default());
        write_gltf(&path, &GltfAsset { levels: &levels, ..asset }, &GltfFormat::default()).unwrap();
        assert!(read(&path).scene.meshes()[0].triangles() == mesh.triangles());
        let json: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let accessor = json["meshes"][0]["primitives"][0]["indices"].as_u64().unwrap() as usize;
        assert_eq!(json["accessors"][accessor]["componentType"], component, "{columns}×{rows}");
    }
}

#[test]
fn files_that_are_there_are_named_and_not_written() {
    let (folder, mesh) = (tempfile::tempdir().unwrap(), bumpy::sphere(8, 4));
    let maps = Maps::new();
    let material =
        GltfMaterial { base_color_map: Some(GltfImage::File("its colour.png")), ..Default::default() };
    let levels = [&mesh];
    let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    taotie_io::write_png_bitmap(&folder.path().join("its colour.png"), &maps.color, Encoding::Srgb).unwrap();
    for name in ["m.glb", "m.gltf"] {
        let path = folder.path().join(name);
        write_gltf(&path, &asset, &GltfFormat::default()).unwrap();
        assert_eq!(read(&path).scene.textures()[0].bitmap(), &maps.color);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
}

#[test]
fn what_gltf_cannot_say_is_refused() {
    let (mesh, color) = (bumpy::sphere(8, 4), bumpy::colors(4));
    let mut data = mesh.clone().into_data();
    data.uvs.clear();
    let bare = Mesh::new(data.clone()).unwrap();
    data.triangles.clear();
    let empty = Mesh::new(data).unwrap();
    let float = Bitmap::new(1, 1, 3, Texels::F32(vec![[0.5; 4]])).unwrap();
    let plain = GltfMaterial::default();
    let with = |bitmap| GltfMaterial { base_color_map: Some(bitmap), ..plain };
    let wrong: [(&[&Mesh], GltfMaterial, &str); 6] = [
        (&[], plain, "at least one level"),
        (&[&mesh, &empty], plain, "level 1"),
        (&[&bare], with((&color).into()), "no uvs"),
        (&[&mesh], with((&float).into()), "8 or 16 bits"),
        (&[&mesh], GltfMaterial { roughness: 1.5, ..plain }, "roughness: 1.5"),
        (&[&mesh], GltfMaterial { normal_scale: f32::NAN, ..plain }, "not finite"),
    ];
    for (levels, material, words) in wrong {
        let asset = GltfAsset { levels, material, ..GltfAsset::default() };
        let error = encode_glb(&asset, &GltfFormat::default()).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    }
    let error = write_gltf(Path::new("m.obj"), &GltfAsset::default(), &GltfFormat::default()).unwrap_err();
    assert!(error.to_string().contains(".glb"), "{error}");
}
