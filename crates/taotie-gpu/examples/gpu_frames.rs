//! Frames per second on a GPU and on the CPU: `make bench-gpu`.
//!
//! ```text
//! cargo run --release -p taotie-gpu --example gpu_frames -- [--quick] [--adapter NAME]
//! ```
//!
//! A rotating sphere with bosses: four maps of 2048², `ggx`, one light, one sample per pixel. All pixels of each
//! frame end up as 8-bit sRGB in memory, so a GPU's frames are read back and developed. The two machines alternate, a
//! frame each. The table has the medians. `--quick` skips 4K and 2 million triangles; `--adapter` selects a GPU by a
//! part of its name.

#![allow(clippy::print_stdout, reason = "an example prints")]

#[path = "../../../tests/common/scenes.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod scenes;

use std::time::{Duration, Instant};
use taotie_engine::film::Development;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{Lighting, Prepared, RenderSettings, Renderer, Shot};
use taotie_engine::scene::{NormalSpace, Scene};
use taotie_engine::{Error, Progress};
use taotie_gpu::{AdapterChoice, Gpu, GpuRenderer};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Side length of each of the four textures, in texels.
const TEXTURE_SIZE: u32 = 2048;

/// The widths and heights of images: 1024² and 4K.
const SIZES: [[u32; 2]; 2] = [[1024, 1024], [3840, 2160]];

/// Columns and rows of spheres with 2 thousand, 200 thousand and 2 million triangles.
const SPHERES: [[usize; 2]; 3] = [[46, 23], [448, 224], [1416, 708]];

/// The maximum and minimum number of timed frames per machine, and the time after which no more are started.
const FRAMES: usize = 15;
const FEWEST: usize = 3;
const ENOUGH: Duration = Duration::from_secs(6);

/// Degrees between frames.
const STEP: f64 = 2.0;

/// The command-line options.
#[derive(Default)]
struct Options {
    quick: bool,
    choice: AdapterChoice,
}

/// The median frame time of each machine, in seconds.
struct Medians {
    processor: f64,
    graphics: f64,
}

/// A scene prepared for both machines.
struct Studio<'s> {
    renderer: Renderer,
    graphics: GpuRenderer<'s>,
    lighting: Lighting,
    settings: RenderSettings,
    codes: Vec<[u8; 4]>,
}

fn main() -> Result<()> {
    let options = options(std::env::args().skip(1))?;
    let gpu = Gpu::find(&options.choice)?;
    let adapter = gpu.description();
    println!("GPU: {} through {}, {}", adapter.name, adapter.backend, adapter.driver);
    println!("CPU: {} threads\n", rayon::current_num_threads());
    println!("| triangles | pixels | shadows | CPU, ms | GPU, ms | frames per second |");
    println!("|---:|---|---|---:|---:|---:|");
    let (spheres, sizes) = if options.quick { (2, 1) } else { (SPHERES.len(), SIZES.len()) };
    for sphere in &SPHERES[..spheres] {
        let scene = scene(*sphere)?;
        let prepared = Prepared::new(scene.clone(), &RenderSettings::default().surface)?;
        let mut studio = Studio::new(scene, GpuRenderer::new(&gpu, &prepared)?)?;
        for [width, height] in &SIZES[..sizes] {
            for shadows in [false, true] {
                (studio.settings.width, studio.settings.height) = (*width, *height);
                studio.settings.shadows = shadows;
                studio.print_row()?;
            }
        }
    }
    Ok(())
}

fn options(mut args: impl Iterator<Item = String>) -> Result<Options> {
    let mut options = Options::default();
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--quick" => options.quick = true,
            "--adapter" => options.choice.name = args.next(),
            _ => return Err(Error::invalid(arg, "expected [--quick] [--adapter NAME]").into()),
        }
    }
    Ok(options)
}

fn scene([columns, rows]: [usize; 2]) -> Result<Scene> {
    let mut scene = scenes::embossed_sphere_with(NormalSpace::Tangent, TEXTURE_SIZE, TEXTURE_SIZE);
    scene.edit(|scene| scene.meshes = vec![Mesh::sphere(1.0, columns, rows)])?;
    Ok(scene)
}

impl<'s> Studio<'s> {
    fn new(scene: Scene, graphics: GpuRenderer<'s>) -> Result<Self> {
        let settings = RenderSettings { samples: 1, ..RenderSettings::default() };
        let lights = vec![scenes::directional(Vec3::new(0.6, -1.0, -0.7), 1.2)];
        let lighting = Lighting { lights, ambient: Vec3::splat(0.08), environment: None };
        let renderer = Renderer::new(scene, &settings.surface)?;
        Ok(Self { renderer, graphics, lighting, settings, codes: Vec::new() })
    }

    fn print_row(&mut self) -> Result<()> {
        let Medians { processor, graphics } = self.medians()?;
        let RenderSettings { width, height, shadows, .. } = self.settings;
        let triangles = self.renderer.prepared().scene().triangle_count();
        println!(
            "| {triangles} | {width}×{height} | {} | {:.1} | {:.1} | {:.1} and {:.1} |",
            if shadows { "yes" } else { "no" },
            1e3 * processor,
            1e3 * graphics,
            1.0 / processor,
            1.0 / graphics
        );
        Ok(())
    }

    /// Times frames of both machines in alternation, after an untimed one each.
    fn medians(&mut self) -> Result<Medians> {
        let (mut processor, mut graphics) = (Vec::new(), Vec::new());
        let mut begun = Instant::now();
        for frame in 0..=FRAMES {
            let camera = scenes::camera(25.0 + STEP * frame as f64, 20.0, 3.29);
            let shot = Shot { camera: &camera, lighting: &self.lighting, settings: &self.settings };
            let development = Development::default();
            let start = Instant::now();
            self.renderer.develop(&shot, &development, &mut self.codes, Progress::SILENT)?;
            let between = Instant::now();
            self.graphics.develop(&shot, &development, &mut self.codes, Progress::SILENT)?;
            if frame == 0 {
                begun = Instant::now();
                continue;
            }
            processor.push((between - start).as_secs_f64());
            graphics.push(between.elapsed().as_secs_f64());
            if frame >= FEWEST && begun.elapsed() > ENOUGH {
                break;
            }
        }
        Ok(Medians { processor: median(processor), graphics: median(graphics) })
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}
