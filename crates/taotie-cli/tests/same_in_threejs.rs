//! A GLB that we wrote looks the same in three.js as here.
#![allow(clippy::print_stdout, reason = "tests say what they found")]

mod browser;
mod threejs;
#[path = "../../taotie/tests/common/validator.rs"]
mod validator;

use std::path::Path;
use taotie::compare::{PIXELS_PER_DEGREE, Picture, flip};
use taotie::image::Encoding;
use taotie::io::{
    GltfAsset, GltfFormat, GltfImages, GltfLevel, GltfMaterial, PngColor, PngImage, PngSamples, write_gltf,
    write_png,
};
use taotie::math::Vec3;
use taotie::scene::Orbit;
use taotie::surface::{TangentMethod, with_tangents};
use taotie_cli::jue;
use threejs::View;

/// Keeps the pictures where somebody wants to look at them.
fn keep(name: &str, picture: &Picture) {
    let Some(folder) = std::env::var_os("TAOTIE_KEEP") else { return };
    let bytes: Vec<u8> = picture.pixels().as_flattened().iter().map(|v| (v * 255.0).round() as u8).collect();
    let image = PngImage {
        width: picture.width(),
        height: picture.height(),
        color: PngColor::Rgb,
        samples: PngSamples::U8(&bytes),
        encoding: Encoding::Srgb,
    };
    write_png(&Path::new(&folder).join(format!("{name}.png")), &image).unwrap();
}

#[test]
fn the_vessel_looks_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let scene = jue::scene(1024);
    let bounds = scene.bounds().unwrap();
    let [azimuth, elevation, fov_y] = [24.0f64, 15.0, 26.0].map(f64::to_radians);
    let orbit = Orbit { azimuth, elevation, distance: 0.55, target: bounds.center(), fov_y };
    let view = View {
        camera: orbit.camera(bounds.diagonal() / 2.0),
        direction: Vec3::new(-0.5, -0.6, -0.62).normalize(),
        irradiance: 3.0,
        size: [512, 512],
    };
    let mesh = with_tangents(&scene.meshes[0], 0, TangentMethod::MikkTSpace).unwrap().mesh;
    let [color, orm, normal] = [0, 1, 2].map(|i| scene.textures[i].bitmap());
    let clay = GltfMaterial {
        roughness: 0.5,
        base_color_map: Some(color.into()),
        normal_map: Some(normal.into()),
        ..GltfMaterial::default()
    };
    let bronze = GltfMaterial {
        metallic: 1.0,
        roughness: 1.0,
        metallic_roughness_map: Some(orm.into()),
        occlusion_map: Some(orm.into()),
        ..clay
    };
    let plain = GltfFormat::default();
    let cases = [
        ("clay", clay, plain),
        ("bronze", bronze, plain),
        ("webp", clay, GltfFormat { images: GltfImages::WebP, ..plain }),
        ("packed", bronze, GltfFormat { images: GltfImages::Ktx2, meshopt: true }),
    ];
    for (name, material, format) in cases {
        let path = folder.path().join(format!("{name}.glb"));
        let levels = [GltfLevel { mesh: &mesh, coverage: None }];
        let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
        write_gltf(&path, &asset, &format).unwrap();
        let Some(theirs) = threejs::three(&path, &view) else { return };
        let ours = threejs::ours(&path, &view);
        keep(&format!("{name}-three"), &theirs);
        keep(&format!("{name}-ours"), &ours);
        let error = flip(&theirs, &ours, PIXELS_PER_DEGREE).unwrap();
        let seen: Vec<bool> = theirs.pixels().iter().map(|pixel| pixel.iter().any(|v| *v > 0.0)).collect();
        let mean = error.within(&seen).unwrap().summary().unwrap().mean;
        println!("{name}: mean FLIP of the object {mean:.4}");
        assert!(mean < 0.05, "{name}: mean FLIP {mean}");
    }
}
