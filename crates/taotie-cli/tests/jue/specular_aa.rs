//! Relief finer than a pixel does not sparkle: a turntable of the demo's vessel, polished, compared with 64 samples a
//! pixel.

use taotie_engine::film::{Development, develop8, develop16};
use taotie_engine::image::{Bitmap, Encoding, Image, Texels, Texture};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Material, Orbit, Scene};
use taotie_study::jue;

/// Number of pictures of the turntable, and the angle between two, degrees.
const PICTURES: usize = 12;
const STEP: f64 = 0.3;
/// Pixels across and down.
const SIDE: u32 = 256;

/// Returns the vessel with its normal map, made of one polished metal.
fn polished_vessel() -> Scene {
    let mut scene = jue::scene(1024).into_data();
    for material in &mut scene.materials {
        *material = Material {
            base_color: [0.95, 0.75, 0.5, 1.0],
            metallic: 1.0,
            roughness: 0.2,
            normal: material.normal,
            ..Material::default()
        };
    }
    Scene::new(scene).unwrap()
}

fn camera(scene: &Scene) -> Camera {
    let bounds = scene.bounds().unwrap();
    let [azimuth, elevation, fov_y] = [24.0f64, 15.0, 26.0].map(f64::to_radians);
    let orbit = Orbit { azimuth, elevation, distance: 0.55, target: bounds.center(), fov_y };
    orbit.camera(bounds.diagonal())
}

fn lamp() -> Lighting {
    let kind = LightKind::Directional { direction: Vec3::new(-0.5, -0.6, -0.62).normalize() };
    let lamp = Light { name: String::new(), kind, color: Vec3::splat(2.0), falloff: Falloff::None };
    Lighting { lights: vec![lamp], ..Lighting::default() }
}

fn turned(scene: &Scene, degrees: f64) -> Scene {
    let mut turned = scene.data().clone();
    for instance in &mut turned.instances {
        instance.world_from_object =
            Mat4::rotation_about(Vec3::new(0.0, 1.0, 0.0), degrees.to_radians()) * instance.world_from_object;
    }
    Scene::new(turned).unwrap()
}

fn halved(image: &Image) -> Image {
    let (width, height) = (image.width() / 2, image.height() / 2);
    let mut half = Image::new(width, height, [0.0; 4]).unwrap();
    for (i, mean) in half.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % width * 2, i as u32 / width * 2);
        for pixel in [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| image.pixel(x + dx, y + dy)) {
            for (mean, value) in mean.iter_mut().zip(pixel) {
                *mean += value / 4.0;
            }
        }
    }
    half
}

/// Renders the turntable's pictures at `side` × `side` pixels, in linear light.
fn take(scene: &Scene, side: u32, samples: u32, specular_aa: bool) -> Vec<Image> {
    let camera = camera(scene);
    let settings =
        RenderSettings { width: side, height: side, samples, specular_aa, ..RenderSettings::default() };
    let picture = |i: usize| {
        let scene = turned(scene, i as f64 * STEP);
        let lighting = lamp();
        render(&scene, &Shot { camera: &camera, lighting: &lighting, settings: &settings }).unwrap().color
    };
    (0..PICTURES).map(picture).collect()
}

/// Renders the truth with 64 samples a pixel.
fn truth(scene: &Scene, side: u32) -> Vec<Image> {
    take(scene, side * 2, 16, false).iter().map(halved).collect()
}

/// Returns the displayed luminance, [0, 1].
fn shown(image: &Image) -> Vec<f64> {
    let development = Development { background: Some(Vec3::splat(0.0)), ..Development::default() };
    let codes = develop16(image, &development).unwrap();
    codes.iter().map(|[r, g, b, _]| luminance([*r, *g, *b].map(|v| f64::from(v) / 65535.0))).collect()
}

fn linear(image: &Image) -> Vec<f64> {
    image.pixels().iter().map(|[r, g, b, _]| luminance([*r, *g, *b].map(f64::from))).collect()
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// How pictures of a turntable differ from the truth.
#[derive(Debug)]
struct Figures {
    /// The root of the mean variance over time of (picture − truth).
    flicker: f64,
    /// The root of the mean square of (picture − truth).
    error: f64,
    /// Mean of the pictures over mean of the truth, in its bright areas.
    highlights: f64,
    /// Mean of the pictures over mean of the truth.
    mean: f64,
}

fn compare(pictures: &[Vec<f64>], truths: &[Vec<f64>], covered: &[usize]) -> Figures {
    let count = pictures.len() as f64;
    let (mut variance, mut square, mut sums, mut bright) = (0.0, 0.0, [0.0; 2], [0.0; 2]);
    let mut ranked: Vec<f64> = covered.iter().map(|p| truths[0][*p]).collect();
    ranked.sort_by(f64::total_cmp);
    let threshold = ranked[ranked.len() * 9 / 10];
    for &p in covered {
        let errors: Vec<f64> = pictures.iter().zip(truths).map(|(a, b)| a[p] - b[p]).collect();
        let mean = errors.iter().sum::<f64>() / count;
        variance += errors.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / count;
        square += errors.iter().map(|e| e * e).sum::<f64>() / count;
        for (a, b) in pictures.iter().zip(truths) {
            sums[0] += a[p];
            sums[1] += b[p];
            if b[p] > threshold {
                bright[0] += a[p];
                bright[1] += b[p];
            }
        }
    }
    let pixels = covered.len() as f64;
    Figures {
        flicker: (variance / pixels).sqrt(),
        error: (square / pixels).sqrt(),
        highlights: bright[0] / bright[1],
        mean: sums[0] / sums[1],
    }
}

fn covered(truths: &[Image]) -> Vec<usize> {
    (0..truths[0].pixels().len()).filter(|i| truths.iter().all(|t| t.pixels()[*i][3] == 1.0)).collect()
}

/// Returns the figures of luminance by `of`.
fn figures(pictures: &[Image], truths: &[Image], of: fn(&Image) -> Vec<f64>) -> Figures {
    let every = |images: &[Image]| images.iter().map(of).collect::<Vec<_>>();
    compare(&every(pictures), &every(truths), &covered(truths))
}

#[test]
fn polished_relief_sparkles_less_and_is_nearer_to_the_truth() {
    let scene = polished_vessel();
    let truths = truth(&scene, SIDE);
    let pictures = [false, true].map(|specular_aa| take(&scene, SIDE, 1, specular_aa));
    let [off, on] = [&pictures[0], &pictures[1]].map(|pictures| figures(pictures, &truths, linear));
    let [off_shown, on_shown] =
        [&pictures[0], &pictures[1]].map(|pictures| figures(pictures, &truths, shown));
    println!("linear: {off:?} off, {on:?} on\nshown: {off_shown:?} off, {on_shown:?} on");
    let variance = |f: &Figures| f.flicker * f.flicker;
    // Measured: 0.220 of the variance, 0.595 of the error; 0.732 of the light where the truth is brightest, off
    // 0.710.
    assert!(variance(&on) < 0.24 * variance(&off), "{on:?} {off:?}");
    assert!(on.error < 0.62 * off.error, "{on:?} {off:?}");
    assert!(on.highlights > off.highlights + 0.015, "{on:?} {off:?}");
    // Without it a quarter of the light is lost, measured 0.718. With it there is two fifths too much, measured
    // 1.394: a mean and its length do not account for facets that would be hidden or turned away.
    assert!((0.70..0.74).contains(&off.mean) && (1.0..1.42).contains(&on.mean), "{on:?} {off:?}");
    // A display shows that excess in dark areas, and clips the sparkle that is gone. Measured: flicker of 0.0815
    // instead of 0.0762, error of 0.2096 instead of 0.1461.
    assert!(on_shown.flicker < 0.084 && on_shown.error < 0.215, "{on_shown:?} {off_shown:?}");
}

/// Returns the maximum difference in codes of 255 between a picture with and without it.
fn greatest_difference(scene: &Scene, camera: &Camera, lighting: &Lighting) -> u8 {
    let picture = |specular_aa| {
        let settings =
            RenderSettings { width: 128, height: 128, samples: 1, specular_aa, ..RenderSettings::default() };
        let image = render(scene, &Shot { camera, lighting, settings: &settings }).unwrap().color;
        assert!(linear(&image).iter().any(|light| *light > 1.0), "the picture has a highlight");
        develop8(&image, &Development::default()).unwrap()
    };
    let (off, on) = (picture(false), picture(true));
    let pairs = off.as_flattened().iter().zip(on.as_flattened());
    pairs.map(|(off, on)| off.abs_diff(*on)).max().unwrap()
}

/// A patch of a sphere whose radius is a thousand pixels, with a flat normal map.
#[test]
fn flat_maps_and_gentle_bends_are_left_alone() {
    let flat = Bitmap::new(64, 64, 3, Texels::U8(vec![[128, 128, 255, 255]; 64 * 64])).unwrap();
    let mut scene = polished_vessel().into_data();
    let normal = scene.materials[0].normal.map(|mut map| {
        map.texture.texture = 0;
        map
    });
    scene.materials[0].normal = normal;
    scene.textures = vec![Texture::new(flat, Encoding::Normal)];
    scene.meshes = vec![Mesh::sphere(1.0, 96, 48)];
    scene.instances.truncate(1);
    scene.instances[0].world_from_object = Mat4::IDENTITY;
    let scene = Scene::new(scene).unwrap();
    let orbit = Orbit { azimuth: 0.5, elevation: 0.3, distance: 3.4, target: Vec3::splat(0.0), fov_y: 0.05 };
    let camera = orbit.camera(2.0);
    let back = camera.world_from_view.axis(2).to_f32();
    let kind = LightKind::Directional { direction: -back };
    let lamp = Light { name: String::new(), kind, color: Vec3::splat(0.3), falloff: Falloff::None };
    let lighting = Lighting { lights: vec![lamp], ..Lighting::default() };
    let difference = greatest_difference(&scene, &camera, &lighting);
    println!("{difference} of 255");
    assert!(difference <= 1, "{difference}");
}
