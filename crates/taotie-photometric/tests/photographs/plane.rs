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
        taotie_io::encode_scene(&estimate.plane().unwrap(), &["plane".to_owned()], &mut warnings).unwrap();
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
