//! Light on mapped normals: the effect of occlusion, and of softened grazing normals.

use crate::finishes::{metal, polished_bosses, sphere};
use crate::scenes;
use crate::skies::equirect;
use std::sync::{Arc, LazyLock};
use taotie_engine::image::{Encoding, Image};
use taotie_engine::math::Vec3;
use taotie_engine::render::{EnvironmentLight, GrazingNormals, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Material, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_engine::shade::specular_occlusion;

static WHITE: LazyLock<Arc<Environment>> =
    LazyLock::new(|| Environment::new(Image::new(32, 16, [1.0; 4]).unwrap()).unwrap().into());

fn white_sky() -> Lighting {
    let light =
        EnvironmentLight { environment: WHITE.clone(), rotation: 0.0, intensity: 1.0, visible: false };
    Lighting { environment: Some(light), ..Lighting::default() }
}

/// Returns light from the hemisphere behind the camera, cosine-weighted.
fn sky_behind_the_camera() -> Lighting {
    let image = equirect(64, |d| Vec3::splat(d.z.max(0.0)));
    let environment = Environment::new(image).unwrap().into();
    let light = EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false };
    Lighting { environment: Some(light), ..Lighting::default() }
}

/// Returns a lamp next to the camera, moved aside by this share of the way.
fn lamp(aside: f64) -> Lighting {
    let direction = Vec3::new(-aside as f32, 0.0, -1.0);
    Lighting { lights: vec![scenes::directional(direction, 3.0)], ..Lighting::default() }
}

fn picture(scene: &Scene, lighting: &Lighting, grazing_normals: GrazingNormals) -> Image {
    let settings =
        RenderSettings { width: 96, height: 96, samples: 1, grazing_normals, ..RenderSettings::default() };
    let camera = scenes::camera(0.0, 0.0, 3.4);
    render(scene, &Shot { camera: &camera, lighting, settings: &settings }).unwrap().color
}

fn soft(scene: &Scene, lighting: &Lighting) -> Image {
    picture(scene, lighting, GrazingNormals::Soften)
}

/// Returns a sphere with an occlusion map of constant `occlusion`, or without one.
fn occluded(material: &Material, occlusion: Option<f64>) -> Scene {
    let map = scenes::texture(4, Encoding::Linear, |_, _| [occlusion.unwrap_or(1.0), 0.0, 0.0, 1.0]);
    let texture = occlusion.map(|_| scenes::plain(0));
    sphere(Material { occlusion_texture: texture, ..material.clone() }, vec![map])
}

/// Occlusion as stored in 8 bits.
const OCCLUSION: f64 = 102.0 / 255.0;

#[test]
fn occlusion_darkens_the_environment_and_never_a_lamp() {
    let mut matt = metal([0.8, 0.5, 0.3], 0.6);
    matt.metallic = 0.3;
    let [bare, dark] = [None, Some(OCCLUSION)].map(|o| occluded(&matt, o));
    assert_eq!(soft(&bare, &lamp(0.5)).pixels(), soft(&dark, &lamp(0.5)).pixels());
    let (bare, dark) = (soft(&bare, &white_sky()), soft(&dark, &white_sky()));
    assert!(dark.pixel(48, 48)[0] < 0.7 * bare.pixel(48, 48)[0]);
}

#[test]
fn occlusion_takes_all_of_its_share_of_diffuse_light() {
    let lambert = |o| {
        let settings = RenderSettings {
            width: 32,
            height: 32,
            samples: 1,
            shading: taotie_engine::shade::Shading::Lambert,
            ..RenderSettings::default()
        };
        let scene = occluded(&metal([0.8, 0.5, 0.3], 0.6), o);
        let (camera, sky) = (scenes::camera(0.0, 0.0, 3.4), white_sky());
        render(&scene, &Shot { camera: &camera, lighting: &sky, settings: &settings }).unwrap().color
    };
    for (bare, dark) in lambert(None).pixels().iter().zip(lambert(Some(OCCLUSION)).pixels()) {
        assert!((f64::from(dark[0]) - OCCLUSION * f64::from(bare[0])).abs() < 1e-6, "{bare:?} {dark:?}");
    }
}

#[test]
fn occlusion_takes_of_reflections_what_lagarde_says() {
    for roughness in [0.2f32, 0.5, 0.9] {
        let [bare, dark] =
            [None, Some(OCCLUSION)].map(|o| soft(&occluded(&metal([1.0; 3], roughness), o), &white_sky()));
        // The middle of the sphere looks along its normal.
        let ratio = f64::from(dark.pixel(48, 48)[0] / bare.pixel(48, 48)[0]);
        let truth = specular_occlusion(1.0, OCCLUSION, f64::from(roughness));
        assert!((ratio - truth).abs() < 5e-3, "{ratio} for {truth} at roughness {roughness}");
    }
}

/// Returns the light of each pixel near the silhouette relative to the surface without its map, in ascending order.
fn fringe(image: &Image, smooth: &Image) -> Vec<f32> {
    let light = |p: [f32; 4]| p[0] + p[1] + p[2];
    let near = |x: u32, y: u32| {
        let (dx, dy) = (f64::from(x) - 47.5, f64::from(y) - 47.5);
        let outside = |d: f64| {
            let length = (dx * dx + dy * dy).sqrt().max(1.0);
            let at = |v: f64| (47.5 + v * (length + d) / length).clamp(0.0, 95.0).round() as u32;
            image.pixel(at(dx), at(dy))[3] == 0.0
        };
        image.pixel(x, y)[3] == 1.0 && outside(4.0)
    };
    let all = (0..96 * 96).map(|i| (i % 96, i / 96)).filter(|(x, y)| near(*x, *y));
    let mut shares: Vec<f32> =
        all.map(|(x, y)| light(image.pixel(x, y)) / light(smooth.pixel(x, y))).collect();
    shares.sort_by(f32::total_cmp);
    shares
}

#[test]
fn softened_normals_have_no_black_fringe() {
    let rough = |metallic: f32| {
        let mut scene = polished_bosses(3.0, 0.6);
        scene.edit(|scene| scene.materials[0].metallic = metallic).unwrap();
        scene
    };
    // Kept normals that point away from the viewer do not see a lamp or a sky behind the camera. Measured, as shares
    // of the smooth surface's light: under the lamp 84 of 964 kept pixels are black, no softened one is below 0.671;
    // under the sky the darkest has 0.358 and 0.785, and what a metal mirrors 0.00007 and 0.2516.
    let cases = [
        ("lamp", 0.0, lamp(0.0), [0.0, 0.66]),
        ("sky", 0.0, sky_behind_the_camera(), [0.37, 0.77]),
        ("mirrored sky", 1.0, sky_behind_the_camera(), [1e-4, 0.24]),
    ];
    for (what, metallic, lighting, [dark, light]) in cases {
        let bumpy = rough(metallic);
        let mut smooth = bumpy.clone();
        smooth.edit(|scene| scene.materials[0].normal = None).unwrap();
        let plain = soft(&smooth, &lighting);
        let [kept, softened] = [GrazingNormals::Keep, GrazingNormals::Soften]
            .map(|way| fringe(&picture(&bumpy, &lighting, way), &plain));
        eprintln!("{what}: of {} the darkest {} kept, {} softened", kept.len(), kept[0], softened[0]);
        assert!(kept[0] <= dark, "{what}: {} is no longer dark: the case shows nothing", kept[0]);
        assert!(softened[0] >= light, "{what}: only {}", softened[0]);
    }
}

#[test]
fn surfaces_without_a_map_are_the_same_to_the_bit() {
    let scene = sphere(metal([0.9, 0.6, 0.3], 0.4), Vec::new());
    for lighting in [lamp(2.0), white_sky()] {
        let [kept, softened] =
            [GrazingNormals::Keep, GrazingNormals::Soften].map(|way| picture(&scene, &lighting, way));
        assert_eq!(kept.pixels(), softened.pixels());
    }
}
