//! A GLB that we wrote looks the same in three.js as here.
#![allow(clippy::print_stdout, reason = "tests say what they found")]

mod browser;
#[allow(dead_code)]
#[path = "../../taotie/tests/common/mod.rs"]
mod common;
mod threejs;
#[path = "../../taotie/tests/common/validator.rs"]
mod validator;

use std::path::Path;
use std::process::Command;
use taotie::compare::{PIXELS_PER_DEGREE, Picture, flip};
use taotie::image::Encoding;
use taotie::io::{
    GltfAsset, GltfFormat, GltfImages, GltfLevel, GltfMaterial, PngColor, PngImage, PngSamples, load_model,
    write_gltf, write_png,
};
use taotie::math::Vec3;
use taotie::scene::{Orbit, fitting_distance};
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
    let mesh = with_tangents(&scene.meshes()[0], 0, TangentMethod::MikkTSpace).unwrap().mesh;
    let [color, orm, normal] = [0, 1, 2].map(|i| scene.textures()[i].bitmap());
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
        if !looks_the_same(name, &path, &view) {
            return;
        }
    }
}

/// Whether there is a browser to look with; fails where the two pictures differ.
fn looks_the_same(name: &str, glb: &Path, view: &View) -> bool {
    let Some(theirs) = threejs::three(glb, view) else { return false };
    let ours = threejs::ours(glb, view);
    keep(&format!("{name}-three"), &theirs);
    keep(&format!("{name}-ours"), &ours);
    let error = flip(&theirs, &ours, PIXELS_PER_DEGREE).unwrap();
    let seen: Vec<bool> = theirs.pixels().iter().map(|pixel| pixel.iter().any(|v| *v > 0.0)).collect();
    let mean = error.within(&seen).unwrap().summary().unwrap().mean;
    println!("{name}: mean FLIP of the object {mean:.4}");
    assert!(mean < 0.05, "{name}: mean FLIP {mean}");
    true
}

/// The pair of a scan and a light mesh of the data.
#[test]
fn what_bake_writes_looks_the_same() {
    let Some(data) = common::data_folder("odedstein-meshes") else { return };
    let folder = tempfile::tempdir().unwrap();
    let glb = folder.path().join("koala.glb");
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .arg("bake")
        .arg(data.join("koala/koala.obj"))
        .arg("--low")
        .arg(data.join("koala/koala_low_resolution.obj"))
        .arg("-o")
        .arg(&glb)
        .args(["--size", "1024", "--maps", "normal,ao", "--ao-rays", "16", "--no-verify"])
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let scene = load_model(&glb).unwrap().scene;
    let bounds = scene.bounds().unwrap();
    let [azimuth, elevation, fov_y] = [24.0f64, 15.0, 26.0].map(f64::to_radians);
    let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: bounds.center(), fov_y };
    orbit.distance = fitting_distance(&orbit, 1.0, 0.9, scene.corners());
    let view = View {
        camera: orbit.camera(bounds.diagonal() / 2.0),
        direction: Vec3::new(-0.5, -0.6, -0.62).normalize(),
        irradiance: 3.0,
        size: [512, 512],
    };
    looks_the_same("baked", &glb, &view);
}
