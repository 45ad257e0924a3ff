//! Materials from photographs of models whose textures are known, taken by the path tracer with known cameras and lights.

use super::accuracy::data_folder;
use super::studio::Noise;
use std::path::{Path, PathBuf};
use taotie_engine::compare::color_difference;
use taotie_engine::image::{Bitmap, Encoding, Image, Sampler, Texels, Texture};
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::math::{Mat4, Vec2, Vec3, poly, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{
    Lighting, Prepared, ReferenceSettings, RenderSettings, Shot, SurfaceSettings, reference,
};
use taotie_engine::scene::{
    Camera, Falloff, Instance, Light, LightKind, Material, Projection, Scene, SceneData, TextureRef,
    UvTransform,
};
use taotie_engine::shade::Shading;
use taotie_engine::{Progress, Warnings};
use taotie_io::{Limits, PngColor, PngImage, PngSamples, write_png, write_text};
use taotie_photometric::{MaterialsEstimate, MaterialsInput, Model, Transfer, Transforms};

/// The full angle of view, radians.
const ANGLE: f64 = 0.5;

/// How photographs are taken.
#[derive(Clone, Copy)]
struct Shooting {
    photographs: usize,
    /// Pixels along a side.
    side: u32,
    spp: u32,
    bounces: u32,
    /// Standard deviation of the noise of a white pixel.
    noise: f64,
    /// The least z of the directions to cameras.
    front: f64,
}

/// Photographs on disk.
struct Photographs {
    _folder: tempfile::TempDir,
    transforms: PathBuf,
}

/// A camera and the direction of its light.
struct Pose {
    camera: Camera,
    light: Vec3<f64>,
}

/// Returns cameras on a sphere around a scene, or on its part with the least z of `front`; the light of each is 6° to 48° from
/// its view.
fn shots(scene: &Scene, count: usize, front: f64) -> Vec<Pose> {
    let bounds = scene.bounds().unwrap();
    let distance = 1.05 * 0.5 * bounds.diagonal() / scalar::sin(0.5 * ANGLE);
    let shot = |k: usize| {
        let z = 0.95 - (0.95 - front) * (k as f64 + 0.5) / count as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), 2.399_963_229_728_653 * k as f64);
        let back = Vec3::new(r * scalar::sin(angle), r * scalar::cos(angle), z);
        let right = Vec3::new(0.0, 1.0, 0.0).cross(back).normalize();
        let up = back.cross(right);
        let tilt = 0.1 + (0.618 * k as f64).fract();
        let aside = right * scalar::cos(4.0 * k as f64) + up * scalar::sin(4.0 * k as f64);
        let camera = Camera {
            name: String::new(),
            world_from_view: Mat4::from_axes(right, up, back, bounds.center() + back * distance),
            projection: Projection::Perspective {
                fov_y: ANGLE,
                aspect: None,
                near: 0.01 * distance,
                far: None,
            },
        };
        Pose { camera, light: (back + aside * tilt).normalize() }
    };
    (0..count).map(shot).collect()
}

/// Takes photographs of a scene from all sides.
fn photograph(scene: &Scene, shooting: Shooting) -> Photographs {
    let prepared = Prepared::new(scene.clone(), &SurfaceSettings::default()).unwrap();
    let shots = shots(scene, shooting.photographs, shooting.front);
    let images: Vec<Image> =
        (0..shots.len()).map(|k| taken(&prepared, &shots[k], k as u32, shooting)).collect();
    let exposure = exposure(&images);
    let folder = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(5);
    let mut frames = Vec::new();
    for (k, (image, shot)) in images.iter().zip(&shots).enumerate() {
        let name = format!("photo_{k:03}");
        let path = folder.path().join(format!("{name}.png"));
        write_photograph(&path, image, (exposure, shooting.noise), &mut noise);
        let column = |j: usize| shot.camera.world_from_view.axis(j).to_array();
        let [x, y, z, o] = [0, 1, 2, 3].map(column);
        let rows: Vec<String> = (0..3).map(|i| format!("[{}, {}, {}, {}]", x[i], y[i], z[i], o[i])).collect();
        let Vec3 { x, y, z } = shot.light;
        frames.push(format!(
            "{{\"file_path\": \"./{name}\", \"transform_matrix\": [{}, [0, 0, 0, 1]], \"light\": {{\"direction\": \
             [{x}, {y}, {z}], \"intensity\": {}}}}}",
            rows.join(", "),
            exposure * IRRADIANCE
        ));
    }
    let transforms = folder.path().join("transforms.json");
    let text = format!("{{\"camera_angle_x\": {ANGLE}, \"frames\": [\n{}\n]}}\n", frames.join(",\n"));
    write_text(&transforms, &text).unwrap();
    Photographs { _folder: folder, transforms }
}

/// The irradiance on a surface that faces the light.
const IRRADIANCE: f64 = 3.0;

fn taken(prepared: &Prepared, shot: &Pose, seed: u32, shooting: Shooting) -> Image {
    let settings = RenderSettings {
        width: shooting.side,
        height: shooting.side,
        shading: Shading::Ggx,
        shadows: true,
        ..RenderSettings::default()
    };
    let kind = LightKind::Directional { direction: -shot.light.to_f32() };
    let color = Vec3::splat(IRRADIANCE as f32);
    let light = Light { name: String::new(), kind, color, falloff: Falloff::None };
    let lighting = Lighting { lights: vec![light], ..Lighting::default() };
    let shot = Shot { camera: &shot.camera, lighting: &lighting, settings: &settings };
    let Shooting { spp, bounces, .. } = shooting;
    let paths = ReferenceSettings { spp, seed, bounces, ..ReferenceSettings::default() };
    reference(prepared, &shot, &paths, Progress::SILENT).unwrap().color
}

/// Returns the factor with which all but the brightest 0.2 % of the pixels are below 0.9.
fn exposure(images: &[Image]) -> f64 {
    let brightest = |pixel: &[f32; 4]| pixel[..3].iter().fold(0.0_f32, |most, v| v.max(most));
    let mut values: Vec<f32> = images.iter().flat_map(|image| image.pixels().iter().map(brightest)).collect();
    values.sort_unstable_by(f32::total_cmp);
    0.9 / f64::from(values[values.len() - 1 - values.len() / 500])
}

fn write_photograph(path: &Path, image: &Image, (exposure, deviation): (f64, f64), noise: &mut Noise) {
    let mut code = |v: f32| {
        let v = f64::from(v) * exposure;
        ((v + deviation * (v + 0.01).sqrt() * noise.normal()).clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16
    };
    let codes: Vec<u16> = image.pixels().iter().flat_map(|p| [code(p[0]), code(p[1]), code(p[2])]).collect();
    let (width, height) = (image.width(), image.height());
    let (color, samples) = (PngColor::Rgb, PngSamples::U16(&codes));
    write_png(path, &PngImage { width, height, color, samples, encoding: Encoding::Linear }).unwrap();
}

/// Returns a wavy sheet with uvs, which faces +z.
fn sheet(cells: u32) -> Mesh {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for (i, j) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j))) {
        let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(cells));
        let [x, y] = [u - 0.5, 0.5 - v];
        let height = 0.03 * scalar::sin(7.0 * x) * scalar::cos(6.0 * y);
        let [p, q] = [
            0.21 * scalar::cos(7.0 * x) * scalar::cos(6.0 * y),
            -0.18 * scalar::sin(7.0 * x) * scalar::sin(6.0 * y),
        ];
        data.positions.push(Vec3::new(x, y, height).to_f32());
        data.normals.push(Vec3::new(-p, -q, 1.0).normalize().to_f32());
        data.uvs[0].push(Vec2::new(u as f32, v as f32));
    }
    for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
        let a = j * (cells + 1) + i;
        let below = a + cells + 1;
        data.triangles.extend([[a, below, below + 1], [a, below + 1, a + 1]]);
    }
    Mesh::new(data).unwrap()
}

/// Returns a vase with uvs.
fn vase(columns: u32, rows: u32) -> Mesh {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for (i, j) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))) {
        let [u, v] = [f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows)];
        let radius = 0.35 + 0.15 * scalar::sin(5.0 * v + 0.4);
        let angle = std::f64::consts::TAU * u;
        let position = Vec3::new(radius * scalar::sin(angle), 0.6 - 1.2 * v, radius * scalar::cos(angle));
        let slope = 0.15 * 5.0 * scalar::cos(5.0 * v + 0.4) / 1.2;
        let normal = Vec3::new(scalar::sin(angle), slope, scalar::cos(angle)).normalize();
        data.positions.push(position.to_f32());
        data.normals.push(normal.to_f32());
        data.uvs[0].push(Vec2::new(u as f32, v as f32));
    }
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let a = j * (columns + 1) + i;
        let below = a + columns + 1;
        data.triangles.extend([[a, below, below + 1], [a, below + 1, a + 1]]);
    }
    Mesh::new(data).unwrap()
}

/// Texels of the bronze: base colour (linear), roughness, metallic.
type Texel = ([f32; 3], f32, f32);

/// Returns a map of rubbed bronze with smooth variations, and bands of matt patina.
fn bronze(side: u32, patina: bool) -> Vec<Texel> {
    let texel = |i: u32| {
        let [u, v] = [i % side, i / side].map(|v| f64::from(v) / f64::from(side));
        let wave =
            |a: f64, b: f64, c: f64| 0.5 + 0.5 * scalar::sin(std::f64::consts::TAU * (a * u + c) + b * v);
        let tarnish = wave(3.0, 9.0, 0.2) * wave(2.0, -7.0, 0.6);
        let color = [0.80 - 0.3 * tarnish, 0.58 - 0.25 * tarnish, 0.38 - 0.2 * tarnish].map(|v| v as f32);
        let roughness = (0.3 + 0.2 * wave(1.0, 11.0, 0.0)) as f32;
        match patina && wave(2.0, 13.0, 0.35) > 0.7 {
            true => ([0.12, 0.25, 0.18], 0.7, 0.0),
            false => (color, roughness, 1.0),
        }
    };
    (0..side * side).map(texel).collect()
}

fn textured(mesh: Mesh, texels: &[Texel]) -> Scene {
    let side = (texels.len() as f64).sqrt() as u32;
    let code = |v: f32| (v * 255.0 + 0.5) as u8;
    let srgb = |v: f32| code(srgb_from_linear(f64::from(v)) as f32);
    let colors =
        texels.iter().map(|(color, ..)| [srgb(color[0]), srgb(color[1]), srgb(color[2]), 255]).collect();
    let others =
        texels.iter().map(|(_, roughness, metallic)| [255, code(*roughness), code(*metallic), 255]).collect();
    let texture = |texels: Vec<[u8; 4]>, encoding| {
        Texture::new(Bitmap::new(side, side, 4, Texels::U8(texels)).unwrap(), encoding)
    };
    let used = |texture| {
        Some(TextureRef {
            texture,
            uv_set: 0,
            sampler: Sampler::default(),
            transform: UvTransform::default(),
        })
    };
    let material = Material {
        name: "bronze".to_owned(),
        base_color: [1.0; 4],
        base_color_texture: used(0),
        metallic: 1.0,
        roughness: 1.0,
        metallic_roughness_texture: used(1),
        ..Material::default()
    };
    Scene::new(SceneData {
        meshes: vec![mesh],
        materials: vec![material],
        textures: vec![texture(colors, Encoding::Srgb), texture(others, Encoding::Linear)],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    })
    .unwrap()
}

/// Returns the scene as a scan without colours: normal maps are kept.
fn bare(scene: &Scene) -> Scene {
    let mut bare = scene.clone();
    bare.edit(|data| {
        for material in &mut data.materials {
            let normal = material.normal;
            *material = Material { name: material.name.clone(), normal, ..Material::default() };
        }
    })
    .unwrap();
    bare
}

/// The error of an estimate over texels that enough photographs show.
#[derive(Debug, Default)]
struct Errors {
    texels: usize,
    roughness: f64,
    delta_e: f64,
    metallic: f64,
    /// The fraction of roughness errors within one and two standard deviations.
    within: [f64; 2],
    /// That of the errors of the base colour.
    color_within: [f64; 2],
}

/// Compares the first material with its true textures.
fn errors(estimate: &MaterialsEstimate, truth: &Scene, fewest: u32) -> Errors {
    let material = &truth.materials()[0];
    let of = &estimate.materials[0];
    let side = of.layout.side;
    let mut errors = Errors::default();
    let read = |used: Option<TextureRef>, [u, v]: [f32; 2]| {
        used.map_or([1.0; 4], |used| {
            let texture = &truth.textures()[used.texture];
            let lod = poly::log2(texture.width() as f32 / side as f32).max(0.0);
            used.sampler.sample(texture, used.transform.apply(Vec2::new(u, v)), lod)
        })
    };
    for (texel, found) in of.layout.texels.iter().zip(&of.texels).filter(|(_, found)| found.samples >= fewest)
    {
        let uv = [texel.index % side, texel.index / side].map(|v| (v as f32 + 0.5) / side as f32);
        let color = read(material.base_color_texture, uv);
        let color: [f32; 3] = std::array::from_fn(|c| color[c] * material.base_color[c]);
        let [_, roughness, metallic, _] = read(material.metallic_roughness_texture, uv);
        let [r, g, b, found_roughness, found_metallic] = found.values;
        errors.texels += 1;
        let off = (found_roughness - roughness * material.roughness).abs();
        errors.roughness += f64::from(off);
        errors.metallic += f64::from((found_metallic - metallic * material.metallic).abs());
        errors.delta_e += color_difference([r, g, b], color);
        for (k, within) in errors.within.iter_mut().enumerate() {
            *within += f64::from(u8::from(off <= (k + 1) as f32 * found.sigma[3]));
            let inside =
                (0..3).filter(|c| (found.values[*c] - color[*c]).abs() <= (k + 1) as f32 * found.sigma[*c]);
            errors.color_within[k] += inside.count() as f64 / 3.0;
        }
    }
    let count = errors.texels as f64;
    [&mut errors.roughness, &mut errors.metallic, &mut errors.delta_e].into_iter().for_each(|v| *v /= count);
    errors.within.iter_mut().chain(&mut errors.color_within).for_each(|v| *v /= count);
    errors
}

fn estimated(photographs: &Photographs, scene: &Scene, side: Option<u32>) -> (MaterialsEstimate, Warnings) {
    let mut warnings = Warnings::default();
    let model = Model::new(scene.clone()).unwrap();
    let transforms = Transforms::open(&photographs.transforms).unwrap();
    let (transfer, limits) = (Transfer::Auto, Limits::default());
    let input = MaterialsInput { model: &model, transforms: &transforms, side, transfer, limits };
    let estimate = MaterialsEstimate::of(&input, &mut warnings, Progress::SILENT).unwrap();
    (estimate, warnings)
}

#[test]
fn a_bronze_is_measured_from_photographs() {
    let truth = textured(sheet(32), &bronze(40, false));
    let shooting = Shooting { photographs: 60, side: 80, spp: 8, bounces: 0, noise: 0.002, front: 0.75 };
    let photographs = photograph(&truth, shooting);
    let (estimate, _) = estimated(&photographs, &bare(&truth), Some(40));
    let found = errors(&estimate, &truth, 4);
    println!("{found:?}");
    assert!(found.texels > 1300, "{found:?}");
    assert!(found.roughness < 0.02 && found.delta_e < 1.0 && found.metallic < 0.05, "{found:?}");
}

/// Masks leave out parts of photographs, and the colours of vertices are part of the measured base colour.
#[test]
fn masks_count_and_colors_of_vertices_are_replaced() {
    let truth = textured(sheet(16), &bronze(16, false));
    let shooting = Shooting { photographs: 12, side: 32, spp: 2, bounces: 0, noise: 0.0, front: 0.75 };
    let photographs = photograph(&truth, shooting);
    let painted = {
        let mut painted = bare(&truth);
        let own = painted.meshes()[0].clone().into_data();
        let colors = vec![[0.5, 0.5, 0.5, 1.0]; own.positions.len()];
        painted.edit(|data| data.meshes[0] = Mesh::new(MeshData { colors, ..own }).unwrap()).unwrap();
        painted
    };
    let (whole, mut warnings) = estimated(&photographs, &painted, Some(16));
    let maps: Vec<_> = whole.materials.iter().map(|of| of.maps().unwrap()).collect();
    let scene = whole.scene(&Model::new(painted.clone()).unwrap(), &maps, &mut warnings).unwrap();
    assert!(scene.meshes().iter().all(|mesh| mesh.colors().is_empty()));
    assert!(warnings.iter().any(|(what, _)| what.contains("vertex colours")));
    // The left half of the first photograph does not count.
    let side = shooting.side as usize;
    let codes: Vec<u8> = (0..side * side).map(|i| if i % side < side / 2 { 0 } else { 255 }).collect();
    let (width, height, samples) = (shooting.side, shooting.side, PngSamples::U8(&codes));
    let mask = PngImage { width, height, color: PngColor::Grey, samples, encoding: Encoding::Srgb };
    write_png(&photographs.transforms.with_file_name("left.png"), &mask).unwrap();
    let text = std::fs::read_to_string(&photographs.transforms).unwrap();
    let masked = text.replacen("{\"file_path\"", "{\"mask_path\": \"left.png\", \"file_path\"", 1);
    write_text(&photographs.transforms, &masked).unwrap();
    let (half, _) = estimated(&photographs, &painted, Some(16));
    let [all, rest] = [&whole, &half].map(|estimate| estimate.photographs[0].texels as f64);
    assert!((0.2..0.5).contains(&(rest / all)), "{rest} of {all} texels");
    assert_eq!(whole.photographs[1].texels, half.photographs[1].texels);
}

/// A vase of bronze with patina, seen from all sides, with all reflections between its parts.
#[test]
#[ignore = "takes a minute"]
fn bronze_with_patina_is_measured_from_photographs_with_interreflections() {
    let truth = textured(vase(96, 96), &bronze(128, true));
    for bounces in [0, 4] {
        let shooting = Shooting { photographs: 120, side: 160, spp: 8, bounces, noise: 0.002, front: -0.95 };
        let photographs = photograph(&truth, shooting);
        let start = std::time::Instant::now();
        let (estimate, _) = estimated(&photographs, &bare(&truth), Some(128));
        let found = errors(&estimate, &truth, 8);
        println!("{bounces} bounces: {found:?}, {:?}", start.elapsed());
        assert!(found.roughness < 0.12 && found.delta_e < 3.5, "{found:?}");
    }
}

/// A bottle of metal and plastic with a normal map; the estimate does not know which part is which.
#[test]
#[ignore = "takes a minute"]
fn a_bottle_of_metal_and_plastic_is_measured_from_photographs() {
    let path = data_folder().join("khronos-gltf-sample-assets/WaterBottle/glTF/WaterBottle.gltf");
    if !path.is_file() {
        return;
    }
    let mut truth = taotie_io::load_model(path).unwrap().scene;
    truth.edit(|data| data.materials.iter_mut().for_each(|material| material.emissive = [0.0; 3])).unwrap();
    for bounces in [0, 4] {
        let shooting = Shooting { photographs: 120, side: 200, spp: 8, bounces, noise: 0.002, front: -0.95 };
        let photographs = photograph(&truth, shooting);
        let start = std::time::Instant::now();
        let (estimate, _) = estimated(&photographs, &bare(&truth), Some(256));
        let found = errors(&estimate, &truth, 8);
        println!("bottle, {bounces} bounces: {found:?}, {:?}", start.elapsed());
        assert!(found.roughness < 0.04 && found.delta_e < 6.0, "{found:?}");
    }
}
