//! The materials of written assets read back: emission, alpha, layers; and the wrapping of their textures.

use crate::bumpy;
use crate::gltf::triangle;
use taotie_engine::image::{Bitmap, Encoding, Texels, Wrap};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    AlphaMode, Clearcoat, Dispersion, Iridescence, Material, Sheen, Specular, Transmission, Volume,
};
use taotie_io::{GltfAsset, GltfFormat, GltfMaterial, ImageCodec, Loaded, encode_glb, load_model};

fn encoded(mesh: &Mesh, material: GltfMaterial, images: ImageCodec) -> taotie_engine::Result<Vec<u8>> {
    let levels = [mesh];
    let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    encode_glb(&asset, &GltfFormat { images: images.into(), ..GltfFormat::default() })
}

/// Writes a mesh with a material and reads it back.
fn again(mesh: &Mesh, material: GltfMaterial, images: ImageCodec) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.glb");
    std::fs::write(&path, encoded(mesh, material, images).unwrap()).unwrap();
    let loaded = load_model(&path).unwrap_or_else(|e| panic!("{e}"));
    let is_expected = |(what, _): (&str, usize)| what.ends_with("is kept, but not drawn");
    assert!(loaded.warnings.iter().all(is_expected), "{:?}", loaded.warnings);
    loaded
}

/// A leaf: green, and opaque only in the middle.
fn leaf() -> Bitmap {
    let alpha = |i: u8| if (4..12).contains(&(i % 16)) { 200 } else { i / 4 };
    Bitmap::new(16, 16, 4, Texels::U8((0..=255).map(|i| [10, 200, 30, alpha(i)]).collect())).unwrap()
}

#[test]
fn emission_has_its_texture_and_strength() {
    let (mesh, glow) = (bumpy::sphere(12, 6), bumpy::colors(16));
    for (radiance, extension) in
        [([0.5, 0.25, 0.125], &[] as &[&str]), ([4.0, 2.0, 0.0], &["KHR_materials_emissive_strength"])]
    {
        let material = GltfMaterial {
            emissive: radiance,
            emissive_map: Some((&glow).into()),
            ..GltfMaterial::default()
        };
        let loaded = again(&mesh, material, ImageCodec::Png);
        let material = &loaded.scene.materials()[0];
        assert_eq!(material.emissive, radiance);
        let texture = &loaded.scene.textures()[material.emissive_texture.expect("a texture").texture];
        assert_eq!((texture.bitmap(), texture.encoding()), (&glow, Encoding::Srgb));
        assert_eq!(loaded.extensions_used, extension);
        assert_eq!(loaded.texture_names, ["emissive"]);
    }
}

#[test]
fn alpha_is_written_where_it_is_read() {
    let (mesh, leaf) = (bumpy::sphere(12, 6), leaf());
    for alpha in [AlphaMode::Mask(0.3), AlphaMode::Blend, AlphaMode::Opaque] {
        let base_color = [1.0, 1.0, 1.0, 0.75];
        let material =
            GltfMaterial { base_color, base_color_map: Some((&leaf).into()), alpha, ..Default::default() };
        let loaded = again(&mesh, material, ImageCodec::Png);
        let material = &loaded.scene.materials()[0];
        assert_eq!((material.alpha, material.base_color), (alpha, base_color));
        let bitmap = loaded.scene.textures()[0].bitmap();
        match alpha {
            AlphaMode::Opaque => assert_eq!(bitmap.channels(), 3),
            _ => assert_eq!(bitmap, &leaf),
        }
    }
}

#[test]
#[cfg(all(feature = "basis", feature = "webp"))]
fn packed_images_keep_alpha_and_ktx2_leaves_them_to_png() {
    let (mesh, leaf, normal) = (bumpy::sphere(12, 6), leaf(), bumpy::normals(16, 2));
    let material = GltfMaterial {
        base_color_map: Some((&leaf).into()),
        normal_map: Some((&normal).into()),
        alpha: AlphaMode::Blend,
        ..GltfMaterial::default()
    };
    for images in [ImageCodec::WebP, ImageCodec::Ktx2(0)] {
        let loaded = again(&mesh, material, images);
        let color = loaded.scene.materials()[0].base_color_texture.expect("a texture");
        let read = loaded.scene.textures()[color.texture].bitmap();
        let alphas = |bitmap: &Bitmap| (0..256).map(|i| bitmap.stored(i)[3]).collect::<Vec<_>>();
        assert_eq!(alphas(read), alphas(&leaf), "{images:?}");
    }
    let bytes = encoded(&mesh, material, ImageCodec::Ktx2(0)).unwrap();
    let count = |mark: &[u8]| bytes.windows(mark.len()).filter(|window| *window == mark).count();
    assert_eq!((count(b"\xabKTX 20\xbb"), count(b"\x89PNG\r\n\x1a\n")), (1, 1));
}

#[test]
fn layers_are_written_as_factors() {
    let layered = Material {
        ior: 1.25,
        specular: Specular { factor: 0.5, color: [1.0, 0.5, 0.25], ..Specular::default() },
        clearcoat: Some(Clearcoat {
            factor: 0.75,
            factor_texture: None,
            roughness: 0.125,
            roughness_texture: None,
            normal: None,
        }),
        sheen: Some(Sheen {
            color: [0.5, 0.25, 0.0],
            color_texture: None,
            roughness: 0.5,
            roughness_texture: None,
        }),
        transmission: Some(Transmission { factor: 0.75, texture: None }),
        volume: Some(Volume {
            thickness: 2.5,
            attenuation_distance: 4.0,
            attenuation_color: [0.5, 1.0, 0.25],
            ..Volume::default()
        }),
        iridescence: Some(Iridescence { factor: 0.5, ior: 1.75, ..Iridescence::default() }),
        dispersion: Some(Dispersion { factor: 1.5 }),
        ..Material::default()
    };
    let mesh = bumpy::sphere(12, 6);
    let of = |layers: &Material| {
        let material = GltfMaterial { layers: Some(layers), ..GltfMaterial::default() };
        let loaded = again(&mesh, material, ImageCodec::Png);
        (loaded.scene.materials()[0].clone(), loaded.extensions_used)
    };
    let (read, extensions) = of(&layered);
    assert_eq!((read.ior, read.specular), (layered.ior, layered.specular));
    assert_eq!((read.clearcoat, read.sheen), (layered.clearcoat, layered.sheen));
    assert_eq!((read.transmission, read.volume), (layered.transmission, layered.volume));
    assert_eq!((read.iridescence, read.dispersion), (layered.iridescence, layered.dispersion));
    let names =
        ["clearcoat", "dispersion", "ior", "iridescence", "sheen", "specular", "transmission", "volume"]
            .map(|name| format!("KHR_materials_{name}"));
    assert_eq!(extensions, names);
    let (read, extensions) = of(&Material { unlit: true, ..Material::default() });
    assert!(read.unlit);
    assert_eq!(extensions, ["KHR_materials_unlit"]);
    assert_eq!(of(&Material::default()).1, [""; 0], "a plain material needs no extension");
}

#[test]
fn textures_repeat_where_uvs_leave_the_map() {
    let (mesh, color) = (bumpy::sphere(12, 6), bumpy::colors(16));
    let data = mesh.clone().into_data();
    let uvs = vec![data.uvs[0].iter().map(|uv| *uv + *uv).collect()];
    let doubled = Mesh::new(MeshData { uvs, ..data }).unwrap();
    for (mesh, wrap) in [(&mesh, Wrap::Clamp), (&doubled, Wrap::Repeat)] {
        let material = GltfMaterial { base_color_map: Some((&color).into()), ..GltfMaterial::default() };
        let loaded = again(mesh, material, ImageCodec::Png);
        let sampler = loaded.scene.materials()[0].base_color_texture.expect("a texture").sampler;
        assert_eq!((sampler.wrap_u, sampler.wrap_v), (wrap, wrap));
    }
}

#[test]
fn numbers_that_gltf_has_not_are_refused() {
    let mesh = bumpy::sphere(12, 6);
    let cases = [
        (GltfMaterial { emissive: [0.0, -1.0, 0.0], ..Default::default() }, "emission: -1"),
        (GltfMaterial { emissive: [f32::INFINITY; 3], ..Default::default() }, "emission: inf"),
        (GltfMaterial { alpha: AlphaMode::Mask(f32::NAN), ..Default::default() }, "alpha cutoff: NaN"),
    ];
    for (material, why) in cases {
        let error = encoded(&mesh, material, ImageCodec::Png).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}

#[test]
fn what_moves_is_known() {
    let mut maker = triangle();
    maker.floats(&[0.0, 1.0], "SCALAR");
    maker.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], "VEC3");
    maker.accessor(&[0; 12], (3, 5121, "VEC4"), "");
    maker.floats(&[1.0, 0.0, 0.0, 0.0].repeat(3), "VEC4");
    let mesh = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let moving = |rest: &str| maker.load(rest).moving;
    assert_eq!(moving(&format!(r#""nodes":[{{"mesh":0}}],{mesh}"#)), None);
    let bound = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4}}]}]"#;
    let skinned = format!(r#""nodes":[{{"mesh":0,"skin":0}}],"skins":[{{"joints":[0]}}],{bound}"#);
    assert_eq!(moving(&skinned), Some("a skin"));
    let morphed = r#""nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":0}]}]}]"#;
    assert_eq!(moving(morphed), Some("morph targets"));
    let path = r#""target":{"node":0,"path":"translation"}"#;
    let animated = format!(
        r#""nodes":[{{"mesh":0}}],{mesh},
        "animations":[{{"samplers":[{{"input":1,"output":2}}],"channels":[{{"sampler":0,{path}}}]}}]"#
    );
    assert_eq!(moving(&animated), Some("animations"));
}
