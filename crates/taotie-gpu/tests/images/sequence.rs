//! Consecutive images, rejected features, and reported progress.

use crate::compared::{Difference, View, gpu, lit};
use crate::{finishes, scenes};
use std::sync::Mutex;
use std::time::Instant;
use taotie_engine::Progress;
use taotie_engine::film::{Development, ToneCurve, develop8};
use taotie_engine::math::Vec3;
use taotie_engine::scene::NormalSpace;
use taotie_gpu::{Gpu, GpuError, GpuRenderer};

fn bosses() -> View {
    View::new("bosses", scenes::embossed_sphere(NormalSpace::Tangent), scenes::camera(20.0, 15.0, 3.4))
}

/// The image of a new renderer.
fn fresh(gpu: &Gpu, view: &View) -> Vec<[f32; 4]> {
    let prepared = view.prepared();
    let mut renderer = GpuRenderer::new(gpu, &prepared).unwrap();
    renderer.render(&view.shot(), Progress::SILENT).unwrap().color.pixels().to_vec()
}

#[test]
fn what_was_rendered_before_changes_no_bit() {
    let Some(gpu) = gpu() else { return };
    let scene = scenes::panes();
    let one = lit(vec![scenes::directional(Vec3::new(0.5, -1.0, -0.4), 2.0)]);
    let view = |azimuth, change: fn(&mut taotie_engine::render::RenderSettings)| {
        View::new("panes", scene.clone(), scenes::camera(azimuth, 10.0, 4.0)).with(change)
    };
    let mut dim = view(70.0, |settings| settings.width = 131);
    dim.lighting = one;
    let shadowed = view(20.0, |settings| settings.shadows = true);
    let views = [view(20.0, |settings| settings.samples = 4), dim, view(20.0, |_| ()).under_sky(), shadowed];
    let prepared = views[0].prepared();
    let mut renderer = GpuRenderer::new(&gpu, &prepared).unwrap();
    for view in views.iter().chain(&views) {
        let kept = renderer.render(&view.shot(), Progress::SILENT).unwrap();
        assert!(kept.color.pixels() == fresh(&gpu, view), "{:?}", view.settings);
    }
}

#[test]
fn images_are_developed_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    let view = bosses();
    let prepared = view.prepared();
    let mut renderer = GpuRenderer::new(&gpu, &prepared).unwrap();
    let frame = renderer.render(&view.shot(), Progress::SILENT).unwrap();
    let background = Some(Vec3::new(0.2, 0.4, 0.1));
    let development = Development { tone: ToneCurve::Aces, background, ..Development::default() };
    let mut codes = Vec::new();
    renderer.develop(&view.shot(), &development, &mut codes, Progress::SILENT).unwrap();
    assert!(codes == develop8(&frame.color, &development).unwrap());
}

#[test]
fn output_variables_and_empty_images_are_refused() {
    let Some(gpu) = gpu() else { return };
    let view = bosses();
    let prepared = view.prepared();
    let mut renderer = GpuRenderer::new(&gpu, &prepared).unwrap();
    let aovs = bosses().with(|settings| settings.aovs = true);
    let refused = renderer.render(&aovs.shot(), Progress::SILENT).unwrap_err();
    assert!(matches!(refused, GpuError::Unsupported { .. }), "{refused}");
    let empty = bosses().with(|settings| settings.width = 0);
    let refused = renderer.render(&empty.shot(), Progress::SILENT).unwrap_err();
    assert!(matches!(refused, GpuError::Scene(_)), "{refused}");
}

#[test]
fn who_cancels_gets_no_image_and_may_ask_again() {
    let Some(gpu) = gpu() else { return };
    let view = bosses();
    let prepared = view.prepared();
    let mut renderer = GpuRenderer::new(&gpu, &prepared).unwrap();
    let stop = |_: &'static str, _: f64| false;
    let cancelled = renderer.render(&view.shot(), Progress::new(&stop)).unwrap_err();
    assert!(matches!(cancelled, GpuError::Scene(taotie_engine::Error::Cancelled)), "{cancelled}");
    let again = renderer.render(&view.shot(), Progress::SILENT).unwrap();
    assert!(again.color.pixels() == fresh(&gpu, &view));
}

/// Alpha, which no shader of an opaque surface changes.
#[test]
fn silhouettes_are_those_of_the_processor() {
    let Some(gpu) = gpu() else { return };
    for samples in [1, 4, 16] {
        let floor = scenes::floor_and_mirrored_spheres();
        let view = View::new("floor", floor, scenes::camera(30.0, 8.0, 4.0))
            .with(|settings| settings.samples = samples);
        let expected = taotie_engine::render::render(&view.scene, &view.shot()).unwrap();
        let found = fresh(&gpu, &view);
        let pairs = expected.color.pixels().iter().zip(&found);
        let apart = pairs.filter(|(a, b)| (a[3] - b[3]).abs() > 1e-3).count();
        assert!(apart * 2000 < found.len(), "{samples} samples: {apart} of {} pixels", found.len());
    }
}

/// The measure of differences detects a roughness that is a tenth off.
#[test]
fn the_measure_finds_what_is_wrong() {
    let Some(_) = gpu() else { return };
    let image = |roughness: f32| {
        let view =
            View::new("metal", finishes::polished_bosses(1.0, roughness), scenes::camera(20.0, 15.0, 3.4));
        let frame = taotie_engine::render::render(&view.scene, &view.shot()).unwrap();
        develop8(&frame.color, &Development::default()).unwrap()
    };
    let Difference { mean, outliers, .. } = Difference::of(&image(0.3), &image(0.33));
    assert!(mean > 0.5 && outliers > 0.001, "{mean} {outliers}");
}

/// Samples are reported when they are done, not when they are submitted, so that a progress bar shows the work.
#[test]
fn progress_follows_the_work() {
    let Some(gpu) = gpu() else { return };
    let view = bosses().with(|settings| settings.samples = 16);
    let prepared = view.prepared();
    let mut renderer = GpuRenderer::new(&gpu, &prepared).unwrap();
    // The first image also compiles the shaders.
    renderer.render(&view.shot(), Progress::SILENT).unwrap();
    let (start, heard) = (Instant::now(), Mutex::new(Vec::new()));
    let listener = |_: &'static str, done: f64| {
        heard.lock().unwrap().push((done, start.elapsed().as_secs_f64()));
        true
    };
    renderer.render(&view.shot(), Progress::new(&listener)).unwrap();
    let (heard, whole) = (heard.into_inner().unwrap(), start.elapsed().as_secs_f64());
    assert!(heard.len() > 16 && heard.is_sorted_by(|a, b| a.0 <= b.0), "{heard:?}");
    assert_eq!(heard.last().unwrap().0, 1.0);
    let (_, at) = *heard.iter().find(|(done, _)| *done >= 0.5).unwrap();
    // A fast GPU needs most of its time for reading the image back.
    assert!(whole < 0.2 || at > 0.2 * whole, "half of the work after {at} s of {whole} s");
}
