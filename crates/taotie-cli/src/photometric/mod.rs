//! `taotie photometric`: normals from photographs, with their uncertainty.

mod args;
mod files;
mod materials;
mod page;
mod relight;
mod report;
mod scan;

pub use args::PhotometricArgs;
pub use files::Output;

use crate::bake::clock::Clock;
use crate::{console, stop};
use anyhow::{Result, bail};
use files::albedo_codes;
use materials::MaterialsReport;
use page::PhotometricPage;
use relight::Relighting;
use report::{Errors, Report};
use scan::Scan;
use std::path::Path;
use taotie::comparison::diff::guessed_encoding;
use taotie_engine::compare::{NormalEncoding, angular_error, stored_normals};
use taotie_engine::image::Image;
use taotie_engine::{Progress, Warnings};
use taotie_photometric::{Estimate, Estimator, PhotographSet, Reading, Samples, averaged};

/// Runs the subcommand.
pub fn run(args: &PhotometricArgs) -> Result<()> {
    if let Some(model) = &args.model {
        let report = args.run.in_pool(|| materials::run(args, model))??;
        return console::report(args.run.json, &report, MaterialsReport::text);
    }
    let report = args.run.in_pool(|| estimate(args))??;
    console::report(args.run.json, &report, Report::text)
}

fn estimate(args: &PhotometricArgs) -> Result<Report> {
    let mut warnings = Warnings::default();
    let files = stop::files();
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        true
    };
    let progress = Progress::new(&listener);
    let set = PhotographSet::open_with(&args.input, &args.setup(), &mut warnings, progress)?;
    args.claim(&files, &set)?;
    relight::claim(args, &files, &set)?;
    let scan = Scan::read(args, &files, &mut warnings)?;
    let truth = args.truth.as_deref().map(|path| read_truth(args, path)).transpose()?;
    let reading = Reading {
        mask: args.mask.as_deref(),
        transfer: args.encoding,
        flat: args.flat.as_deref(),
        limits: args.memory.limits(),
    };
    let samples = Samples::read(&set, &reading, progress.begin("read")?)?;
    warnings.note("a saturated sample is left out", samples.saturated());
    let corner = 0.5 * f64::from(samples.width).hypot(f64::from(samples.height));
    let within = samples.positions.iter().flatten().filter(|lamp| lamp.length() < corner);
    warnings.note(
        "a lamp is closer to the picture's centre than a corner is: with --pixel-size, the lights in the .lp file must be \
         positions in its unit",
        within.count(),
    );
    let truth = truth.map(|truth| averaged(&truth, [samples.width, samples.height])).transpose()?;
    let estimate = Estimate::of(&samples, progress)?;
    let without = estimate.best.iter().filter(|best| best.is_none()).count();
    warnings.note("a pixel has no normal: too little light, or too few samples that agree", without);
    estimate.note_doubts(&samples, &mut warnings);
    let mut relief = estimate.relief(progress.begin("depth")?)?;
    let anchoring = scan.map(|scan| scan.anchor(&mut relief, (args, &files), &mut warnings)).transpose()?;
    progress.begin("write")?;
    let output = Output {
        folder: &args.output,
        pixel_size: args.pixel_size.unwrap_or(1.0),
        files: &files,
        estimate: &estimate,
        relief: &relief,
    };
    warnings.absorb(output.write()?);
    let relighting = Relighting { args, files: &files, set: &set, reading: &reading };
    let relightable = relighting.write(&estimate, progress)?;
    let errors = truth.as_ref().map(|truth| errors(&estimate, truth)).transpose()?;
    let mut report = Report::new(args, &set, &samples, &estimate);
    report.truth = errors;
    report.scan = anchoring;
    report.relight = relightable;
    report.warnings = warnings.list();
    let page = PhotometricPage {
        report: &report,
        estimate: &estimate,
        albedo: &albedo_codes(&estimate),
        truth: truth.as_ref(),
    };
    let (page, found) = page.html(&files.current(&args.path("relief.glb")))?;
    warnings.absorb(found);
    files.write_text(&args.path("report.html"), &page)?;
    report.warnings = warnings.list();
    report.stages = clock.done();
    files.write_text(&args.path("report.json"), &serde_json::to_string_pretty(&report)?)?;
    files.commit()?;
    console::say_warnings(&warnings);
    Ok(report)
}

/// Reads true normals.
fn read_truth(args: &PhotometricArgs, path: &Path) -> Result<Image> {
    let bitmap = taotie_io::read_bitmap_within(path, &args.memory.limits())?;
    let encoding = guessed_encoding(&bitmap)?.unwrap_or(NormalEncoding::Unit);
    Ok(stored_normals(&bitmap, encoding)?.normals)
}

/// Returns the errors of each estimator in degrees.
fn errors(estimate: &Estimate, truth: &Image) -> Result<Errors> {
    let of = |estimator| -> Result<_> {
        match angular_error(&estimate.normals(estimator), truth)?.summary() {
            Some(summary) => Ok(summary),
            None => bail!("the true normals and the mask share no pixel"),
        }
    };
    Ok(Errors {
        least_squares: of(Estimator::LeastSquares)?,
        robust: of(Estimator::Robust)?,
        direct: of(Estimator::Direct)?,
        best: of(Estimator::Best)?,
        coverage: estimate.coverage(truth),
    })
}
