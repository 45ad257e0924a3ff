//! Golden pictures: each scene at every SIMD level of this machine, with one and with several threads, gives the same
//! bits, equal to the picture in `tests/golden`.
//!
//! A failure leaves the actual picture, the expected one, their difference and a page that shows them in
//! `target/golden-failures`. `TAOTIE_BLESS=1` rewrites the pictures: look at them before you commit them.

use crate::finishes;
use crate::scenes;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};
use taotie_engine::film::{Development, develop8};
use taotie_engine::image::{Encoding, Image, Texels};
use taotie_engine::math::{SimdLevel, Vec3};
use taotie_engine::names::Named;
use taotie_engine::render::{
    EnvironmentLight, Frame, GrazingNormals, Lighting, RenderSettings, Shot, SurfaceSettings, render,
};
use taotie_engine::scene::{Camera, Light, NormalSpace, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_engine::shade::{Energy, Shading};
use taotie_engine::surface::{SurfaceMethod, TangentMethod};
use taotie_io::{PngColor, PngImage, PngSamples, read_bitmap, write_png, write_text};

static SKY: LazyLock<Arc<Environment>> = LazyLock::new(|| Environment::new(finishes::sky()).unwrap().into());

/// A golden picture.
struct Golden {
    name: String,
    scene: Scene,
    camera: Camera,
    lighting: Lighting,
    settings: RenderSettings,
}

impl Golden {
    fn new(name: &str, scene: Scene, camera: Camera, lights: Vec<Light>) -> Self {
        let lighting = Lighting { lights, ambient: Vec3::splat(0.08), environment: None };
        let settings =
            RenderSettings { width: 160, height: 120, samples: 1, aovs: true, ..RenderSettings::default() };
        Self { name: name.into(), scene, camera, lighting, settings }
    }

    fn with(mut self, change: impl FnOnce(&mut RenderSettings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// Shows it under a visible sky instead of the ambient light.
    fn under_sky(mut self) -> Self {
        let light =
            EnvironmentLight { environment: SKY.clone(), rotation: 0.4, intensity: 0.8, visible: true };
        self.lighting = Lighting { environment: Some(light), ambient: Vec3::splat(0.0), ..self.lighting };
        self
    }

    fn take(&self, simd: SimdLevel, threads: usize) -> Frame {
        let mut settings = self.settings.clone();
        settings.surface.simd = simd;
        let shot = Shot { camera: &self.camera, lighting: &self.lighting, settings: &settings };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&self.scene, &shot)).unwrap()
    }
}

fn raking() -> Vec<Light> {
    vec![scenes::directional(Vec3::new(0.9, -0.5, -0.6), 3.0)]
}

fn shading_models() -> Vec<Golden> {
    let golden = |(name, shading): &(&str, Shading)| {
        let scene = scenes::embossed_sphere(NormalSpace::Tangent);
        Golden::new(&format!("shading-{name}"), scene, scenes::camera(20.0, 15.0, 3.4), raking())
            .with(|settings| settings.shading = *shading)
    };
    Shading::NAMES.iter().map(golden).collect()
}

fn surface_methods() -> Vec<Golden> {
    let golden = |(name, method): &(&str, SurfaceMethod)| {
        let object = *method == SurfaceMethod::ObjectNormal;
        let scene = scenes::embossed_sphere(if object { NormalSpace::Object } else { NormalSpace::Tangent });
        Golden::new(&format!("surface-{name}"), scene, scenes::camera(20.0, 15.0, 3.4), raking()).with(
            |settings| {
                settings.surface = SurfaceSettings { method: Some(*method), ..SurfaceSettings::default() }
            },
        )
    };
    SurfaceMethod::NAMES.iter().map(golden).collect()
}

fn tangent_methods() -> Vec<Golden> {
    let golden = |(name, method): &(&str, TangentMethod)| {
        let scene = scenes::floor_and_mirrored_spheres();
        Golden::new(&format!("tangents-{name}"), scene, scenes::camera(0.0, 20.0, 6.0), raking())
            .with(|settings| settings.surface.tangents = Some(*method))
    };
    TangentMethod::NAMES.iter().map(golden).collect()
}

fn pictures() -> Vec<Golden> {
    let floor = || scenes::floor_and_mirrored_spheres();
    vec![
        Golden::new("every-light", floor(), scenes::camera(-15.0, 25.0, 6.0), scenes::every_light())
            .with(|settings| settings.shadows = true),
        Golden::new("horizon-16-samples", floor(), scenes::camera(30.0, 6.0, 7.0), raking())
            .with(|settings| settings.samples = 16),
        Golden::new("panes", scenes::panes(), scenes::camera(10.0, 5.0, 4.5), raking()).with(|settings| {
            settings.shadows = true;
            settings.samples = 4;
        }),
    ]
}

fn near() -> Camera {
    scenes::camera(20.0, 15.0, 3.4)
}

fn finishes() -> Vec<Golden> {
    let under_lamp = |name: &str, scene: Scene| Golden::new(name, scene, near(), raking());
    let white = |energy| {
        under_lamp(&format!("energy-{}", energy_name(energy)), rough_gold())
            .with(|settings| settings.energy = energy)
    };
    vec![
        under_lamp("clearcoat", finishes::clearcoat()),
        under_lamp("clearcoat-under-sky", finishes::clearcoat()).under_sky(),
        under_lamp("velvet", finishes::velvet()),
        under_lamp("velvet-under-sky", finishes::velvet()).under_sky(),
        under_lamp("brushed", finishes::brushed()),
        under_lamp("brushed-under-sky", finishes::brushed()).under_sky(),
        under_lamp("tinted-glass", finishes::tinted_glass()),
        white(Energy::Compensated),
        white(Energy::Single),
    ]
}

fn energy_name(energy: Energy) -> &'static str {
    Energy::NAMES.iter().find(|(_, known)| *known == energy).map_or("", |(name, _)| name)
}

fn rough_gold() -> Scene {
    finishes::sphere(finishes::metal([1.0, 0.72, 0.35], 1.0), Vec::new())
}

fn under_environments() -> Vec<Golden> {
    let under_sky = |name: &str, scene: Scene| Golden::new(name, scene, near(), Vec::new()).under_sky();
    vec![
        under_sky("sky-smooth-metal", finishes::occluded_gold(0.1)),
        under_sky("sky-rough-metal", finishes::occluded_gold(0.8)),
        under_sky("sky-cook-torrance", finishes::occluded_gold(0.5))
            .with(|settings| settings.shading = Shading::CookTorrance),
        under_sky("sky-blinn-phong", scenes::embossed_sphere(NormalSpace::Tangent))
            .with(|settings| settings.shading = Shading::BlinnPhong),
        Golden::new("ground", finishes::occluded_gold(0.4), near(), raking()).under_sky().with(|settings| {
            settings.ground = true;
            settings.shadows = true;
        }),
    ]
}

fn relief_at_its_limits() -> Vec<Golden> {
    let polished = |name: &str, scale| {
        Golden::new(name, finishes::polished_bosses(scale, 0.2), scenes::camera(20.0, 15.0, 5.5), raking())
    };
    let keep = |settings: &mut RenderSettings| settings.grazing_normals = GrazingNormals::Keep;
    vec![
        polished("specular-aa-on", 1.0),
        polished("specular-aa-off", 1.0).with(|settings| settings.specular_aa = false),
        polished("grazing-soften", 3.0),
        polished("grazing-keep", 3.0).with(keep),
        polished("grazing-soften-under-sky", 3.0).under_sky(),
        polished("grazing-keep-under-sky", 3.0).under_sky().with(keep),
    ]
}

fn bits(image: &Image) -> Vec<u32> {
    image.pixels().iter().flatten().map(|v| v.to_bits()).collect()
}

fn all_bits(frame: &Frame) -> Vec<(&'static str, Vec<u32>)> {
    let aovs = frame.aovs.as_ref().expect("the settings ask for them");
    let mut all = vec![("color", bits(&frame.color))];
    all.extend(aovs.named().map(|(name, image)| (name, bits(image))));
    all
}

/// Renders a picture in every way and compares; returns the fault, if any.
fn check(golden: &Golden) -> Option<String> {
    let first = golden.take(SimdLevel::Scalar, 1);
    let expected = all_bits(&first);
    for simd in SimdLevel::available() {
        for threads in [1, 3] {
            for ((name, bits), (_, expected)) in all_bits(&golden.take(simd, threads)).iter().zip(&expected) {
                let differ = bits.iter().zip(expected).filter(|(a, b)| a != b).count();
                assert_eq!(differ, 0, "{} {name}: {} and {threads} threads", golden.name, simd.name());
            }
        }
    }
    compare_with_kept(&golden.name, &first.color)
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn compare_with_kept(name: &str, image: &Image) -> Option<String> {
    let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
    let actual: Vec<[u8; 3]> =
        develop8(image, &development).unwrap().iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let kept = folder("tests/golden").join(format!("{name}.png"));
    let size = (image.width(), image.height());
    if std::env::var("TAOTIE_BLESS").is_ok_and(|bless| bless == "1") {
        write(&kept, size, &actual);
        return None;
    }
    let expected = read(&kept, size);
    let worst = |a: &[u8; 3], b: &[u8; 3]| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
    let differences: Vec<u8> = actual.iter().zip(&expected).map(|(a, b)| worst(a, b)).collect();
    let count = differences.iter().filter(|d| **d > 0).count();
    if count == 0 && expected.len() == actual.len() {
        return None;
    }
    let failures = folder("target/golden-failures");
    std::fs::create_dir_all(&failures).unwrap();
    write(&failures.join(format!("{name}.actual.png")), size, &actual);
    write(&failures.join(format!("{name}.expected.png")), size, &expected);
    let difference: Vec<[u8; 3]> = differences.iter().map(|d| [d.saturating_mul(8); 3]).collect();
    write(&failures.join(format!("{name}.difference.png")), size, &difference);
    Some(format!("{name}: {count} pixels differ, at most by {}", differences.iter().max().unwrap_or(&0)))
}

fn write(path: &Path, (width, height): (u32, u32), pixels: &[[u8; 3]]) {
    let samples = PngSamples::U8(pixels.as_flattened());
    write_png(path, &PngImage { width, height, color: PngColor::Rgb, samples, encoding: Encoding::Srgb })
        .unwrap();
}

/// Reads the golden picture; black if there is none of this size.
fn read(path: &Path, (width, height): (u32, u32)) -> Vec<[u8; 3]> {
    let black = vec![[0; 3]; width as usize * height as usize];
    let Ok(bitmap) = read_bitmap(path) else { return black };
    match bitmap.texels() {
        Texels::U8(texels) if (bitmap.width(), bitmap.height()) == (width, height) => {
            texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect()
        }
        _ => black,
    }
}

fn check_all(goldens: &[Golden]) {
    let failures: Vec<(String, String)> =
        goldens.iter().filter_map(|golden| Some((golden.name.clone(), check(golden)?))).collect();
    if failures.is_empty() {
        return;
    }
    let page = folder("target/golden-failures").join(format!("{}.html", goldens[0].name));
    write_text(&page, &failure_page(&failures)).unwrap();
    let lines: Vec<&str> = failures.iter().map(|(_, why)| why.as_str()).collect();
    panic!("{}\nsee {}", lines.join("\n"), page.display());
}

fn failure_page(failures: &[(String, String)]) -> String {
    let mut page = String::from("<!doctype html><meta charset=utf-8><title>Golden pictures</title>");
    page += "<style>body{background:#222;color:#ddd;font-family:sans-serif}img{width:30%;image-rendering:pixelated}</style>";
    for (name, why) in failures {
        page += &format!("<h2>{why}</h2>");
        for kind in ["actual", "expected", "difference"] {
            page += &format!("<img src=\"{name}.{kind}.png\" title=\"{kind}\"> ");
        }
    }
    page
}

#[test]
fn golden_shading_models() {
    check_all(&shading_models());
}

#[test]
fn golden_surface_methods() {
    check_all(&surface_methods());
}

#[test]
fn golden_tangent_methods() {
    check_all(&tangent_methods());
}

#[test]
fn golden_pictures() {
    check_all(&pictures());
}

#[test]
fn golden_finishes() {
    check_all(&finishes());
}

#[test]
fn golden_under_environments() {
    check_all(&under_environments());
}

#[test]
fn golden_relief_at_its_limits() {
    check_all(&relief_at_its_limits());
}
