//! Milliseconds per frame of a rotating model: Taotie's part in `make bench`.
//!
//! ```text
//! cargo run --release -p taotie --example frames -- model.glb --environment room.hdr --frames 20
//! ```
//!
//! The model is read and prepared once. It is seen by the file's first camera under the file's lights. From frame to
//! frame it rotates by 0.01 radians about +y (camera, lights and environment rotate the other way), is drawn and
//! developed to 8-bit sRGB on an opaque background, comparable to reading back a GPU's frame. Prints one line of JSON
//! with the times. `--keep FILE` writes the filtered environment, which `--environment` also accepts. With `--ask` it
//! waits for lines `WIDTH HEIGHT FRAMES [PNG]` and answers each in this format.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use taotie_engine::Progress;
use taotie_engine::film::{Development, ToneCurve};
use taotie_engine::image::Encoding;
use taotie_engine::math::{Mat4, SimdLevel, Vec3};
use taotie_engine::names::Named;
use taotie_engine::render::{EnvironmentLight, GrazingNormals, Lighting, RenderSettings, Renderer, Shot};
use taotie_engine::scene::{Camera, LightKind, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_engine::shade::{Energy, Shading};
use taotie_engine::{Error, Result};
use taotie_io::{PngColor, PngImage, PngSamples};

/// Radians between frames, counter-clockwise as seen from above.
const STEP: f64 = 0.01;

/// The maximum number of untimed frames before the timed ones, and the milliseconds after which no more are started.
const WARM_UP: usize = 3;
const WARM_ENOUGH: f64 = 300.0;

/// The background of the model: about the codes 13, 13, 15.
const BACKGROUND: Vec3 = Vec3::new(0.004_025, 0.004_025, 0.004_777);

const USAGE: &str = "frames MODEL [--shading NAME] [--environment FILE] [--keep FILE] [--ambient X] [--width N] \
    [--height N] [--frames N] [--threads N] [--simd NAME] [--plain] [--png FILE] [--ask]";

/// The command-line options.
struct Options {
    model: PathBuf,
    /// An image, or a filtered environment written by `--keep`.
    environment: Option<PathBuf>,
    /// The file for the filtered environment, for another run.
    keep: Option<PathBuf>,
    ambient: f32,
    threads: usize,
    settings: RenderSettings,
    ask: bool,
    frames: usize,
    png: Option<PathBuf>,
}

/// The frames timed together.
struct Request {
    width: u32,
    height: u32,
    frames: usize,
    /// The file for one more frame, not rotated.
    png: Option<PathBuf>,
}

fn main() -> Result<()> {
    let options = options(std::env::args().skip(1))?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build();
    let pool = pool.map_err(|e| Error::invalid(format!("{} threads", options.threads), e.to_string()))?;
    pool.install(|| run(&options))
}

fn options(mut args: impl Iterator<Item = String>) -> Result<Options> {
    let mut options = Options {
        model: PathBuf::new(),
        environment: None,
        keep: None,
        ambient: 0.0,
        threads: 0,
        settings: RenderSettings { samples: 1, ..RenderSettings::default() },
        ask: false,
        frames: 20,
        png: None,
    };
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| Error::invalid(arg.as_str(), USAGE));
        let settings = &mut options.settings;
        match arg.as_str() {
            "--shading" => settings.shading = Shading::from_name(&value()?)?,
            "--environment" => options.environment = Some(value()?.into()),
            "--keep" => options.keep = Some(value()?.into()),
            "--ambient" => options.ambient = number(&value()?)?,
            "--width" => settings.width = number(&value()?)?,
            "--height" => settings.height = number(&value()?)?,
            "--frames" => options.frames = number(&value()?)?,
            "--threads" => options.threads = number(&value()?)?,
            "--simd" => settings.surface.simd = SimdLevel::from_name(&value()?)?,
            "--png" => options.png = Some(value()?.into()),
            "--ask" => options.ask = true,
            "--plain" => plain(settings),
            _ if !arg.starts_with('-') && options.model.as_os_str().is_empty() => options.model = arg.into(),
            _ => return Err(Error::invalid(arg, USAGE)),
        }
    }
    Ok(options)
}

/// Disables everything that other renderers do not do.
fn plain(settings: &mut RenderSettings) {
    settings.energy = Energy::Single;
    settings.specular_aa = false;
    settings.grazing_normals = GrazingNormals::Keep;
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T> {
    text.parse().map_err(|_| Error::invalid(text, USAGE))
}

fn run(options: &Options) -> Result<()> {
    let scene = taotie_io::load_model(&options.model)?.scene;
    let camera =
        scene.cameras().first().cloned().ok_or_else(|| Error::invalid("model", "it has no camera"))?;
    let lighting = lighting(options, &scene)?;
    let renderer = Renderer::new(scene, &options.settings.surface)?;
    let mut studio =
        Studio { renderer, camera, lighting, settings: options.settings.clone(), codes: Vec::new() };
    if !options.ask {
        let RenderSettings { width, height, .. } = options.settings;
        let (frames, png) = (options.frames, options.png.clone());
        return studio.answer(&Request { width, height, frames, png });
    }
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|e| Error::invalid("standard input", e.to_string()))?;
        studio.answer(&request(&line)?)?;
    }
    Ok(())
}

fn request(line: &str) -> Result<Request> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [width, height, frames, png @ ..] = words.as_slice() else {
        return Err(Error::invalid(line, "expected WIDTH HEIGHT FRAMES [PNG]"));
    };
    let png = png.first().map(PathBuf::from);
    Ok(Request { width: number(width)?, height: number(height)?, frames: number(frames)?, png })
}

fn lighting(options: &Options, scene: &Scene) -> Result<Lighting> {
    let environment = match &options.environment {
        Some(path) => {
            let environment = Arc::new(environment(path)?);
            if let Some(path) = &options.keep {
                std::fs::write(path, environment.to_bytes()).map_err(|e| Error::io(path, e))?;
            }
            Some(EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false })
        }
        None => None,
    };
    Ok(Lighting { lights: scene.lights().to_vec(), ambient: Vec3::splat(options.ambient), environment })
}

fn environment(path: &Path) -> Result<Environment> {
    let bytes = taotie_io::read_bytes(path)?;
    match Environment::from_bytes(&bytes) {
        Ok(kept) => Ok(kept),
        Err(_) => Environment::new(taotie_io::decode_environment(&bytes, path)?),
    }
}

/// A prepared model with its view and lighting.
struct Studio {
    renderer: Renderer,
    camera: Camera,
    lighting: Lighting,
    settings: RenderSettings,
    /// The last image, 8-bit sRGB.
    codes: Vec<[u8; 4]>,
}

impl Studio {
    fn answer(&mut self, request: &Request) -> Result<()> {
        (self.settings.width, self.settings.height) = (request.width, request.height);
        let mut times = Vec::with_capacity(request.frames);
        let begun = Instant::now();
        for frame in 0..WARM_UP {
            if begun.elapsed().as_secs_f64() * 1e3 < WARM_ENOUGH {
                self.frame(frame as f64 * STEP, Some(BACKGROUND))?;
            }
        }
        for frame in 0..request.frames {
            let start = Instant::now();
            self.frame((WARM_UP + frame) as f64 * STEP, Some(BACKGROUND))?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        self.frame(0.0, Some(BACKGROUND))?;
        if let Some(path) = &request.png {
            write(path, &self.codes, request)?;
        }
        self.frame(0.0, None)?;
        let covered = self.codes.iter().filter(|code| code[3] > 0).count();
        let coverage = covered as f64 / self.codes.len() as f64;
        report(&times, coverage);
        Ok(())
    }

    /// Renders the model rotated by `angle` radians.
    fn frame(&mut self, angle: f64, background: Option<Vec3>) -> Result<()> {
        let camera = Camera {
            world_from_view: Mat4::rotation_about(Vec3::new(0.0, 1.0, 0.0), -angle)
                * self.camera.world_from_view,
            ..self.camera.clone()
        };
        let development = Development {
            tone: ToneCurve::Linear,
            background,
            simd: self.settings.surface.simd,
            ..Development::default()
        };
        let lighting = self.turned_lighting(-angle);
        let shot = Shot { camera: &camera, lighting: &lighting, settings: &self.settings };
        self.renderer.develop(&shot, &development, &mut self.codes, Progress::SILENT)
    }

    fn turned_lighting(&self, angle: f64) -> Lighting {
        let mut lighting = self.lighting.clone();
        let turn = Mat4::rotation_about(Vec3::new(0.0, 1.0, 0.0), angle);
        for light in &mut lighting.lights {
            match &mut light.kind {
                LightKind::Point { position } => {
                    *position = turn.transform_point(position.to_f64()).to_f32();
                }
                LightKind::Directional { direction } => {
                    *direction = turn.transform_vector(direction.to_f64()).to_f32();
                }
                LightKind::Spot { position, direction, .. } => {
                    *position = turn.transform_point(position.to_f64()).to_f32();
                    *direction = turn.transform_vector(direction.to_f64()).to_f32();
                }
            }
        }
        if let Some(environment) = &mut lighting.environment {
            environment.rotation += angle;
        }
        lighting
    }
}

fn write(path: &Path, pixels: &[[u8; 4]], request: &Request) -> Result<()> {
    let samples: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    let samples = PngSamples::U8(&samples);
    let (width, height) = (request.width, request.height);
    taotie_io::write_png(
        path,
        &PngImage { width, height, color: PngColor::Rgb, samples, encoding: Encoding::Srgb },
    )
}

/// One line of JSON; `times` in milliseconds, one or more.
fn report(times: &[f64], coverage: f64) {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |i: usize| sorted.get(i).copied().unwrap_or(f64::NAN);
    let median = (at((sorted.len().max(1) - 1) / 2) + at(sorted.len() / 2)) / 2.0;
    let (least, most) = (at(0), at(sorted.len().max(1) - 1));
    let all: Vec<String> = times.iter().map(|time| format!("{time:.3}")).collect();
    println!(
        "{{\"median\": {median:.3}, \"min\": {least:.3}, \"max\": {most:.3}, \"frames\": {}, \
         \"coverage\": {coverage:.4}, \"peak_mib\": {:.1}, \"ms\": [{}]}}",
        times.len(),
        peak_mib(),
        all.join(", ")
    );
}

/// The peak resident memory in MiB; 0 if the system does not report it.
fn peak_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib =
        line.and_then(|line| line.trim().strip_suffix("kB")).and_then(|kib| kib.trim().parse::<f64>().ok());
    kib.unwrap_or(0.0) / 1024.0
}
