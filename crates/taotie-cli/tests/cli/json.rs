//! The documents that `--json` prints, as a program in another language would read them.
//!
//! Adding or removing a field changes the schema: it needs a new number, here and in the command.
#![allow(dead_code)]

use super::models::{Green, coated_square, square, write_relief};
use super::place::Place;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

pub fn parse<T: DeserializeOwned>(line: &str) -> T {
    let place = Place::with("a.gltf", square());
    write_relief(&place.path("normals.png"), Green::Up);
    serde_json::from_value(place.json(line)).expect("the document has this form")
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counted {
    what: String,
    count: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RenderReport {
    schema: u32,
    version: String,
    model: String,
    files: Vec<String>,
    triangles: usize,
    animation: Option<String>,
    times: Vec<f64>,
    size: [u32; 2],
    device: serde_json::Value,
    integrator: Integrator,
    samples: Option<u32>,
    shading: String,
    surface: Option<String>,
    reflection: Reflection,
    material: BTreeMap<String, serde_json::Value>,
    camera: Camera,
    lights: Vec<serde_json::Value>,
    ambient: [f32; 3],
    shadows: bool,
    environment: Option<EnvironmentReport>,
    ground: bool,
    tone: String,
    seconds: BTreeMap<String, f64>,
    warnings: Vec<Counted>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Camera {
    world_from_view_columns: [[f64; 4]; 4],
    projection: BTreeMap<String, serde_json::Value>,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct EnvironmentReport {
    name: String,
    rotate_deg: f64,
    intensity: f64,
    seen: bool,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Reflection {
    energy: String,
    specular_aa: bool,
    grazing_normals: String,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields, tag = "name", rename_all = "lowercase")]
enum Integrator {
    Raster,
    Reference { spp: u32, bounces: u32, seed: u32, normal_mapping: String },
}

#[test]
fn of_render() {
    let report: RenderReport = parse("render a.gltf -o b.png --size 8x6 --samples 1 --json");
    assert_eq!((report.schema, report.version.as_str()), (4, env!("CARGO_PKG_VERSION")));
    assert_eq!((report.model.as_str(), report.files.as_slice()), ("a.gltf", ["b.png".to_owned()].as_slice()));
    assert_eq!((report.triangles, report.size, report.samples), (2, [8, 6], Some(1)));
    assert_eq!(report.integrator, Integrator::Raster);
    let device = serde_json::json!({ "name": "cpu", "requested": "cpu", "reason": null, "shadows": null });
    assert_eq!(report.device, device);
    let reflection =
        Reflection { energy: "compensated".into(), specular_aa: true, grazing_normals: "soften".into() };
    assert_eq!(report.reflection, reflection);
    assert_eq!((report.environment, report.ground), (None, false));
    assert_eq!((report.shading.as_str(), report.surface, report.tone.as_str()), ("ggx", None, "neutral"));
    assert!(["load", "prepare", "render", "write"].iter().all(|stage| report.seconds[*stage] >= 0.0));
    assert!(report.warnings.iter().any(|w| w.what.contains("missing.png") && w.count == 1));
}

#[test]
fn of_render_with_camera_light_and_material() {
    let line = "render a.gltf -o b.png --size 8x6 --json --orbit 0,0,5 --fov-deg 40 --target 1,2,3 --ambient 0.25 \
                --metallic 1 --roughness 0.25 --base-color 0.5 --shadows";
    let report: RenderReport = parse(line);
    let [.., place] = report.camera.world_from_view_columns;
    assert!(place.iter().zip([1.0, 2.0, 8.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{place:?}");
    assert_eq!(report.camera.projection["kind"], "perspective");
    assert!((report.camera.projection["fov_y_deg"].as_f64().unwrap() - 40.0).abs() < 1e-9);
    assert_eq!(
        (report.lights.len(), &report.lights[0]["kind"]),
        (1, &serde_json::json!("point")),
        "the file's lamp"
    );
    assert_eq!((report.ambient, report.shadows), ([0.25; 3], true));
    assert_eq!(
        (&report.material["metallic"], &report.material["roughness"]),
        (&serde_json::json!(1.0), &serde_json::json!(0.25))
    );
    assert_eq!(report.material["base_color"], serde_json::json!([0.5, 0.5, 0.5]));
}

#[test]
fn of_render_by_paths() {
    let line = "render a.gltf -o b.png --size 8x6 --integrator reference --spp 2 --bounces 0 --seed 7 --json";
    let report: RenderReport = parse(line);
    let normal_mapping = "classic".into();
    assert_eq!(report.integrator, Integrator::Reference { spp: 2, bounces: 0, seed: 7, normal_mapping });
    assert_eq!(report.samples, None);
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InspectReport {
    schema: u32,
    version: String,
    model: String,
    format: String,
    generator: Option<String>,
    copyright: Option<String>,
    rights: Option<String>,
    sources: Vec<String>,
    history: Vec<HistoryEvent>,
    counts: Counts,
    sizes: Option<Sizes>,
    bounds: Option<Extent>,
    meshes: Vec<Mesh>,
    materials: Vec<Material>,
    lights: Vec<Named>,
    cameras: Vec<Named>,
    animations: Vec<Animation>,
    variants: Vec<String>,
    missing_files: Vec<String>,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
    warnings: Vec<Counted>,
    hints: Vec<String>,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct HistoryEvent {
    action: String,
    agent: Option<String>,
    when: Option<String>,
    parameters: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Counts {
    meshes: usize,
    instances: usize,
    triangles: usize,
    triangles_drawn: usize,
    vertices: usize,
    materials: usize,
    textures: usize,
    lights: usize,
    cameras: usize,
    animations: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sizes {
    json: u64,
    attributes: Vec<ContentSize>,
    indices: ContentSize,
    images: Vec<ImageSize>,
    animations: u64,
    other: u64,
    gpu_bytes: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContentSize {
    name: String,
    bytes: u64,
    gpu_bytes: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImageSize {
    name: String,
    media_type: String,
    width: u32,
    height: u32,
    bytes: u64,
    gpu_bytes: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Extent {
    min: [f64; 3],
    max: [f64; 3],
    size: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Named {
    name: String,
    kind: String,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Animation {
    name: String,
    seconds: f64,
    channels: usize,
    keyframes: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mesh {
    name: String,
    triangles: usize,
    vertices: usize,
    zero_area_triangles: usize,
    normals: String,
    normals_not_unit: usize,
    colors: bool,
    tangents: Option<Tangents>,
    uv_sets: Vec<Uvs>,
    materials: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tangents {
    not_unit: usize,
    not_perpendicular: usize,
    mixed_handedness: usize,
    mikktspace: Option<Agreement>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Agreement {
    uv_set: usize,
    mean_degrees: f64,
    max_degrees: f64,
    other_handedness: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Uvs {
    outside: f64,
    degenerate: usize,
    mirrored: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Material {
    name: String,
    base_color: [f32; 4],
    metallic: f32,
    roughness: f32,
    f0: Option<[f32; 3]>,
    ior: f32,
    specular: Specular,
    clearcoat: Option<Clearcoat>,
    anisotropy: Option<Anisotropy>,
    sheen: Option<Sheen>,
    transmission: Option<Transmission>,
    volume: Option<Volume>,
    iridescence: Option<Iridescence>,
    dispersion: Option<Dispersion>,
    emissive: [f32; 3],
    alpha_mode: String,
    alpha_cutoff: Option<f32>,
    double_sided: bool,
    unlit: bool,
    occlusion_strength: f32,
    height_scale: Option<f32>,
    classic: Classic,
    textures: Vec<Texture>,
    normal_map: Option<NormalMap>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Specular {
    factor: f32,
    color: [f32; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Clearcoat {
    factor: f32,
    roughness: f32,
    normal_scale: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Transmission {
    factor: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Volume {
    thickness: f32,
    attenuation_distance: f32,
    attenuation_color: [f32; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Iridescence {
    factor: f32,
    ior: f32,
    thickness_minimum: f32,
    thickness_maximum: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Dispersion {
    factor: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Anisotropy {
    strength: f32,
    rotation_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sheen {
    color: [f32; 3],
    roughness: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Classic {
    ambient: Option<[f32; 3]>,
    diffuse: Option<[f32; 3]>,
    specular: Option<[f32; 3]>,
    shininess: Option<f32>,
    slope: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Texture {
    role: String,
    file: String,
    width: u32,
    height: u32,
    bits: u8,
    channels: u8,
    encoding: String,
    uv_set: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalMap {
    scale: f32,
    space: String,
    green: String,
    kind_by_pixels: String,
    green_by_pixels: Option<String>,
    green_confidence: Option<f32>,
    invalid_texels: Option<usize>,
    texels: usize,
}

#[test]
fn of_inspect() {
    let report: InspectReport = parse("inspect a.gltf --json");
    assert_eq!((report.schema, report.format.as_str()), (5, "glTF"));
    assert_eq!((report.generator.as_deref(), report.copyright.as_deref()), (Some("by hand"), Some("nobody")));
    let counts = &report.counts;
    assert_eq!((counts.triangles, counts.triangles_drawn, counts.vertices), (2, 2, 4));
    assert_eq!((counts.textures, counts.lights, counts.cameras), (1, 1, 2));
    assert_eq!(report.bounds.expect("it has triangles").size, [1.0, 1.0, 0.0]);
    assert_eq!(report.missing_files, ["missing.png"]);
    let tangents = report.meshes[0].tangents.as_ref().expect("the file has tangents");
    let mikktspace = tangents.mikktspace.as_ref().expect("there is a normal map");
    assert!(mikktspace.max_degrees < 0.01 && mikktspace.other_handedness == 0);
    let map = report.materials[0].normal_map.as_ref().expect("there is a normal map");
    assert_eq!((map.kind_by_pixels.as_str(), map.green_by_pixels.as_deref()), ("tangent", Some("up")));
    assert_eq!((map.invalid_texels, map.texels), (Some(0), 192 * 192));
}

#[test]
fn of_inspect_with_layers() {
    let place = Place::with("a.gltf", coated_square());
    write_relief(&place.path("normals.png"), Green::Up);
    let report: InspectReport =
        serde_json::from_value(place.json("inspect a.gltf --json")).expect("the document has this form");
    let material = &report.materials[0];
    assert_eq!(
        (material.ior, material.specular.factor, material.specular.color),
        (1.25, 0.5, [1.0, 0.5, 2.0])
    );
    let coat = material.clearcoat.as_ref().expect("it has a coat");
    assert_eq!((coat.factor, coat.roughness, coat.normal_scale), (0.75, 0.125, Some(0.25)));
    let anisotropy = material.anisotropy.as_ref().expect("it is anisotropic");
    assert!((anisotropy.rotation_deg - 90.0).abs() < 1e-4 && anisotropy.strength == 0.5);
    let sheen = material.sheen.as_ref().expect("it has sheen");
    assert_eq!((sheen.color, sheen.roughness), ([0.5, 0.25, 0.0], 0.5));
    let volume = material.volume.as_ref().expect("it has a volume");
    assert_eq!(
        (volume.thickness, volume.attenuation_distance, volume.attenuation_color),
        (2.0, 4.0, [0.5, 1.0, 0.25])
    );
    let film = material.iridescence.as_ref().expect("it has a film");
    assert_eq!(
        (film.factor, film.ior, film.thickness_minimum, film.thickness_maximum),
        (0.75, 1.5, 100.0, 400.0)
    );
    assert_eq!(material.transmission.as_ref().map(|transmission| transmission.factor), Some(0.5));
    assert_eq!(material.dispersion.as_ref().map(|dispersion| dispersion.factor), Some(1.25));
    let roles: Vec<&str> = material.textures.iter().map(|texture| texture.role.as_str()).collect();
    assert_eq!(roles, ["normal", "specular-color", "clearcoat-normal", "transmission"]);
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DiffReport {
    schema: u32,
    version: String,
    a: DiffFile,
    b: DiffFile,
    size: [u32; 2],
    compared_as: String,
    equal: bool,
    left_out: usize,
    metrics: Metrics,
    pixels_per_degree: f64,
    threshold: Option<Threshold>,
    heat: Option<String>,
    warnings: Vec<Counted>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DiffFile {
    path: String,
    bits: u8,
    channels: u8,
    normals: Option<String>,
    transparent: Option<usize>,
    not_unit: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Metrics {
    angle: Option<Spread>,
    flip: Option<Spread>,
    ssim: Option<f64>,
    psnr: Option<f64>,
    rmse: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    pub count: usize,
    pub mean: f64,
    pub median: f64,
    pub quartiles: [f64; 2],
    pub p95: f64,
    pub max: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Threshold {
    metric: String,
    limit: f64,
    exceeded: bool,
}

#[test]
fn of_diff() {
    let normals: DiffReport = parse("diff normals.png normals.png --metric angle --threshold 1 --json");
    assert_eq!((normals.schema, normals.version.as_str()), (1, env!("CARGO_PKG_VERSION")));
    assert_eq!((normals.compared_as.as_str(), normals.equal, normals.size), ("normals", true, [192, 192]));
    assert_eq!((normals.a.normals.as_deref(), normals.a.not_unit), (Some("unit"), Some(0)));
    let angle = normals.metrics.angle.expect("it was asked for");
    assert_eq!((angle.count, angle.mean, angle.max), (192 * 192, 0.0, 0.0));
    assert!(!normals.threshold.expect("there is one").exceeded && normals.metrics.flip.is_none());
    let pictures: DiffReport = parse("diff normals.png normals.png --encoding color --json");
    assert_eq!(
        (pictures.metrics.ssim, pictures.metrics.psnr, pictures.metrics.rmse),
        (Some(1.0), None, Some(0.0))
    );
    assert_eq!((pictures.pixels_per_degree, pictures.b.normals), (67.0, None));
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalsReport {
    schema: u32,
    version: String,
    input: String,
    output: String,
    size: [u32; 2],
    from: String,
    to: String,
    green_in: String,
    green: String,
    bits: u8,
    dither: bool,
    stored: Option<Spread>,
    round_trip: Option<Spread>,
    warnings: Vec<Counted>,
}

#[test]
fn of_normals() {
    let report: NormalsReport = parse("normals normals.png --to object --mesh a.gltf -o b.png --json");
    assert_eq!((report.schema, report.version.as_str()), (1, env!("CARGO_PKG_VERSION")));
    assert_eq!((report.input.as_str(), report.output.as_str()), ("normals.png", "b.png"));
    assert_eq!((report.from.as_str(), report.to.as_str(), report.bits), ("tangent", "object", 16));
    assert_eq!((report.green_in.as_str(), report.green.as_str(), report.dither), ("up", "up", false));
    let (stored, back) =
        (report.stored.expect("there are normals"), report.round_trip.expect("the space changed"));
    assert_eq!((report.size, stored.count, back.count), ([192, 192], 192 * 192, 192 * 192));
    assert!(stored.max < 0.01 && back.max < 0.01);
    assert!(report.warnings.iter().any(|w| w.what.contains("missing.png")));
}
