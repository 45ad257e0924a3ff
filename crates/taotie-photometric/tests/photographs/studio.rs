//! Photographs with known normals: the engine's path tracer renders a model under one light at a time, with shadows
//! and interreflections; noise and rounding are added. Nothing of the estimators is used.

use std::path::{Path, PathBuf};
use taotie_engine::Progress;
use taotie_engine::image::{Encoding, Image};
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{
    Frame, Lighting, Prepared, ReferenceSettings, RenderSettings, Shot, SurfaceSettings, reference, render,
};
use taotie_engine::scene::{
    Camera, Falloff, Instance, Light, LightKind, Material, Orbit, Projection, Scene, SceneData,
};
use taotie_engine::shade::Shading;
use taotie_io::{PngColor, PngImage, PngSamples, write_png, write_text};

/// Pixels of the truth for each pixel of a photograph, along a side.
const FINER: u32 = 4;

/// A surface to photograph.
pub struct Finish {
    pub shading: Shading,
    pub material: Material,
}

impl Finish {
    /// Returns a Lambertian surface.
    pub fn matt(albedo: f32) -> Self {
        let material = Material { base_color: [albedo, albedo, albedo, 1.0], ..Material::default() };
        Self { shading: Shading::Lambert, material }
    }

    /// Returns a dielectric with a highlight.
    pub fn satin(albedo: f32, roughness: f32) -> Self {
        let base_color = [albedo, albedo, albedo, 1.0];
        let material = Material { base_color, roughness, metallic: 0.0, ..Material::default() };
        Self { shading: Shading::Ggx, material }
    }
}

/// How photographs are taken.
#[derive(Clone, Copy)]
pub struct Shooting {
    /// Pixels along a side.
    pub side: u32,
    pub lights: usize,
    /// The lowest light, degrees from the view.
    pub lowest_deg: f64,
    /// Standard deviation of the noise of a white pixel; that of others follows the square root of their brightness.
    pub noise: f64,
    /// Bits of the files: 16 linear, or 8 in sRGB.
    pub bits: u8,
    /// Reflections of light after the first; with 0, no part of the object lights another.
    pub bounces: u32,
}

impl Default for Shooting {
    fn default() -> Self {
        Self { side: 96, lights: 36, lowest_deg: 65.0, noise: 0.002, bits: 16, bounces: 4 }
    }
}

/// Photographs on disk, with their true normals.
pub struct Photographs {
    _folder: tempfile::TempDir,
    pub lp: PathBuf,
    /// True normals; the fourth channel is 0 outside the mask.
    pub truth: Image,
}

/// Returns directions on a spiral around the view.
pub fn directions(count: usize, lowest_deg: f64) -> Vec<Vec3<f64>> {
    let (top, bottom) = (scalar::cos(12.0_f64.to_radians()), scalar::cos(lowest_deg.to_radians()));
    let direction = |k: usize| {
        let k = k as f64 + 0.5;
        let z = top + (bottom - top) * k / count as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), k * 2.399_963_229_728_653);
        Vec3::new(r * scalar::cos(angle), r * scalar::sin(angle), z)
    };
    (0..count).map(direction).collect()
}

/// Takes photographs of a mesh that is looked at along −z.
pub fn photograph(mesh: Mesh, finish: &Finish, shooting: Shooting) -> Photographs {
    let folder = tempfile::tempdir().unwrap();
    let camera = camera(&mesh);
    let scene = scene(mesh, finish);
    let truth = truth(&scene, &camera, shooting.side);
    let prepared = Prepared::new(scene, &SurfaceSettings::default()).unwrap();
    let lights = directions(shooting.lights, shooting.lowest_deg);
    let images: Vec<Image> = (0..lights.len())
        .map(|k| {
            let frame = taken(&prepared, &camera, (lights[k], k as u32), finish, shooting);
            frame.color
        })
        .collect();
    let exposure = exposure(&images, &truth);
    let mut noise = Noise::new(1);
    let mut lp = format!("{}\n", lights.len());
    for (k, (image, light)) in images.iter().zip(&lights).enumerate() {
        let name = format!("photo {:03}.png", k + 1);
        write_photograph(&folder.path().join(&name), image, (exposure, shooting), &mut noise);
        lp += &format!("{name} {} {} {}\n", light.x, light.y, light.z);
    }
    let mask: Vec<u8> = truth.pixels().iter().map(|pixel| if pixel[3] > 0.0 { 255 } else { 0 }).collect();
    write(
        &folder.path().join("mask.png"),
        shooting.side,
        (PngColor::Grey, PngSamples::U8(&mask)),
        Encoding::Linear,
    );
    let path = folder.path().join("dome.lp");
    write_text(&path, &lp).unwrap();
    Photographs { _folder: folder, lp: path, truth }
}

fn scene(mesh: Mesh, finish: &Finish) -> Scene {
    let mut data = SceneData::default();
    data.meshes.push(mesh);
    data.materials.push(Material { double_sided: true, ..finish.material.clone() });
    data.instances.push(Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY });
    Scene::new(data).unwrap()
}

fn camera(mesh: &Mesh) -> Camera {
    let mut low = Vec3::splat(f32::INFINITY);
    let mut high = Vec3::splat(f32::NEG_INFINITY);
    for p in mesh.positions() {
        low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    let size = (high - low).to_f64();
    let half = 0.5 * size.x.max(size.y) * 0.99;
    let distance = 4.0 * (half + size.z);
    let target = ((high + low) * 0.5).to_f64();
    let orbit = Orbit { azimuth: 0.0, elevation: 0.0, distance, target, fov_y: 0.5 };
    let far = 2.0 * distance + size.z;
    let projection = Projection::Orthographic { half_width: half, half_height: half, near: 0.01 * half, far };
    Camera { projection, ..orbit.camera(half) }
}

/// Returns the mean true normals of each pixel; the fourth channel is 0 if it shows a border or an edge.
fn truth(scene: &Scene, camera: &Camera, side: u32) -> Image {
    let settings = RenderSettings {
        width: side * FINER,
        height: side * FINER,
        samples: 1,
        aovs: true,
        ..RenderSettings::default()
    };
    let lighting = Lighting::default();
    let shot = Shot { camera, lighting: &lighting, settings: &settings };
    let frame = render(scene, &shot).unwrap();
    let fine = frame.aovs.unwrap().normals;
    let mut truth = Image::new(side, side, [0.0; 4]).unwrap();
    for (i, pixel) in truth.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % side * FINER, i as u32 / side * FINER);
        let all = (0..FINER * FINER).map(|k| fine.pixel(x + k % FINER, y + k / FINER));
        let sum = all.fold([0.0; 4], |sum: [f32; 4], n| std::array::from_fn(|c| sum[c] + n[c]));
        let [nx, ny, nz, count] = sum.map(|v| v / (FINER * FINER) as f32);
        let length = (nx * nx + ny * ny + nz * nz).sqrt();
        if count >= 1.0 && length > 0.985 {
            *pixel = [nx / length, ny / length, nz / length, 1.0];
        }
    }
    truth
}

fn taken(
    prepared: &Prepared,
    camera: &Camera,
    (light, seed): (Vec3<f64>, u32),
    finish: &Finish,
    shooting: Shooting,
) -> Frame {
    let settings = RenderSettings {
        width: shooting.side,
        height: shooting.side,
        shading: finish.shading,
        shadows: true,
        ..RenderSettings::default()
    };
    let kind = LightKind::Directional { direction: -light.to_f32() };
    let light = Light { name: String::new(), kind, color: Vec3::splat(2.0), falloff: Falloff::None };
    let lighting = Lighting { lights: vec![light], ..Lighting::default() };
    let shot = Shot { camera, lighting: &lighting, settings: &settings };
    let paths =
        ReferenceSettings { spp: 32, seed, bounces: shooting.bounces, ..ReferenceSettings::default() };
    reference(prepared, &shot, &paths, Progress::SILENT).unwrap()
}

/// Returns the factor with which all but the brightest half percent of the object is below 0.9.
fn exposure(images: &[Image], truth: &Image) -> f64 {
    let of_image = |image: &Image| -> Vec<f32> {
        let inside = image.pixels().iter().zip(truth.pixels()).filter(|(_, truth)| truth[3] > 0.0);
        inside.map(|(pixel, _)| pixel[0]).collect()
    };
    let mut values: Vec<f32> = images.iter().flat_map(of_image).collect();
    values.sort_unstable_by(f32::total_cmp);
    0.9 / f64::from(values[values.len() - 1 - values.len() / 200])
}

/// Normally distributed numbers.
pub struct Noise(u64);

impl Noise {
    /// Starts a sequence.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        (-2.0 * scalar::ln(self.unit())).sqrt() * scalar::cos(std::f64::consts::TAU * self.unit())
    }
}

fn write_photograph(path: &Path, image: &Image, (exposure, shooting): (f64, Shooting), noise: &mut Noise) {
    let mut grey = |pixel: &[f32; 4]| {
        let v = f64::from(pixel[0]) * exposure;
        (v + shooting.noise * (v + 0.1).sqrt() * noise.normal()).clamp(0.0, 1.0)
    };
    let values: Vec<f64> = image.pixels().iter().map(&mut grey).collect();
    if shooting.bits == 16 {
        let codes: Vec<u16> = values.iter().map(|v| (v * 65_535.0 + 0.5) as u16).collect();
        return write(path, shooting.side, (PngColor::Grey, PngSamples::U16(&codes)), Encoding::Linear);
    }
    let codes: Vec<u8> = values.iter().map(|v| (srgb_from_linear(*v) * 255.0 + 0.5) as u8).collect();
    write(path, shooting.side, (PngColor::Grey, PngSamples::U8(&codes)), Encoding::Srgb);
}

fn write(path: &Path, side: u32, (color, samples): (PngColor, PngSamples<'_>), encoding: Encoding) {
    write_png(path, &PngImage { width: side, height: side, color, samples, encoding }).unwrap();
}

/// Returns a square relief of bumps and hollows; `depth` scales it.
pub fn relief(depth: f64) -> Mesh {
    const SIDE: u32 = 160;
    let mut noise = Noise::new(3);
    let bumps: Vec<[f64; 4]> = (0..30)
        .map(|_| {
            let [x, y] = [0; 2].map(|_| 1.8 * noise.unit() - 0.9);
            let size = 0.06 + 0.16 * noise.unit();
            [x, y, size, depth * size * (2.0 * noise.unit() - 1.0)]
        })
        .collect();
    let height = |x: f64, y: f64| -> f64 {
        let bump = |[cx, cy, size, height]: &[f64; 4]| {
            let [dx, dy] = [(x - cx) / size, (y - cy) / size];
            height * scalar::exp(-0.5 * (dx * dx + dy * dy))
        };
        bumps.iter().map(bump).sum()
    };
    let mut data = MeshData::default();
    for i in 0..SIDE * SIDE {
        let [x, y] = [i % SIDE, i / SIDE].map(|v| 2.0 * f64::from(v) / f64::from(SIDE - 1) - 1.0);
        data.positions.push(Vec3::new(x, y, height(x, y)).to_f32());
    }
    for (x, y) in (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y))) {
        let corner = y * SIDE + x;
        data.triangles.push([corner, corner + 1, corner + SIDE + 1]);
        data.triangles.push([corner, corner + SIDE + 1, corner + SIDE]);
    }
    Mesh::new(data).unwrap()
}
