//! `taotie render`: renders a model to a picture or an animation.

mod args;
mod machine;
mod output;
mod plan;
mod sequence;

pub use args::RenderArgs;

use crate::studio::{self, Motion};
use crate::{console, stop};
use anyhow::Result;
use machine::Machine;
use sequence::{Setting, Shooting, Watch};
use serde_json::json;
use std::path::{Path, PathBuf};
use taotie::Bytes;
use taotie_engine::Warnings;
use taotie_engine::names::Named;
use taotie_engine::render::{image_bytes, pixel_bytes};
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
    report.machine.report(args);
    console::say_warnings(&report.warnings);
    if let Some(picture) = report.files.iter().find(|file| is_png(file)).filter(|_| console::shows_pictures())
    {
        console::show_file(picture)?;
    }
    if args.running.run.json {
        return console::result(&serde_json::to_string_pretty(&report.json(args))?);
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
    fn json(&self, args: &RenderArgs) -> serde_json::Value {
        let seconds: serde_json::Map<String, serde_json::Value> =
            self.seconds.iter().map(|(stage, s)| ((*stage).to_string(), json!(s))).collect();
        json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "model": args.model.to_string_lossy(),
            "files": self.files.iter().map(|file| file.to_string_lossy()).collect::<Vec<_>>(),
            "triangles": self.triangles,
            "animation": self.animation,
            "times": self.times,
            "size": args.size,
            "integrator": args.integrator.json(),
            "device": self.machine.json(args),
            "samples": args.integrator.reference().is_none().then(|| args.film.samples()),
            "shading": args.surface.shading.name(),
            "surface": args.surface.method.map(|s| s.name()),
            "reflection": args.reflection.json(),
            "material": args.material.json(),
            "camera": self.setting.as_ref().map(|setting| &setting.camera),
            "lights": self.setting.as_ref().map(|setting| &setting.lights),
            "ambient": self.setting.as_ref().map(|setting| setting.ambient),
            "shadows": args.settings().shadows,
            "ground": args.ground,
            "environment": args.light.environment_json(),
            "tone": args.film.tone().name(),
            "seconds": seconds,
            "warnings": console::json_warnings(&self.warnings),
        })
    }
}
