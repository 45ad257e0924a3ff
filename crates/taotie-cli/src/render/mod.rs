//! `taotie render`: renders a model to a picture or an animation.

mod args;
mod drawer;
mod output;
mod plan;
mod sequence;

pub use args::RenderArgs;

use crate::device::{DeviceReport, Machine};
use crate::studio::{self, EnvironmentReport, MaterialReport, Motion, ReflectionReport};
use crate::{console, stop};
use anyhow::Result;
use args::IntegratorReport;
use sequence::{Setting, Shooting, Watch};
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie::studio::{CameraParameters, LightParameters};
use taotie::{Bytes, Warning};
use taotie_engine::Warnings;
use taotie_engine::film::ToneCurve;
use taotie_engine::render::{image_bytes, pixel_bytes};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_io::FileSet;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 4;

/// The result of a run.
struct Report {
    files: Vec<PathBuf>,
    triangles: usize,
    /// The animation shown.
    animation: Option<String>,
    /// Its time in each picture, seconds.
    times: Vec<f64>,
    /// The camera and the light of the first picture.
    setting: Option<Setting>,
    machine: Machine,
    warnings: Warnings,
    /// Stage and seconds.
    seconds: Vec<(&'static str, f64)>,
}

/// Runs the subcommand.
pub fn run(args: &RenderArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let report = args.running.run.in_pool(|| render(args, &files))??;
    let how = if args.settings().shadows { "; shadows by rays in the shader" } else { "" };
    report.machine.report("rendered", how);
    console::say_warnings(&report.warnings);
    if let Some(picture) = report.files.iter().find(|file| is_png(file)) {
        console::show_file(picture)?;
    }
    if args.running.run.json {
        return console::result(&serde_json::to_string_pretty(&report.printed(args))?);
    }
    for file in &report.files {
        console::result(&file.display().to_string())?;
    }
    Ok(())
}

fn is_png(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

fn render(args: &RenderArgs, set: &FileSet) -> Result<Report> {
    let mut watch = Watch::new();
    let limits = args.running.limits.limits();
    let [width, height] = args.size;
    let picture = format!("a picture of {width}x{height}");
    let held = output::held(args)?;
    limits.check(picture.as_str(), Bytes(pixel_bytes(&args.settings(), held)))?;
    let mut sky_warnings = Warnings::default();
    let (loaded, environment) = rayon::join(
        || studio::load(&args.model, &args.material, args.surface.bump_scale, &limits),
        || args.light.environment(&limits, &mut sky_warnings),
    );
    let (mut loaded, environment) = (loaded?, environment?);
    set.protect(&loaded.files)?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    warnings.absorb(sky_warnings);
    args.note_unread(&loaded.scene, &mut warnings);
    watch.lap("load");
    let mut settings = args.settings();
    let sky = environment.as_ref().map_or(0, |light| light.environment.bytes());
    let need = image_bytes(&loaded.scene, &settings, held) + output::waiting_bytes(args)? + sky;
    limits.check(picture, Bytes(need))?;
    let motion = match args.motion.animates() {
        true => {
            let motion = args.motion.choose(loaded.rig.take(), &args.model)?;
            let (motion, surface) =
                motion.bind_tangents(&mut loaded.scene, &settings.surface, &mut warnings)?;
            settings.surface = surface;
            Some(motion)
        }
        false => None,
    };
    watch.lap("prepare");
    let plan = args.motion.plan(motion.as_ref().map_or(0.0, Motion::seconds))?;
    let mut sequence = Shooting::new(args, settings, &plan, watch)?.within(environment).into_set(set)?;
    let files = sequence.take(&mut loaded.scene, motion.as_ref(), &mut warnings)?;
    let animation = motion.map(|motion| motion.name());
    let triangles = loaded.scene.triangle_count();
    let Shooting { setting, machine, watch, .. } = sequence;
    let (times, seconds) = (plan.times(), watch.laps);
    Ok(Report { files, triangles, animation, times, setting, machine, warnings, seconds })
}

impl Report {
    /// Returns the report as `--json` prints it.
    fn printed<'a>(&'a self, args: &'a RenderArgs) -> Printed<'a> {
        let setting = self.setting.as_ref();
        Printed {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            model: args.model.to_string_lossy(),
            files: self.files.iter().map(|file| file.to_string_lossy()).collect(),
            triangles: self.triangles,
            animation: self.animation.as_deref(),
            times: &self.times,
            size: args.size,
            integrator: args.integrator.report(),
            device: self.machine.report_of(args.device, args.settings().shadows),
            samples: args.integrator.reference().is_none().then(|| args.film.samples()),
            shading: args.surface.shading,
            surface: args.surface.method,
            reflection: args.reflection.report(),
            material: args.material.report(),
            camera: setting.map(|setting| &setting.camera),
            lights: setting.map(|setting| setting.lights.as_slice()),
            ambient: setting.map(|setting| setting.ambient),
            shadows: args.settings().shadows,
            ground: args.ground,
            environment: args.light.environment_report(),
            tone: args.film.tone(),
            seconds: self.seconds.iter().copied().collect(),
            warnings: self.warnings.list(),
        }
    }
}

/// The report on a picture or an animation.
#[derive(Serialize)]
struct Printed<'a> {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The path of the model, as given.
    model: Cow<'a, str>,
    /// The paths of the written files.
    files: Vec<Cow<'a, str>>,
    /// The number of triangles, over all instances.
    triangles: usize,
    /// The name of the animation shown; `None` without one.
    animation: Option<&'a str>,
    /// The time of the animation in each picture, seconds; `0` without one.
    times: &'a [f64],
    /// Pixels across and down.
    size: [u32; 2],
    /// The integrator.
    integrator: IntegratorReport,
    /// The device.
    device: DeviceReport<'a>,
    /// Samples per pixel; `None` for the path tracer.
    samples: Option<u32>,
    /// The reflectance model.
    shading: Shading,
    /// The requested source of shading normals; `None` uses the best that each mesh has.
    surface: Option<SurfaceMethod>,
    /// The details of reflection.
    reflection: ReflectionReport,
    /// The options that replace parts of the model's materials.
    material: MaterialReport<'a>,
    /// The camera of the first picture; `None` without pictures.
    camera: Option<&'a CameraParameters>,
    /// The lights of the first picture, world space; `None` without pictures.
    lights: Option<&'a [LightParameters]>,
    /// Radiance from all around, linear RGB; `None` without pictures.
    ambient: Option<[f32; 3]>,
    /// `true` if lights cast shadows.
    shadows: bool,
    /// `true` if the model is above a ground that catches its shadow.
    ground: bool,
    /// The environment; `None` without one.
    environment: Option<EnvironmentReport>,
    /// The tone curve.
    tone: ToneCurve,
    /// The time of each stage, seconds.
    seconds: BTreeMap<&'static str, f64>,
    /// Problems and corrections.
    warnings: Vec<Warning>,
}
