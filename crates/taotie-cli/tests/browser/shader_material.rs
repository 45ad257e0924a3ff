//! The three.js material that `taotie shader` writes draws what the renderer draws.

use crate::empty_folder;
use crate::node::Node;
use crate::same_in_threejs::{materials, orbit, view};
use crate::threejs::{View, by_shader, rendered};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use taotie_engine::image::{Bitmap, Image, Texels};
use taotie_engine::names::Named;
use taotie_engine::render::{EnvironmentLight, RenderSettings};
use taotie_engine::shade::Shading;
use taotie_engine::shade::environment::Environment;
use taotie_engine::surface::{TangentMethod, with_tangents};
use taotie_io::{ExrLayer, GltfAsset, GltfFormat, GltfMaterial, write_exr, write_gltf};
use taotie_study::jue;

/// The largest mean difference of a channel, codes of 255. Measured: 0.026 to 0.044.
const MEAN: f64 = 0.06;

/// The difference within which nearly all pixels are, codes of 255, and the share that may be beyond. Measured with
/// SwiftShader, which interpolates 8-bit texels in 8 bits: 0.0002 to 0.0012.
const NEAR: u8 = 3;
const BEYOND: f64 = 0.0015;

/// A material and a shading model to draw it with.
struct Case<'a> {
    name: &'a str,
    shading: &'a str,
    material: GltfMaterial<'a>,
    /// The environment, if there is one.
    sky: Option<Image>,
}

#[test]
fn the_vessel_is_drawn_by_our_shaders() {
    draw(&["clay", "phong", "bronze-in-the-open"]);
}

#[test]
#[ignore = "takes ten seconds"]
fn the_vessel_in_bronze_is_drawn_by_our_shaders() {
    draw(&["plain", "bronze"]);
}

/// Draws the cases of these names.
fn draw(names: &[&str]) {
    let Some(node) = Node::find() else { return };
    let scene = jue::scene(512);
    let view = view(&scene, &orbit(&scene));
    let mesh = with_tangents(&scene.meshes()[0], 0, TangentMethod::MikkTSpace).unwrap().mesh;
    let normals = in_8_bits(scene.textures()[2].bitmap());
    let [clay, bronze] = materials(&scene).map(|m| GltfMaterial { normal_map: Some((&normals).into()), ..m });
    let plain = GltfMaterial { roughness: 0.4, ..GltfMaterial::default() };
    let cases = [
        Case { name: "plain", shading: "ggx", material: plain, sky: None },
        Case { name: "clay", shading: "ggx", material: clay, sky: None },
        Case { name: "bronze", shading: "ggx", material: bronze, sky: None },
        Case { name: "phong", shading: "blinn-phong", material: clay, sky: None },
        Case { name: "bronze-in-the-open", shading: "ggx", material: bronze, sky: Some(sky()) },
    ];
    for case in cases.into_iter().filter(|case| names.contains(&case.name)) {
        let folder = empty_folder(&format!("shader-material/{}", case.name));
        let levels = [&mesh];
        let asset = GltfAsset { levels: &levels, material: case.material, ..GltfAsset::default() };
        write_gltf(&folder.join("model.glb"), &asset, &GltfFormat::default()).unwrap();
        assert_same(&node, &folder, &view, &case);
    }
}

/// Returns a normal map with the 8 bits that browsers read.
pub fn in_8_bits(map: &Bitmap) -> Bitmap {
    let Texels::U16(texels) = map.texels() else { panic!("the vessel's normals have 16 bits") };
    let codes = texels.iter().map(|texel| texel.map(|v| ((u32::from(v) + 128) / 257) as u8)).collect();
    Bitmap::new(map.width(), map.height(), 3, Texels::U8(codes)).unwrap()
}

/// Returns a sky that is bright above and to one side.
fn sky() -> Image {
    let mut sky = Image::new(64, 32, [0.0, 0.0, 0.0, 1.0]).unwrap();
    for (i, pixel) in sky.pixels_mut().iter_mut().enumerate() {
        let (x, y) = ((i % 64) as f32 / 64.0, (i / 64) as f32 / 32.0);
        *pixel = [1.2 * (1.0 - y) + 0.1, 0.9 * (1.0 - y) + 0.2 * x, 0.5 + 0.5 * x, 1.0];
    }
    sky
}

fn write_sky(path: &Path, sky: &Image) {
    let samples: Vec<f32> = sky.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let layer = ExrLayer { name: "", channels: &["R", "G", "B"], samples: &samples };
    write_exr(path, (sky.width(), sky.height()), &[layer]).unwrap();
}

/// Returns the environment of a case for the renderer.
fn environment(case: &Case<'_>) -> Option<EnvironmentLight> {
    let environment = Arc::new(Environment::new(case.sky.clone()?).unwrap());
    Some(EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false })
}

/// Writes the shader of a folder's only material and returns its name.
fn write_shader(folder: &Path, case: &Case<'_>) -> String {
    let path = folder.join("sky.exr");
    if let Some(sky) = &case.sky {
        write_sky(&path, sky);
    }
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .arg("shader")
        .arg(folder.join("model.glb"))
        .args(["--target", "glsl-es", "--shading", case.shading, "--json", "-o"])
        .arg(folder.join("shaders"))
        .arg("--env")
        .arg(if case.sky.is_some() { path.as_path() } else { Path::new("none") })
        .env("TAOTIE_CACHE_DIR", folder.join("cache"))
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(report["shaders"].as_array().map(Vec::len), Some(1), "{report}");
    report["shaders"][0]["name"].as_str().unwrap().to_owned()
}

fn assert_same(node: &Node, folder: &Path, view: &View, case: &Case<'_>) {
    let name = write_shader(folder, case);
    let shading = Shading::from_name(case.shading).unwrap();
    let theirs = by_shader(node, folder, view, &name);
    let settings = RenderSettings { samples: 1, shading, ..RenderSettings::default() };
    let ours = rendered(folder, view, settings, environment(case));
    let seen = ours.iter().filter(|[r, g, b, _]| r.max(g).max(b) > &0).count();
    assert!(seen > ours.len() / 20, "{}: the vessel is seen", folder.display());
    let apart: Vec<[u8; 3]> =
        theirs.iter().zip(&ours).map(|(a, b)| [0, 1, 2].map(|c| a[c].abs_diff(b[c]))).collect();
    let mean = apart.iter().flatten().map(|d| f64::from(*d)).sum::<f64>() / (3 * apart.len()) as f64;
    let beyond = apart.iter().filter(|d| d.iter().any(|d| *d > NEAR)).count() as f64 / apart.len() as f64;
    println!("{}: mean {mean:.4} codes, {:.4} % beyond {NEAR}", folder.display(), beyond * 100.0);
    assert!(mean <= MEAN && beyond <= BEYOND, "{}: {mean} codes, {beyond} beyond", folder.display());
}
