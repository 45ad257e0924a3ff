//! The rectangle with the estimated maps: written as GLB, read, and rendered from the front.

use crate::accuracy::estimate;
use crate::studio::{Finish, Shooting, photograph, relief};
use taotie_engine::Warnings;
use taotie_engine::compare::angular_error;
use taotie_engine::math::Vec3;
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Orbit, Projection};
use taotie_io::Limits;
use taotie_photometric::Estimator;

#[test]
fn the_glb_shows_the_estimated_normals() {
    let shooting = Shooting { side: 48, lights: 12, ..Shooting::default() };
    let estimate = estimate(&photograph(relief(0.6), &Finish::matt(0.5), shooting));
    let mut warnings = Warnings::default();
    let glb =
        taotie_io::encode_scene(&estimate.plane(1.0).unwrap(), &["plane".to_owned()], &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{:?}", warnings.list());
    let scene = taotie_io::load_glb(glb, &Limits::default()).unwrap().scene;
    let orbit = Orbit { azimuth: 0.0, elevation: 0.0, distance: 5.0, target: Vec3::splat(0.0), fov_y: 0.5 };
    let projection = Projection::Orthographic { half_width: 0.5, half_height: 0.5, near: 0.1, far: 20.0 };
    let camera = Camera { projection, ..orbit.camera(1.0) };
    let settings =
        RenderSettings { width: 48, height: 48, samples: 1, aovs: true, ..RenderSettings::default() };
    let lighting = Lighting::default();
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let shown = render(&scene, &shot).unwrap().aovs.unwrap().normals;
    let angles = angular_error(&shown, &estimate.normals(Estimator::Best)).unwrap().summary().unwrap();
    assert!(angles.count > 2000 && angles.median < 0.05 && angles.p95 < 1.0, "{angles:?}");
}

#[test]
fn the_relief_has_the_shape_of_the_object() {
    let shooting = Shooting { side: 64, lights: 16, ..Shooting::default() };
    let estimate = estimate(&photograph(relief(0.6), &Finish::matt(0.5), shooting));
    let found = estimate.relief(taotie_engine::Progress::SILENT).unwrap();
    // The test's relief is 2 units across 64 pixels, all but a hundredth of it in the picture.
    let pixel = 2.0 * 0.99 / 64.0;
    let scene = estimate.surface(&found, pixel).unwrap().unwrap();
    let mut warnings = Warnings::default();
    let glb = taotie_io::encode_scene(&scene, &["relief".to_owned()], &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{:?}", warnings.list());
    let scene = taotie_io::load_glb(glb, &Limits::default()).unwrap().scene;
    let mesh = &scene.meshes()[0];
    assert!(mesh.triangles().len() > 7000, "{}", mesh.triangles().len());
    let truth = relief(0.6);
    // The nearest vertex of the true relief, which has 160 by 160 on the square from -1 to 1.
    let height = |x: f64, y: f64| {
        let [i, j] = [x, y].map(|v| ((v + 1.0) * 79.5 + 0.5).clamp(0.0, 159.0) as usize);
        f64::from(truth.positions()[j * 160 + i].z)
    };
    let pairs: Vec<[f64; 2]> =
        mesh.positions().iter().map(|p| [f64::from(p.z), height(f64::from(p.x), f64::from(p.y))]).collect();
    let count = pairs.len() as f64;
    let mean = [0, 1].map(|c| pairs.iter().map(|pair| pair[c]).sum::<f64>() / count);
    let spread =
        |v: &dyn Fn(&[f64; 2]) -> f64| (pairs.iter().map(|p| v(p) * v(p)).sum::<f64>() / count).sqrt();
    let error = spread(&|[a, b]| a - b - mean[0] + mean[1]);
    let depth = spread(&|[_, b]| b - mean[1]);
    assert!(error < 0.15 * depth, "{error} of {depth}");
}
