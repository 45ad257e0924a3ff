//! The report page for the proof of a bake, which opens from disk.
//!
//! ```no_run
//! use std::path::Path;
//! use taotie::asset::{BakeOptions, Baker, Certificate, Packing, Report, Scan, Signature, VerifyOptions};
//! use taotie::{Error, Limits, Progress};
//!
//! let quiet = Progress::SILENT;
//! let scan = Scan::read("scan.ply", &Limits::default(), quiet)?;
//! let asset = Baker::new(BakeOptions::default()).bake(&scan, quiet)?;
//! let written = asset.write("scan.glb", &Packing::default(), quiet)?;
//! let mut report = Report::of(&written)?;
//! let options = taotie_report::bake_page::options(VerifyOptions::default(), true);
//! let proof = written.verify(scan, &options, quiet)?;
//! let certificate = Certificate::of_written(&written, &proof.figures, &options, &Signature::default())?;
//! report.prove(proof.figures.clone(), proof.maps.clone());
//! report.certificate = Some(certificate);
//! let page = taotie_report::bake_page::page(&report, &proof, Some(written.asset()))?;
//! taotie_io::write_text(Path::new("scan.report.html"), &taotie_report::html(&page))?;
//! # Ok::<(), Error>(())
//! ```

mod breakdown;
mod certificate;
mod sections;
mod trials;
mod views;

pub use trials::trials_csv;

use crate::viewer::{AssetSubject, MeasuredErrors, Staging};
use crate::{Notice, Page, Section, Tone};
use certificate::Judge;
use std::path::Path;
use taotie::asset::{Asset, Proof, Report, VerifyOptions};
use taotie::{Limits, Warning};
use taotie_engine::bake::RayPreview;
use taotie_engine::length::Unit;
use taotie_engine::math::Vec3;
use taotie_engine::{Result, Warnings};

/// The side of the pictures of the worst patches, pixels.
const PATCH_VIEW: u32 = 384;

/// Returns the options for a proof with the pictures that a page shows, which are error maps and the worst patches;
/// without them if no page is wanted.
pub fn options(options: VerifyOptions, is_wanted: bool) -> VerifyOptions {
    match is_wanted {
        true => VerifyOptions { patch_view: PATCH_VIEW, ..options },
        false => VerifyOptions { map: 0, patch_view: 0, ..options },
    }
}

/// Builds the page for a proof: certificate, worst patches, views of scan and asset, maps, all figures, and warnings.
/// `asset` is `None` if it was not baked here.
///
/// # Errors
/// [`taotie_engine::Error::Invalid`] if a picture has no pixels.
pub fn page(report: &Report, proof: &Proof, asset: Option<&Asset>) -> Result<Page> {
    of(report, proof, (asset, Judge::Here))
}

/// Builds the page for a bake that is judged elsewhere, such as an asset of a collection: the requirements may change
/// while the page stays the same.
///
/// # Errors
/// As [`page`].
pub fn page_of_collection(report: &Report, proof: &Proof, asset: Option<&Asset>) -> Result<Page> {
    of(report, proof, (asset, Judge::Collection))
}

fn of(report: &Report, proof: &Proof, (asset, judge): (Option<&Asset>, Judge)) -> Result<Page> {
    let mut sections = sections::sections(report, (&proof.figures, &proof.part_flips));
    sections.splice(0..0, trials::plot(report));
    sections.extend(report.certificate.as_ref().and_then(certificate::further_files));
    sections.extend(warnings(report, proof));
    let is_packed = report.trials.iter().any(|trial| trial.is_chosen && trial.is_scan);
    Ok(Page {
        title: name_of_scan(report),
        subtitle: match report.bake {
            Some(_) if is_packed => "The scan, and the same scan packed into a smaller file".into(),
            Some(_) => "The scan and the low-poly asset made from it".into(),
            None => "The scan and an asset that represents it".into(),
        },
        statement: report.certificate.as_ref().map(|own| certificate::statement(own, judge)),
        features: views::worst_patches(proof)?,
        views: views::views(proof, asset)?.into_iter().chain(views::worst_views(proof)?).collect(),
        sections,
        footer: format!(
            "Made by taotie {}. All figures are in the .json file next to this page.",
            report.version
        ),
        ..Page::default()
    })
}

/// Returns the name of the scan's file, and the number of others.
fn name_of_scan(report: &Report) -> String {
    match report.high_others.len() {
        0 => report.high.clone(),
        1 => format!("{} and {}", report.high, report.high_others[0].name),
        more => format!("{} and {more} more files", report.high),
    }
}

/// Builds the section of all distinct warnings: first those of the proof, then those about the files and the bake.
/// `None` if there are none.
fn warnings(report: &Report, proof: &Proof) -> Option<Section> {
    let found = proof.warnings.list();
    let (first, others): (Vec<&Warning>, Vec<&Warning>) =
        report.warnings.iter().partition(|warning| found.iter().any(|found| found.what == warning.what));
    let mut notices: Vec<Notice> = Vec::new();
    for (warning, tone) in with_tone(first, Tone::Bad).chain(with_tone(others, Tone::Changed)) {
        let notice = Notice::new(warning.to_string(), tone);
        if notices.iter().all(|known| known.text != notice.text) {
            notices.push(notice);
        }
    }
    (!notices.is_empty()).then(|| Section::Notices {
        title: "Warnings".into(),
        note: "Findings of the proof come first, then problems in the files and changes made to fix them."
            .into(),
        notices,
    })
}

fn with_tone(warnings: Vec<&Warning>, tone: Tone) -> impl Iterator<Item = (&Warning, Tone)> {
    warnings.into_iter().map(move |warning| (warning, tone))
}

/// Writes the page for a bake as one HTML document whose first view is the asset at `path`, drawn by the shaders of
/// Taotie, with its normal error and, if it was baked here as `asset`, some projection rays. If it cannot be shown, the page
/// omits it and a warning gives the reason.
pub fn html_with_asset(
    page: &Page,
    (proof, asset): (&Proof, Option<&Asset>),
    path: &Path,
) -> (String, Warnings) {
    let rays = asset.map(|asset| {
        // A model with a known unit is in metres.
        let scale = asset.unit().map_or(1.0, Unit::metres) as f32;
        let scaled =
            |rays: Vec<[Vec3; 2]>| rays.into_iter().map(|ends| ends.map(|end| end * scale)).collect();
        let RayPreview { met, missed } = asset.rays();
        RayPreview { met: scaled(met), missed: scaled(missed) }
    });

    let subject = AssetSubject {
        path,
        title: &path.file_name().unwrap_or_default().to_string_lossy(),
        limits: &Limits::default(),
        errors: MeasuredErrors::of(proof),
        rays: rays.as_ref().filter(|rays| !rays.met.is_empty()),
        staging: Staging::default(),
    };
    match subject.page(&|viewer| viewer.within(page)) {
        Ok(written) => written,
        Err(error) => {
            let mut warnings = Warnings::default();
            warnings.note(format!("the report has no 3D view of the asset: {error}"), 1);
            (crate::html(page), warnings)
        }
    }
}
