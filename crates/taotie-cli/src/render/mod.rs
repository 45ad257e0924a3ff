//! `taotie render`: a model in, a picture out.

mod args;
mod output;

pub use args::RenderArgs;
pub use output::{PictureFormat, write_picture};

use crate::console::{self, Progress};
use crate::studio::{self, Viewpoint, in_pool};
use anyhow::{Context, Result};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;
use taotie::Warnings;
use taotie::names::Named;
use taotie::render::{Pass, Prepared};
use taotie::scene::Scene;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// What came of a run.
struct Report {
    files: Vec<PathBuf>,
    triangles: usize,
    warnings: Warnings,
    /// Stage and seconds.
    seconds: Vec<(&'static str, f64)>,
}

/// Runs the subcommand.
pub fn run(args: &RenderArgs) -> Result<()> {
    args.check()?;
    let report = in_pool(args.running.threads, || render(args))??;
    if args.running.json {
        return console::result(&serde_json::to_string_pretty(&report.json(args))?);
    }
    console::say_warnings(&report.warnings);
    for file in &report.files {
        console::result(&file.display().to_string())?;
    }
    Ok(())
}

fn render(args: &RenderArgs) -> Result<Report> {
    let mut watch = Watch::new();
    let mut loaded = studio::load(&args.model, &args.material, args.bump_scale)?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    watch.lap("load");
    let prepared = Prepared::new(&loaded.scene, &args.settings().surface)
        .with_context(|| args.model.display().to_string())?;
    warnings.absorb(prepared.warnings().clone());
    watch.lap("prepare");
    let viewpoint = Viewpoint::choose(&args.camera, args.framing(), &loaded.scene)?;
    let studio = Studio { args, scene: &loaded.scene, prepared: &prepared, viewpoint };
    let mut files = Vec::new();
    for index in 0..studio.frames() {
        files.extend(studio.take(index, &mut watch)?);
    }
    Ok(Report { files, triangles: loaded.scene.triangle_count(), warnings, seconds: watch.laps })
}

/// Everything that stays as it is from one frame of a turntable to the next.
struct Studio<'a> {
    args: &'a RenderArgs,
    scene: &'a Scene,
    prepared: &'a Prepared<'a>,
    viewpoint: Viewpoint,
}

impl Studio<'_> {
    fn frames(&self) -> u32 {
        self.args.turntable.unwrap_or(1)
    }

    /// Renders and writes one frame; returns the files.
    fn take(&self, index: u32, watch: &mut Watch) -> Result<Vec<PathBuf>> {
        let (args, frames) = (self.args, self.frames());
        let turn = std::f64::consts::TAU * f64::from(index) / f64::from(frames);
        let lighting = studio::lighting(&args.light, self.scene, &self.viewpoint, turn)?;
        let title = if frames > 1 { format!("frame {} of {frames}", index + 1) } else { "render".into() };
        let progress = Progress::new(title);
        let pass = Pass::new(self.prepared, &self.viewpoint.camera(turn), &lighting, &args.settings())?;
        let frame = pass.render(&|done| progress.set(done))?;
        watch.lap("render");
        let path = if frames > 1 { numbered(&args.output, index, frames) } else { args.output.clone() };
        let files = output::write(args, &path, &frame)?;
        watch.lap("write");
        Ok(files)
    }
}

/// `turn.png` becomes `turn.007.png`.
fn numbered(path: &Path, index: u32, count: u32) -> PathBuf {
    let digits = (count.saturating_sub(1)).to_string().len().max(3);
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_extension(format!("{index:0digits$}.{extension}"))
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
            "size": args.size,
            "samples": args.film.samples,
            "shading": args.shading.name(),
            "surface": args.surface.map(|s| s.name()),
            "tone": args.film.tone.name(),
            "seconds": seconds,
            "warnings": console::json_warnings(&self.warnings),
        })
    }
}

/// Sums the time of each stage.
struct Watch {
    last: Instant,
    laps: Vec<(&'static str, f64)>,
}

impl Watch {
    fn new() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }

    fn lap(&mut self, stage: &'static str) {
        let now = Instant::now();
        let seconds = now.duration_since(self.last).as_secs_f64();
        self.last = now;
        match self.laps.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, total)) => *total += seconds,
            None => self.laps.push((stage, seconds)),
        }
    }
}
