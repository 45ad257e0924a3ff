//! The tracer against the rasteriser, closed forms, and itself.
#![allow(clippy::print_stderr)]

#[path = "common/scenes.rs"]
mod scenes;

use std::path::Path;
use taotie::film::{Development, develop8};
use taotie::image::{Encoding, Image};
use taotie::io::{PngColor, PngImage, PngSamples, write_png};
use taotie::math::Vec3;
use taotie::names::Named;
use taotie::render::{Frame, Lighting, Prepared, ReferenceSettings, RenderSettings, reference, render};
use taotie::scene::{AlphaMode, Camera, NormalSpace, Scene};
use taotie::shade::Shading;
use taotie::surface::SurfaceMethod;

/// What both renderers are asked to show.
struct View {
    scene: Scene,
    camera: Camera,
    lighting: Lighting,
    settings: RenderSettings,
}

impl View {
    /// A small picture under raking light with shadows.
    fn of(scene: Scene, camera: Camera) -> Self {
        let lights = vec![scenes::directional(Vec3::new(0.9, -0.5, -0.6), 3.0)];
        let lighting = Lighting { lights, ambient: Vec3::splat(0.08), environment: None };
        let settings = RenderSettings {
            width: 160,
            height: 120,
            samples: 16,
            shadows: true,
            specular_aa: false,
            ..RenderSettings::default()
        };
        Self { scene, camera, lighting, settings }
    }

    fn traced(&self, tracing: &ReferenceSettings) -> Frame {
        let prepared = Prepared::new(&self.scene, &self.settings.surface).unwrap();
        reference(&prepared, &self.camera, &self.lighting, &self.settings, tracing, &|_| {}).unwrap()
    }
}

fn developed(image: &Image) -> Vec<[u8; 4]> {
    let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
    develop8(image, &development).unwrap()
}

/// Mean absolute difference of developed pictures, in codes of 255.
fn difference(a: &Image, b: &Image) -> f64 {
    let (a, b) = (developed(a), developed(b));
    let sum: u64 = a
        .iter()
        .zip(&b)
        .flat_map(|(a, b)| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).collect::<Vec<_>>())
        .sum();
    sum as f64 / (3 * a.len()) as f64
}

/// Directly lit, both renderers give the same picture but for how they average over pixels.
fn direct_light_agrees(name: &str, view: &View, spp: u32) {
    let raster = render(&view.scene, &view.camera, &view.lighting, &view.settings).unwrap();
    let tracing = ReferenceSettings { spp, bounces: 0, ..ReferenceSettings::default() };
    let traced = view.traced(&tracing);
    let difference = difference(&raster.color, &traced.color);
    eprintln!("{name}: {difference:.3} of 255");
    keep_to_look_at(&format!("{name}-raster"), &raster.color);
    keep_to_look_at(&format!("{name}-traced"), &traced.color);
    assert!(difference <= 0.5, "{name}: {difference} of 255");
}

/// Writes a picture to the folder that `TAOTIE_LOOK` names, if it does.
fn keep_to_look_at(name: &str, image: &Image) {
    let Some(folder) = std::env::var_os("TAOTIE_LOOK") else { return };
    let pixels: Vec<u8> = developed(image).iter().flat_map(|p| p[..3].to_vec()).collect();
    let (width, height, samples) = (image.width(), image.height(), PngSamples::U8(&pixels));
    let png = PngImage { width, height, color: PngColor::Rgb, samples, encoding: Encoding::Srgb };
    write_png(&Path::new(&folder).join(format!("{name}.png")), &png).unwrap();
}

#[test]
fn direct_light_of_every_model_is_that_of_the_rasteriser() {
    let mut view = View::of(scenes::embossed_sphere(NormalSpace::Tangent), scenes::camera(20.0, 15.0, 3.4));
    for (name, shading) in Shading::NAMES {
        view.settings.shading = *shading;
        direct_light_agrees(&format!("direct-{name}"), &view, 16);
    }
}

#[test]
fn direct_light_on_every_kind_of_normal_is_that_of_the_rasteriser() {
    for (name, method) in SurfaceMethod::NAMES {
        let object = *method == SurfaceMethod::ObjectNormal;
        let space = if object { NormalSpace::Object } else { NormalSpace::Tangent };
        let mut view = View::of(scenes::embossed_sphere(space), scenes::camera(20.0, 15.0, 3.4));
        view.settings.surface.method = Some(*method);
        direct_light_agrees(&format!("direct-{name}"), &view, 16);
    }
}

#[test]
fn direct_light_of_every_kind_of_light_is_that_of_the_rasteriser() {
    // A plain floor: of a checkered one the rasteriser blurs the far squares.
    let mut scene = scenes::floor_and_mirrored_spheres();
    scene.materials[1].base_color_texture = None;
    let mut view = View::of(scene, scenes::camera(-15.0, 25.0, 6.0));
    view.lighting.lights = scenes::every_light();
    for shadows in [true, false] {
        view.settings.shadows = shadows;
        direct_light_agrees(&format!("direct-every-light-{shadows}"), &view, 64);
    }
}

#[test]
fn what_is_seen_through_masks_and_panes_is_as_in_the_rasteriser() {
    let mut view = View::of(scenes::panes(), scenes::camera(10.0, 5.0, 4.5));
    view.settings.shadows = false;
    direct_light_agrees("panes", &view, 128);
    // Shadows of masks agree too; those of blended panes are the tracer's alone.
    for material in &mut view.scene.materials {
        if material.alpha == AlphaMode::Blend {
            material.alpha = AlphaMode::Mask(0.5);
        }
    }
    view.settings.shadows = true;
    direct_light_agrees("masks", &view, 64);
}
