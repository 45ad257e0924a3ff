//! A GLB that we wrote looks the same in three.js as here.
//!
//! Each case states the mean FLIP of the object that was measured with Chromium 156 and SwiftShader.

use crate::node::Node;
use crate::threejs::{View, by_model_viewer, ours, three};
use crate::{common, empty_folder};
use std::path::Path;
use std::process::Command;
use taotie_engine::compare::{DisplayImage, PIXELS_PER_DEGREE, flip};
use taotie_engine::film::{Development, develop8};
use taotie_engine::image::Encoding;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Orbit, Scene, fitting_distance};
use taotie_engine::surface::{TangentMethod, with_tangents};
use taotie_io::{
    CodecSet, GltfAsset, GltfFormat, GltfMaterial, ImageCodec, PngColor, PngImage, PngSamples, load_model,
    write_gltf, write_png,
};
use taotie_study::jue;

/// How far a FLIP may exceed the measured one, as a factor: other Chromium versions round colours differently.
const SLACK: f64 = 1.05;

/// Returns the orbit from which all models are viewed, at the distance of the vessel.
pub fn orbit(scene: &Scene) -> Orbit {
    let [azimuth, elevation, fov_y] = [24.0f64, 15.0, 26.0].map(f64::to_radians);
    let target = scene.bounds().unwrap().center();
    Orbit { azimuth, elevation, distance: 0.55, target, fov_y }
}

pub fn view(scene: &Scene, orbit: &Orbit) -> View {
    View {
        camera: orbit.camera(scene.bounds().unwrap().diagonal() / 2.0),
        direction: Vec3::new(-0.5, -0.6, -0.62).normalize(),
        irradiance: 3.0,
        size: [512, 512],
    }
}

/// Returns the vessel in clay and in bronze.
pub fn materials(scene: &Scene) -> [GltfMaterial<'_>; 2] {
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
    [clay, bronze]
}

/// A material, how it is stored, and the mean FLIP that was measured.
struct Case<'a> {
    name: &'a str,
    material: GltfMaterial<'a>,
    format: GltfFormat,
    measured: f64,
}

#[test]
fn the_vessel_looks_the_same() {
    let Some(node) = Node::find() else { return };
    let scene = jue::scene(1024);
    let view = view(&scene, &orbit(&scene));
    let mesh = with_tangents(&scene.meshes()[0], 0, TangentMethod::MikkTSpace).unwrap().mesh;
    // Programs that do not know levels of detail show the first.
    let coarse = Mesh::sphere(0.2, 12, 6);
    let [clay, bronze] = materials(&scene);
    let plain = GltfFormat::default();
    let webp = GltfFormat { images: ImageCodec::WebP.into(), ..plain };
    let packed = GltfFormat { images: ImageCodec::Ktx2(0).into(), meshopt: true, ..plain };
    let avif = "avif:90/avif:90/avif:90".parse().unwrap();
    let latest = GltfFormat { images: avif, meshopt: true, codecs: CodecSet::WebLatest, ..plain };
    let cases = [
        Case { name: "clay", material: clay, format: plain, measured: 0.0258 },
        Case { name: "bronze", material: bronze, format: plain, measured: 0.0444 },
        Case { name: "webp", material: clay, format: webp, measured: 0.0257 },
        Case { name: "packed", material: bronze, format: packed, measured: 0.0481 },
        Case { name: "latest", material: bronze, format: latest, measured: 0.0444 },
    ];
    for case in cases {
        let folder = empty_folder(&format!("same-in-threejs/{}", case.name));
        let asset = GltfAsset {
            levels: &[&mesh, &coarse],
            coverages: &[0.1, 0.0],
            material: case.material,
            ..GltfAsset::default()
        };
        write_gltf(&folder.join("model.glb"), &asset, &case.format).unwrap();
        assert_same(&node, &folder, &view, case.measured);
        assert_same_outline(&node, &folder, &orbit(&scene));
    }
}

/// Fails if the outline of a folder's `model.glb` in model-viewer differs from ours by more than a percent of its
/// area; measured 0.6.
fn assert_same_outline(node: &Node, folder: &Path, orbit: &Orbit) {
    let (size, covered) = ([512, 512], |texels: Vec<[u8; 4]>| texels.into_iter().map(|[.., a]| a > 127));
    let theirs = by_model_viewer(node, folder, orbit, size);
    let scene = load_model(folder.join("model.glb")).unwrap().scene;
    let camera = orbit.camera(scene.bounds().unwrap().diagonal() / 2.0);
    let settings = RenderSettings { width: size[0], height: size[1], ..RenderSettings::default() };
    let lighting = Lighting::default();
    let frame = render(&scene, &Shot { camera: &camera, lighting: &lighting, settings: &settings }).unwrap();
    let ours = develop8(&frame.color, &Development::default()).unwrap();
    let (mut differ, mut area) = (0usize, 0usize);
    for (theirs, ours) in covered(theirs).zip(covered(ours)) {
        differ += usize::from(theirs != ours);
        area += usize::from(ours);
    }
    println!("{}: {differ} of {area} pixels differ from model-viewer's outline", folder.display());
    assert!(area > 10_000 && differ * 100 < area, "{}: {differ} of {area} pixels", folder.display());
}

/// Fails if the mean FLIP of the object between the two pictures of a folder's `model.glb` exceeds the `measured` one
/// by more than [`SLACK`].
fn assert_same(node: &Node, folder: &Path, view: &View, measured: f64) {
    let [theirs, ours] = [three(node, folder, view), ours(folder, view)];
    write_picture(&folder.join("three-averaged.png"), &theirs);
    write_picture(&folder.join("ours.png"), &ours);
    let error = flip(&theirs, &ours, PIXELS_PER_DEGREE).unwrap();
    let seen: Vec<bool> = theirs.pixels().iter().map(|pixel| pixel.iter().any(|v| *v > 0.0)).collect();
    let mean = error.within(&seen).unwrap().summary().unwrap().mean;
    println!("{}: mean FLIP of the object {mean:.5}", folder.display());
    assert!(mean < measured * SLACK, "{}: mean FLIP {mean}, once {measured}", folder.display());
}

fn write_picture(path: &Path, picture: &DisplayImage) {
    let bytes: Vec<u8> = picture.pixels().as_flattened().iter().map(|v| (v * 255.0).round() as u8).collect();
    let image = PngImage {
        width: picture.width(),
        height: picture.height(),
        color: PngColor::Rgb,
        samples: PngSamples::U8(&bytes),
        encoding: Encoding::Srgb,
    };
    write_png(path, &image).unwrap();
}

/// A scan and a low-poly mesh from the shared data.
#[test]
fn what_bake_writes_looks_the_same() {
    let Some(data) = common::data_folder("odedstein-meshes") else { return };
    let Some(node) = Node::find() else { return };
    let folder = empty_folder("same-in-threejs/baked");
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .arg("bake")
        .arg(data.join("koala/koala.obj"))
        .arg("--low")
        .arg(data.join("koala/koala_low_resolution.obj"))
        .arg("-o")
        .arg(folder.join("model.glb"))
        .args(["--size", "1024", "--maps", "normal,ao", "--ao-rays", "16", "--no-verify"])
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let scene = load_model(folder.join("model.glb")).unwrap().scene;
    let mut orbit = orbit(&scene);
    orbit.distance = fitting_distance(&orbit, 1.0, 0.9, scene.corners());
    assert_same(&node, &folder, &view(&scene, &orbit), 0.0086);
}
