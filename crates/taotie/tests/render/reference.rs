//! The tracer compared with the rasteriser, closed forms, and itself.

use crate::scenes;
use crate::skies;
use crate::views::{View, difference, environment_of, keep_to_look_at};
use taotie_engine::image::Image;
use taotie_engine::math::{SimdLevel, Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::render::{ReferenceSettings, render};
use taotie_engine::scene::{AlphaMode, NormalSpace};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;

/// Under direct light both renderers give the same picture, except for how they average over pixels.
fn direct_light_agrees(name: &str, view: &View, spp: u32) {
    let raster = render(&view.scene, &view.shot()).unwrap();
    let tracing = ReferenceSettings { spp, bounces: 0, ..ReferenceSettings::default() };
    let traced = view.traced(&tracing);
    let difference = difference(&raster.color, &traced.color);
    eprintln!("{name}: {difference:.3} of 255");
    keep_to_look_at(&format!("{name}-raster"), &raster.color);
    keep_to_look_at(&format!("{name}-traced"), &traced.color);
    assert!(difference <= 0.5, "{name}: {difference} of 255");
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
    // A plain floor: the rasteriser blurs the far squares of a checkered one.
    let mut scene = scenes::floor_and_mirrored_spheres();
    scene.edit(|scene| scene.materials[1].base_color_texture = None).unwrap();
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
    let mut glass = View::of(scenes::glass(), scenes::camera(10.0, 5.0, 4.5));
    glass.settings.shadows = false;
    direct_light_agrees("glass", &glass, 128);
    // Metals are opaque in spite of transmission, and cast shadows.
    let made_metal = glass.scene.edit(|scene| {
        let transmitting = scene.materials.iter_mut().filter(|material| material.transmission.is_some());
        transmitting.for_each(|material| material.metallic = 1.0);
    });
    made_metal.unwrap();
    glass.settings.shadows = true;
    direct_light_agrees("metal", &glass, 128);
    // Shadows of masks agree too; only the tracer supports those of blended panes.
    let masked = view.scene.edit(|scene| {
        let blended = scene.materials.iter_mut().filter(|material| material.alpha == AlphaMode::Blend);
        blended.for_each(|material| material.alpha = AlphaMode::Mask(0.5));
    });
    masked.unwrap();
    view.settings.shadows = true;
    direct_light_agrees("masks", &view, 64);
}

/// Returns a sphere with relief on a floor, under a sky with small bright parts and one light.
fn rich() -> View {
    let mut view = View::under(
        environment_of(skies::speckled(64)),
        scenes::floor_and_mirrored_spheres(),
        scenes::camera(-15.0, 25.0, 6.0),
    );
    (view.settings.width, view.settings.height) = (48, 36);
    view.lighting.lights = vec![scenes::directional(Vec3::new(0.9, -0.5, -0.6), 1.0)];
    view
}

fn bits(image: &Image) -> Vec<u32> {
    image.pixels().iter().flatten().map(|v| v.to_bits()).collect()
}

#[test]
fn threads_and_simd_change_no_bit_and_seeds_do() {
    let mut view = rich();
    view.scene = scenes::panes();
    view.settings.aovs = true;
    let tracing = ReferenceSettings { spp: 5, bounces: 6, ..ReferenceSettings::default() };
    let taken = |view: &View, tracing: &ReferenceSettings, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let frame = pool.install(|| view.traced(tracing));
        let aovs = frame.aovs.as_ref().expect("they were requested");
        let mut all = vec![bits(&frame.color)];
        all.extend(aovs.named().map(|(_, image)| bits(image)));
        all
    };
    view.settings.surface.simd = SimdLevel::Scalar;
    let first = taken(&view, &tracing, 1);
    for simd in SimdLevel::available() {
        view.settings.surface.simd = simd;
        for threads in [1, 3] {
            assert!(taken(&view, &tracing, threads) == first, "{} and {threads} threads", simd.name());
        }
    }
    let other = taken(&view, &ReferenceSettings { seed: 1, ..tracing }, 1);
    let differ = first[0].iter().zip(&other[0]).filter(|(a, b)| a != b).count();
    assert!(2 * differ > first[0].len(), "another seed changes only {differ} numbers");
}

/// Returns the slope of the line through points, by least squares.
fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let product =
        |i: usize, j: usize| points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    product(0, 1) / product(0, 0)
}

#[test]
fn noise_falls_with_the_number_of_paths() {
    let view = rich();
    let taken = |spp: u32, seed: u32| {
        view.traced(&ReferenceSettings { spp, seed, bounces: 3, ..ReferenceSettings::default() }).color
    };
    let truth = taken(1024, 1);
    let error = |image: &Image| {
        let squares = image.pixels().iter().flatten().zip(truth.pixels().iter().flatten());
        let sum: f64 = squares.map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum();
        (sum / (4 * image.pixels().len()) as f64).sqrt()
    };
    let points: Vec<[f64; 2]> = [4u32, 8, 16, 32, 64, 128, 256]
        .map(|spp| {
            let error = error(&taken(spp, 0));
            eprintln!("{spp} paths: {error:.5}");
            [scalar::ln(f64::from(spp)), scalar::ln(error)]
        })
        .into();
    let slope = slope(&points);
    eprintln!("slope {slope:.3}");
    assert!(slope <= -0.45, "{slope}");
}
