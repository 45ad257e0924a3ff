//! The same GLB under the same camera and light, drawn by three.js in a browser and by us; with three.js materials,
//! and with our shaders.

use crate::node::Node;
use serde_json::{Value, json};
use std::path::Path;
use taotie_engine::compare::DisplayImage;
use taotie_engine::film::{Development, ToneCurve, develop8};
use taotie_engine::image::Texels;
use taotie_engine::math::Vec3;
use taotie_engine::render::{GrazingNormals, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Orbit, Projection, Scene};
use taotie_engine::shade::Energy;
use taotie_io::{decode_bitmap, load_model, read_bytes};

/// Factor by which three.js draws finer, with pixels averaged: as many samples as ours, each with texels of a
/// sample's size.
const FINER: usize = 4;

/// A camera, a light, and the size of the picture.
pub struct View {
    /// The camera, in perspective.
    pub camera: Camera,
    /// Unit direction in which the light travels, world space.
    pub direction: Vec3,
    /// Its irradiance.
    pub irradiance: f32,
    /// Size of the picture, pixels.
    pub size: [u32; 2],
}

/// Returns three.js's picture of `model.glb` in a folder, on black and without tone curve.
pub fn three(node: &Node, folder: &Path, view: &View) -> DisplayImage {
    averaged(&canvas(node, folder, "three.html", &json_of(view, FINER)), view.size)
}

/// Returns three.js's picture of `model.glb` in a folder, one sample a pixel. The fields of `changes` override those of
/// `view.json`: `shader` is the name of one in the folder `shaders`.
pub fn changed(node: &Node, folder: &Path, view: &View, changes: &Value) -> Vec<[u8; 4]> {
    let mut json = json_of(view, 1);
    for (field, value) in changes.as_object().expect("changes are fields") {
        json[field] = value.clone();
    }
    canvas(node, folder, "three.html", &json)
}

/// Returns model-viewer's picture of `model.glb` in a folder, seen along an orbit, transparent outside the model.
pub fn by_model_viewer(node: &Node, folder: &Path, orbit: &Orbit, size: [u32; 2]) -> Vec<[u8; 4]> {
    let json = json!({ "size": size, "orbit": {
        "fov_deg": orbit.fov_y.to_degrees(),
        "azimuth_deg": orbit.azimuth.to_degrees(),
        "elevation_deg": orbit.elevation.to_degrees(),
        "distance": orbit.distance,
        "target": orbit.target.to_array(),
    } });
    canvas(node, folder, "model-viewer.html", &json)
}

/// Returns the pixels that a page draws.
fn canvas(node: &Node, folder: &Path, page: &str, view: &Value) -> Vec<[u8; 4]> {
    std::fs::write(folder.join("view.json"), view.to_string()).unwrap();
    node.run(&["three.mjs", page], folder);
    let path = folder.join("three.png");
    let bitmap = decode_bitmap(&read_bytes(&path).unwrap(), "three.js", &path).unwrap();
    let Texels::U8(texels) = bitmap.texels() else { panic!("a canvas has 8 bits") };
    texels.clone()
}

/// Returns the view in the format of the pages, `finer` times as large.
fn json_of(view: &View, finer: usize) -> Value {
    let Projection::Perspective { fov_y, near, .. } = view.camera.projection else {
        panic!("the view is in perspective")
    };
    let columns: Vec<f64> = view.camera.world_from_view.columns.iter().flatten().copied().collect();
    let camera =
        json!({ "fov_deg": fov_y.to_degrees(), "near": near, "far": near * 1000.0, "columns": columns });
    let (from, color) = ((view.direction * -1.0).to_array(), [view.irradiance; 3]);
    let light = json!({ "kind": "DirectionalLight", "position": from, "color": color });
    let fine = view.size.map(|side| side as usize * finer);
    json!({ "size": fine, "camera": camera, "lights": [light] })
}

/// Averages squares of pixels, in linear light.
fn averaged(texels: &[[u8; 4]], [width, height]: [u32; 2]) -> DisplayImage {
    let (width, height) = (width as usize, height as usize);
    let mean = |x: usize, y: usize, channel: usize| {
        let at = |i: usize| (y * FINER + i / FINER) * width * FINER + x * FINER + i % FINER;
        let sum: f64 = (0..FINER * FINER).map(|i| linear_from_srgb(texels[at(i)][channel])).sum();
        srgb_from_linear(sum / (FINER * FINER) as f64) as f32
    };
    let pixels = (0..width * height).map(|i| [0, 1, 2].map(|channel| mean(i % width, i / width, channel)));
    DisplayImage::new(width as u32, height as u32, pixels.collect()).unwrap()
}

/// Source: IEC 61966-2-1.
fn linear_from_srgb(code: u8) -> f64 {
    let v = f64::from(code) / 255.0;
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

fn srgb_from_linear(v: f64) -> f64 {
    if v <= 0.0031308 { v * 12.92 } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 }
}

/// Returns our picture of the same view.
pub fn ours(folder: &Path, view: &View) -> DisplayImage {
    let settings = RenderSettings {
        samples: (FINER * FINER) as u32,
        // three.js neither bends normals nor fades light, and follows the light of lamps to its first facet.
        grazing_normals: GrazingNormals::Keep,
        energy: Energy::Single,
        ..RenderSettings::default()
    };
    picture_of(&rendered(&scene_in(folder), view, &lit_by(view), settings), view.size)
}

/// Returns the scene of `model.glb` in a folder.
pub fn scene_in(folder: &Path) -> Scene {
    load_model(folder.join("model.glb")).unwrap().scene
}

/// Returns the light of a view.
pub fn lit_by(view: &View) -> Lighting {
    let kind = LightKind::Directional { direction: view.direction };
    let color = Vec3::splat(view.irradiance);
    Lighting { lights: vec![lamp(kind, color)], ..Lighting::default() }
}

/// Returns a light.
pub fn lamp(kind: LightKind, color: Vec3) -> Light {
    Light { name: String::new(), kind, color, falloff: Falloff::InverseSquare }
}

/// Returns our picture with these settings, on black and without tone curve.
pub fn rendered(scene: &Scene, view: &View, lighting: &Lighting, settings: RenderSettings) -> Vec<[u8; 4]> {
    let [width, height] = view.size;
    let settings = RenderSettings { width, height, ..settings };
    let shot = Shot { camera: &view.camera, lighting, settings: &settings };
    let frame = render(scene, &shot).unwrap();
    let development =
        Development { tone: ToneCurve::Linear, background: Some(Vec3::splat(0.0)), ..Development::default() };
    develop8(&frame.color, &development).unwrap()
}

fn picture_of(texels: &[[u8; 4]], [width, height]: [u32; 2]) -> DisplayImage {
    let pixels: Vec<[u8; 3]> = texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
    DisplayImage::from_8bit(width, height, &pixels).unwrap()
}
