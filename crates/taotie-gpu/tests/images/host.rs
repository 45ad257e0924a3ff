//! The example of a custom host draws the same image as the CPU.

#[path = "../../examples/wgpu_host.rs"]
#[allow(dead_code, reason = "its `main` is unused here")]
mod wgpu_host;

use crate::compared::gpu;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::pixel::LightSource;
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Projection, Scene, preset};

const SIZE: u32 = 128;

#[test]
fn the_example_of_a_host_draws_what_the_processor_draws() {
    if gpu().is_none() {
        return;
    }
    let (mesh, material) = (Mesh::sphere(0.9, 96, 48), preset("bronze").expect("it exists"));
    let kind = LightKind::Directional { direction: Vec3::new(0.48, -0.64, -0.6) };
    let light = Light { name: String::new(), kind, color: Vec3::splat(3.0), falloff: Falloff::None };
    let source = LightSource::new(&light);
    let view = wgpu_host::View { mesh: &mesh, material: &material, light: source, size: SIZE };
    let found = view.draw().expect("it draws");

    let projection = Projection::Orthographic { half_width: 1.0, half_height: 1.0, near: 0.1, far: 10.0 };
    let world_from_view = Mat4::translation(Vec3::new(0.0, 0.0, 3.0));
    let camera = Camera { name: String::new(), world_from_view, projection };
    let lighting = Lighting { lights: vec![light], ambient: Vec3::splat(0.0), environment: None };
    let settings =
        RenderSettings { width: SIZE, height: SIZE, samples: 1, shadows: false, ..RenderSettings::default() };
    let scene = Scene::of_mesh(mesh.clone(), material.clone()).expect("the scene is valid");
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let frame = render(&scene, &shot).expect("it renders");

    let both = frame.color.pixels().iter().zip(&found).filter(|(a, b)| a[3] == 1.0 && b[3] == 1.0);
    let differences: Vec<f32> =
        both.flat_map(|(a, b)| (0..3).map(move |i| (a[i] - b[i]).abs() / a[i].max(0.01))).collect();
    let mean = differences.iter().sum::<f32>() / differences.len() as f32;
    assert!(differences.len() > 3 * 9000, "{} numbers", differences.len());
    assert!(mean < 1e-3, "{mean}");
}
