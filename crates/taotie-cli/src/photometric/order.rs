//! An estimate that was ordered, by the command or by a collection: photographs, options, and where to write.

use super::files::{Output, albedo_codes};
use super::page::PhotometricPage;
use super::relight::Relighting;
use super::report::{Errors, Report};
use super::scan::Scan;
use crate::console::name_of;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use taotie_engine::compare::angular_error;
use taotie_engine::image::Image;
use taotie_engine::{Progress, Warnings};
use taotie_io::{FileSet, Limits};
use taotie_photometric::{Estimate, Estimator, PhotographSet, PhotometricOptions, Samples, averaged};

/// Photographs, and what to make of them.
pub struct Order<'a> {
    /// The folder or file, as the report and the page name it.
    pub input: String,
    /// The photographs.
    pub set: &'a PhotographSet,
    /// The options.
    pub options: &'a PhotometricOptions,
    /// The folder to write to.
    pub output: &'a Path,
    /// The set that the files belong to.
    pub files: &'a FileSet,
    /// Limits of memory and image sizes.
    pub limits: Limits,
    /// True to write `report.html`.
    pub has_page: bool,
    /// True to give names of files without their folders, so that all files are the same on every machine.
    pub is_portable: bool,
    /// A scan of large shapes.
    pub scan: Option<Scan>,
    /// True normals, at the size of the photographs or a multiple.
    pub truth: Option<Image>,
    /// Stages.
    pub progress: Progress<'a>,
}

impl Order<'_> {
    /// Returns the path of an output.
    pub fn path(&self, name: &str) -> PathBuf {
        self.output.join(name)
    }

    /// Returns a path as reports show it.
    pub fn shown(&self, path: &Path) -> String {
        if self.is_portable { name_of(path) } else { path.display().to_string() }
    }

    /// Estimates the normals, and adds all files to the set except for `report.json`, which is for the caller.
    pub fn fill(&self, warnings: &mut Warnings) -> Result<Report> {
        let Self { set, options, files, progress, .. } = *self;
        let reading = options.reading(self.limits);
        let samples = Samples::read(set, &reading, progress.begin("read")?)?;
        note_samples(&samples, warnings);
        let size = [samples.width, samples.height];
        let truth = self.truth.as_ref().map(|truth| averaged(truth, size)).transpose()?;
        let estimate = Estimate::of(&samples, progress)?;
        let without = estimate.best.iter().filter(|best| best.is_none()).count();
        warnings.note("a pixel has no normal: too little light, or too few samples that agree", without);
        estimate.note_doubts(&samples, warnings);
        let mut relief = estimate.relief(progress.begin("depth")?)?;
        let anchor = |scan: &Scan| scan.anchor(&mut relief, self, warnings);
        let anchoring = self.scan.as_ref().map(anchor).transpose()?;
        progress.begin("write")?;
        let output = Output {
            folder: self.output,
            pixel_size: options.pixel_size.unwrap_or(1.0),
            files,
            estimate: &estimate,
            relief: &relief,
        };
        warnings.absorb(output.write()?);
        let relightable = Relighting { order: self, reading: &reading }.write(&estimate)?;
        let mut report = Report::new(self, &samples, &estimate);
        report.truth = truth.as_ref().map(|truth| errors(&estimate, truth)).transpose()?;
        report.scan = anchoring;
        report.relight = relightable;
        report.warnings = warnings.list();
        if self.has_page {
            let page = PhotometricPage {
                report: &report,
                estimate: &estimate,
                albedo: &albedo_codes(&estimate),
                truth: truth.as_ref(),
            };
            let (page, found) = page.html(&files.current(&self.path("relief.glb")))?;
            warnings.absorb(found);
            files.write_text(&self.path("report.html"), &page)?;
            report.warnings = warnings.list();
        }
        Ok(report)
    }
}

fn note_samples(samples: &Samples, warnings: &mut Warnings) {
    warnings.note("a saturated sample is left out", samples.saturated());
    let corner = 0.5 * f64::from(samples.width).hypot(f64::from(samples.height));
    let within = samples.positions.iter().flatten().filter(|lamp| lamp.length() < corner);
    warnings.note(
        "a lamp is closer to the picture's centre than a corner is: with --pixel-size, the lights in the .lp file must be \
         positions in its unit",
        within.count(),
    );
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
