//! Normal maps compared with the reference integrator: the loss when relief is finer than a pixel.

use crate::computed::row;
use anyhow::Result;
use taotie_engine::Progress;
use taotie_engine::image::Image;
use taotie_engine::math::{Lane, Vec3};
use taotie_engine::render::{Lighting, Pass, Prepared, ReferenceSettings, RenderSettings, Shot, reference};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Orbit, Scene, from_view};
use taotie_study::jue;

const ROUGHNESS: [f32; 5] = [0.15, 0.25, 0.4, 0.6, 0.9];

/// The side of the pictures in pixels: far too small for the map's 1024 texels.
const SIDE: u32 = 128;
const SPP: u32 = 1024;

/// Returns a row per roughness: the error with one and with four samples, without and with specular antialiasing.
pub fn table() -> Result<String> {
    let titles = ["roughness", "1 sample, off", "1 sample, on", "4 samples, off", "4 samples, on"];
    let mut text = row(&titles.map(String::from));
    text += "| --: | --: | --: | --: | --: |\n";
    let mut scene = jue::scene(1024);
    for roughness in ROUGHNESS {
        scene.edit(|scene| {
            for material in &mut scene.materials {
                (material.roughness, material.metallic) = (roughness, 1.0);
                material.metallic_roughness_texture = None;
            }
        })?;
        let errors = errors(&scene)?;
        let mut cells = vec![format!("{roughness}")];
        cells.extend(errors.map(|error| format!("{:.1} %", error * 100.0)));
        text += &row(&cells);
    }
    Ok(text)
}

fn errors(scene: &Scene) -> Result<[f64; 4]> {
    let bounds = scene.bounds().expect("the vessel has triangles");
    let reach = bounds.diagonal() / 2.0;
    let orbit =
        Orbit { azimuth: 0.4, elevation: 0.25, distance: reach * 4.0, target: bounds.center(), fov_y: 0.5 };
    let camera = orbit.camera(reach);
    let lighting = lamp(&camera);
    let settings = RenderSettings { width: SIDE, height: SIDE, ..RenderSettings::default() };
    let prepared = Prepared::new(scene.clone(), &settings.surface)?;
    let paths = ReferenceSettings { spp: SPP, bounces: 0, ..ReferenceSettings::default() };
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let truth = reference(&prepared, &shot, &paths, Progress::SILENT)?.color;
    let mut errors = [0.0; 4];
    for (error, (samples, specular_aa)) in
        errors.iter_mut().zip([(1, false), (1, true), (4, false), (4, true)])
    {
        let settings = RenderSettings { samples, specular_aa, ..settings.clone() };
        let ours =
            Pass::new(&prepared, &Shot { settings: &settings, ..shot })?.render(Progress::SILENT)?.color;
        *error = relative_error(&ours, &truth);
    }
    Ok(errors)
}

fn lamp(camera: &Camera) -> Lighting {
    let direction = -from_view(camera, -0.7, 0.5);
    let kind = LightKind::Directional { direction };
    let light = Light { name: String::new(), kind, color: Vec3::splat(3.0), falloff: Falloff::None };
    Lighting { lights: vec![light], ..Lighting::default() }
}

/// Returns the root mean square error of radiance over fully covered pixels, relative to its root mean square.
fn relative_error(ours: &Image, truth: &Image) -> f64 {
    let (mut error, mut light) = (0.0, 0.0);
    for (a, b) in ours.pixels().iter().zip(truth.pixels()).filter(|(a, b)| a[3] == 1.0 && b[3] > 0.999) {
        for c in 0..3 {
            error += f64::from(a[c] - b[c]).squared();
            light += f64::from(b[c]).squared();
        }
    }
    (error / light).sqrt()
}
