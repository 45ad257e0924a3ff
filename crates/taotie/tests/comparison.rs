//! Comparisons of surfaces with known normals: their results, the errors for invalid options, and cancellation.

#[path = "../examples/compare.rs"]
mod example;

use std::sync::Mutex;
use taotie::comparison::{Comparison, ComparisonOptions, Method, SamplePoints, Subject};
use taotie_engine::film::Development;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::render::RenderSettings;
use taotie_engine::scene::{Camera, Material, Orbit, Scene};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_engine::{Error, Progress};

fn ball() -> Scene {
    Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default()).unwrap()
}

fn options() -> ComparisonOptions {
    ComparisonOptions {
        methods: vec![SurfaceMethod::Smooth.into(), SurfaceMethod::TangentNormal.into()],
        settings: RenderSettings { width: 64, height: 64, samples: 1, ..RenderSettings::default() },
        ..ComparisonOptions::default()
    }
}

#[test]
fn the_example_finds_the_angle_of_facets() {
    example::main().expect("both methods can be drawn");
    let figures = example::compare().expect("both methods can be drawn");
    let [(facet, facets), (smooth, vertices)] = figures.as_slice() else { panic!("{figures:?}") };
    assert_eq!((facet.as_str(), smooth.as_str()), ("facet", "smooth"));
    // Facets of 15° by 15° are off by up to 10.6° at their corners, and by 0 in the middle.
    assert!((3.0..6.0).contains(facets), "{facets}");
    assert!(*vertices < 0.5, "{vertices}");
}

#[test]
fn a_method_without_its_map_is_skipped_with_the_reason() {
    let scene = ball();
    let comparison = Comparison::of(&Subject::new("ball", &scene), &options(), Progress::SILENT).unwrap();
    let report = comparison.report();
    assert_eq!((report.against.as_str(), report.methods.len(), report.points.len()), ("smooth", 1, 10));
    let [skipped] = report.skipped.as_slice() else { panic!("{:?}", report.skipped) };
    assert!(skipped.method == "tangent-normal" && skipped.reason.contains("normal map"), "{skipped:?}");
}

#[test]
fn models_are_measured_against_the_baseline_of_the_same_surface() {
    let scene = ball();
    let shadings = vec![Shading::Lambert, Shading::Ggx, Shading::Phong];
    let methods = [SurfaceMethod::Facet, SurfaceMethod::Smooth].map(Method::from).to_vec();
    let options = ComparisonOptions { shadings, baseline: Some(Shading::Ggx), methods, ..options() };
    let comparison = Comparison::of(&Subject::new("ball", &scene), &options, Progress::SILENT).unwrap();
    for surface in &comparison.surfaces {
        let picture = |shading: Shading| &surface.pictures.iter().find(|(of, _)| *of == shading).unwrap().1;
        let models: Vec<Shading> = surface.model_differences.iter().map(|model| model.shading).collect();
        assert_eq!(models, [Shading::Lambert, Shading::Phong]);
        for model in &surface.model_differences {
            let [expected, found] = [Shading::Ggx, model.shading].map(picture);
            let rmse = taotie_engine::compare::rmse_within(expected, found, &comparison.covered).unwrap();
            assert!(model.picture.rmse == rmse && rmse > 0.0, "{rmse}");
        }
    }
    let report = comparison.report();
    assert_eq!(report.parameters.baseline.as_deref(), Some("ggx"));
    let names: Vec<&str> = report.methods[1].models.iter().map(|m| m.difference.flip_map.as_str()).collect();
    assert_eq!(names, ["smooth.lambert-ggx.flip.png", "smooth.phong-ggx.flip.png"]);
    let plain = Comparison::of(&Subject::new("ball", &scene), &self::options(), Progress::SILENT).unwrap();
    assert!(plain.surfaces.iter().all(|surface| surface.model_differences.is_empty()));
}

/// Returns a camera that sees the whole ball.
fn front() -> Camera {
    let (target, fov_y) = (Vec3::splat(0.0), 40f64.to_radians());
    Orbit { azimuth: 0.0, elevation: 0.0, distance: 4.0, target, fov_y }.camera(2.0)
}

#[test]
fn the_background_is_in_no_figure_of_pictures() {
    let scene = ball();
    let methods = [SurfaceMethod::Facet, SurfaceMethod::Smooth].map(Method::from).to_vec();
    let figures = |width: u32| {
        let settings = RenderSettings { width, height: 64, samples: 4, ..RenderSettings::default() };
        let options =
            ComparisonOptions { settings, camera: Some(front()), methods: methods.clone(), ..options() };
        let comparison = Comparison::of(&Subject::new("ball", &scene), &options, Progress::SILENT).unwrap();
        let covered = comparison.covered.iter().filter(|covered| **covered).count();
        let figures = comparison.report().methods[1].pictures[0].difference.clone().unwrap();
        assert_eq!((figures.pixels, figures.flip.unwrap().count), (covered, covered));
        figures
    };
    let (narrow, wide) = (figures(64), figures(192));
    assert_eq!(narrow.pixels, wide.pixels, "the same ball with more background");
    let flip = |figures: &taotie::comparison::PictureFigures| figures.flip.unwrap().mean;
    for (a, b) in [(narrow.rmse, wide.rmse), (narrow.ssim, wide.ssim), (flip(&narrow), flip(&wide))] {
        assert!((a - b).abs() < 0.01 * a, "{a} with little background, {b} with much");
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let scene = ball();
    let factor = Method { surface: SurfaceMethod::Smooth, factor: Some(5.0) };
    let transparent = Development::default();
    let endless = RenderSettings { width: u32::MAX, height: u32::MAX, ..RenderSettings::default() };
    let wrong = [
        (ComparisonOptions { methods: Vec::new(), ..options() }, "at least one"),
        (ComparisonOptions { methods: vec![factor], ..options() }, "only bump and bump-printed"),
        (ComparisonOptions { methods: vec![SurfaceMethod::Bump.into()], ..options() }, "none of the methods"),
        (
            ComparisonOptions { baseline: Some(Shading::Ggx), ..options() },
            "the baseline ggx: there is nothing",
        ),
        (ComparisonOptions { baseline: Some(Shading::Phong), ..options() }, "the baseline phong"),
        (ComparisonOptions { settings: endless, ..options() }, "4294967295"),
        (ComparisonOptions { development: transparent, ..options() }, "over a background"),
        (ComparisonOptions { points: SamplePoints::Pixels(vec![[64, 0]]), ..options() }, "64,0"),
    ];
    for (options, why) in wrong {
        let error = Comparison::of(&Subject::new("ball", &scene), &options, Progress::SILENT);
        let error = error.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(why), "{why}: {error}");
    }
    let nothing = Scene::default();
    assert!(Comparison::of(&Subject::new("nothing", &nothing), &options(), Progress::SILENT).is_err());
}

#[test]
fn a_reference_elsewhere_is_warned_about() {
    let (scene, mut elsewhere) = (ball(), ball());
    let moved = Mat4::translation(taotie_engine::math::Vec3::new(3.0, 0.0, 0.0));
    elsewhere.edit(|scene| scene.instances[0].world_from_object = moved).unwrap();
    let subject = Subject::new("ball", &scene).with_reference("other.ply", &elsewhere);
    let comparison = Comparison::of(&subject, &options(), Progress::SILENT).unwrap();
    let warnings = comparison.report().warnings;
    assert!(warnings[0].what.starts_with("other.ply: position or size differs"), "{warnings:?}");
}

#[test]
fn progress_rises_to_the_end_and_stops_the_work() {
    let scene = ball();
    let subject = Subject::new("ball", &scene).with_reference("itself", &scene);
    let heard = Mutex::new(Vec::new());
    let listener = |stage: &'static str, done: f64| {
        assert_eq!(stage, "compare");
        heard.lock().unwrap().push(done);
        true
    };
    let all = ComparisonOptions { methods: vec![SurfaceMethod::Smooth.into()], ..options() };
    Comparison::of(&subject, &all, Progress::new(&listener)).unwrap();
    let heard = heard.into_inner().unwrap();
    assert!(heard.len() > 4 && heard.is_sorted(), "{heard:?}");
    let half = |_: &'static str, done: f64| done < 0.5;
    let stopped = Comparison::of(&subject, &all, Progress::new(&half));
    assert!(matches!(stopped, Err(Error::Cancelled)));
}
