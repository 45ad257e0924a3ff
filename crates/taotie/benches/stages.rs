//! Milliseconds per stage of a fixed image: an embossed sphere under one light, by `ggx`, at one sample per pixel.
//!
//! Everything except `whole-frame-all-threads` runs on one thread, so that `clip-and-bin`, `raster`, `texture` and
//! `shade` add up to `whole-frame`, except for the resolve into the image; `film` comes after it.

#![allow(missing_docs, reason = "criterion's macros generate public functions")]

#[path = "../../../tests/common/scenes.rs"]
#[allow(dead_code, reason = "the golden images use the rest")]
mod scenes;

use criterion::{
    BenchmarkGroup, Criterion, SamplingMode, criterion_group, criterion_main, measurement::WallTime,
};
use std::hint::black_box;
use std::time::{Duration, Instant};
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop8};
use taotie_engine::math::Vec3;
use taotie_engine::raster::{Tile, TilePlane, TileSample};
use taotie_engine::render::{Lighting, Pass, Prepared, RenderSettings, Shot, Stages, VisibleSpan, batches};
use taotie_engine::scene::{Camera, NormalSpace};

/// Side length of each of the four textures, in texels.
const TEXTURE_SIZE: u32 = 2048;

/// From here, the unit sphere covers about 60 % of the image.
const DISTANCE: f64 = 3.29;

/// The times of the stages of one image.
#[derive(Default)]
struct Times {
    raster: Duration,
    texture: Duration,
    shade: Duration,
    /// The number of pixels that show the sphere.
    fragments: usize,
}

/// Runs the stages like the renderer, batch by batch, so that each finds its data in the caches.
fn stages(stages: &Stages<'_>) -> Times {
    let mut times = Times::default();
    let mut plane = TilePlane::default();
    let mut batch = stages.batch();
    for index in 0..stages.tile_count() {
        let tile = Tile::new(stages.viewport(), index);
        let at = TileSample { tile: &tile, offset: stages.viewport().pattern.offsets()[0] };
        let start = Instant::now();
        let visible = stages.visible(at, &mut plane).expect("the SIMD level is supported");
        times.raster += start.elapsed();
        times.fragments += visible.iter().map(VisibleSpan::len).sum::<usize>();
        for (draw, visible) in stages.runs(&visible) {
            for visible in batches(visible) {
                let start = Instant::now();
                stages.gather(at, draw, visible, &mut batch);
                let gathered = Instant::now();
                stages.light(draw, &mut batch);
                times.texture += gathered - start;
                times.shade += gathered.elapsed();
                black_box(&batch);
            }
        }
    }
    times
}

fn camera() -> Camera {
    scenes::camera(25.0, 20.0, DISTANCE)
}

fn lighting() -> Lighting {
    Lighting {
        lights: vec![scenes::directional(Vec3::new(0.6, -1.0, -0.7), 1.2)],
        ambient: Vec3::splat(0.08),
        environment: None,
    }
}

/// Measures every stage for a sphere of about `2 · columns · rows` triangles.
fn sphere(criterion: &mut Criterion, name: &str, columns: usize, rows: usize) {
    let mut scene = scenes::embossed_sphere_with(NormalSpace::Tangent, TEXTURE_SIZE, TEXTURE_SIZE);
    let mesh = taotie_engine::mesh::Mesh::sphere(1.0, columns, rows);
    scene.edit(|scene| scene.meshes = vec![mesh]).expect("the sphere is valid");
    let settings = RenderSettings { samples: 1, ..RenderSettings::default() };
    let prepared = Prepared::new(scene, &settings.surface).expect("the scene is valid");
    let (camera, lighting) = (camera(), lighting());
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let new_pass = || Pass::new(&prepared, &shot).expect("the settings are valid");
    let frame = || new_pass().render(Progress::SILENT).expect("the image fits");

    let pass = new_pass();
    let covered = stages(pass.stages()).fragments as f64 / f64::from(settings.width * settings.height);
    assert!((0.55..0.65).contains(&covered), "the sphere covers {covered} of the image");

    let mut group = group(criterion, name);
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread is available");
    group.bench_function("clip-and-bin", |b| b.iter(|| one_thread.install(new_pass)));
    let mut stage = |name: &str, time: fn(&Times) -> Duration| {
        let run = || time(&one_thread.install(|| stages(pass.stages())));
        group.bench_function(name, |b| b.iter_custom(|count| (0..count).map(|_| run()).sum()));
    };
    stage("raster", |times| times.raster);
    stage("texture", |times| times.texture);
    stage("shade", |times| times.shade);
    let color = frame().color;
    let film = || develop8(&color, &Development::default());
    group.bench_function("film", |b| b.iter(|| one_thread.install(film)));
    group.bench_function("whole-frame", |b| b.iter(|| one_thread.install(frame)));
    group.bench_function("whole-frame-all-threads", |b| b.iter(frame));
    group.finish();
}

fn group<'c>(criterion: &'c mut Criterion, name: &str) -> BenchmarkGroup<'c, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .sampling_mode(SamplingMode::Flat)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(3));
    group
}

fn few_triangles(criterion: &mut Criterion) {
    sphere(criterion, "sphere-2k", 46, 23);
}

fn many_triangles(criterion: &mut Criterion) {
    sphere(criterion, "sphere-200k", 448, 224);
}

criterion_group!(benches, few_triangles, many_triangles);
criterion_main!(benches);
