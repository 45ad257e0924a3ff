//! `taotie compare`: one model by several surface methods, in pictures, tables and angles.

mod args;
mod files;
mod method;
mod page;
mod paper;
mod points;
mod reference;
mod report;
mod text;

pub use args::CompareArgs;
pub use report::{Echoes, Report};

use crate::console::{self, Bar};
use crate::studio::{self, Viewpoint, in_pool};
use anyhow::{Context, Result};
use files::Files;
use std::path::{Path, PathBuf};
use taotie::Progress;
use taotie::comparison::{Comparison, ComparisonOptions, Subject};
use taotie::render::{RenderSettings, SurfaceSettings};

/// The place that a comparison is written to.
pub struct Destination<'a> {
    /// The folder; made if it is not there.
    pub folder: &'a Path,
    /// The heading of the page.
    pub title: &'a str,
}

/// Runs the subcommand.
pub fn run(args: &CompareArgs) -> Result<()> {
    args.check()?;
    let (Some(model), Some(output)) = (&args.model, &args.output) else {
        return paper::run(args.running.json, args.output.as_deref());
    };
    let (report, files) = in_pool(args.running.threads, || compare_files(args, model, output))??;
    if args.running.json {
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    console::result(&text::of(&report))?;
    for file in &files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}

fn compare_files(args: &CompareArgs, model: &Path, output: &Path) -> Result<(Report, Vec<PathBuf>)> {
    let mut loaded = studio::load(model, &args.material, args.bump_scale)?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    let reference = args.reference.as_deref();
    let reference = reference
        .map(|path| reference::load(path, args.material.material.as_deref(), &loaded.scene, &mut warnings))
        .transpose()?;
    let viewpoint = Viewpoint::choose(&args.camera, args.framing(), &loaded.scene)?;
    let environment = args.light.environment(&mut warnings)?;
    let lighting = studio::lighting(&args.light, environment.as_ref(), &loaded.scene, viewpoint.at(0.0))?;
    let camera = viewpoint.camera(0.0);
    let options = ComparisonOptions { camera: Some(camera), lighting: Some(lighting), ..options(args)? };
    let name = model.display().to_string();
    let reference_name = args.reference.as_ref().map(|path| path.display().to_string());
    let mut subject = Subject::new(&name, &loaded.scene);
    if let (Some(name), Some(reference)) = (&reference_name, &reference) {
        subject = subject.with_reference(name, reference);
    }
    let mut comparison = compared(&subject, &options).with_context(|| name.clone())?;
    warnings.absorb(std::mem::take(&mut comparison.warnings));
    comparison.warnings = warnings;
    console::say_warnings(&comparison.warnings);
    let title = model.file_name().unwrap_or_default().to_string_lossy();
    write(&comparison, &echoes(args), &Destination { folder: output, title: &title })
}

/// All options but camera and light.
fn options(args: &CompareArgs) -> Result<ComparisonOptions> {
    Ok(ComparisonOptions {
        methods: args.methods(),
        shadings: args.shadings(),
        points: args.points.clone(),
        matching: args.matching,
        settings: settings(args),
        development: args.film.development(args.running.simd)?,
        ..ComparisonOptions::default()
    })
}

fn echoes(args: &CompareArgs) -> Echoes {
    Echoes {
        material: args.material.json(),
        environment: args.light.environment_json(),
        heat_top_deg: args.heat_top_deg,
    }
}

/// Compares under a progress bar.
///
/// # Errors
/// Those of [`Comparison::of`].
pub fn compared(subject: &Subject<'_>, options: &ComparisonOptions) -> taotie::Result<Comparison> {
    let bar = Bar::new("compare");
    let listener = |_: &'static str, done: f64| {
        bar.set(done);
        true
    };
    Comparison::of(subject, options, Progress::new(&listener))
}

/// Writes pictures, contact sheet, `report.json` and `report.html`; returns the report and the files.
///
/// # Errors
/// Where a file cannot be written.
pub fn write(
    comparison: &Comparison,
    echoes: &Echoes,
    destination: &Destination<'_>,
) -> Result<(Report, Vec<PathBuf>)> {
    let mut files = Files::new(destination.folder, echoes.heat_top_deg as f32)?;
    files.write(comparison)?;
    let report = Report::new(comparison.report(), echoes)?;
    files.write_text("report.json", &serde_json::to_string_pretty(&report)?)?;
    let page = page::page(destination.title, &report, comparison, files.heat_top)?;
    files.write_text("report.html", &taotie_report::html(&page))?;
    Ok((report, files.written))
}

fn settings(args: &CompareArgs) -> RenderSettings {
    args.reflection.apply(RenderSettings {
        width: args.size[0],
        height: args.size[1],
        samples: args.film.samples(),
        surface: SurfaceSettings {
            method: None,
            tangents: args.material.tangents,
            bump_scale: args.bump_scale.map(|scale| scale as f32),
        },
        shadows: args.light.shadows,
        simd: args.running.simd,
        ..RenderSettings::default()
    })
}
