//! The proof of a bake as a page that opens from disk.
//!
//! ```no_run
//! use std::path::Path;
//! use taotie::asset::{BakeOptions, Baker, Limits, Packing, Report, Scan, VerifyOptions};
//! use taotie::{Progress, io};
//!
//! let quiet = Progress::SILENT;
//! let scan = Scan::read("scan.ply", &Limits::default(), quiet)?;
//! let asset = Baker::new(BakeOptions::default()).bake(&scan, quiet)?;
//! let written = asset.write("scan.glb", &Packing::default(), quiet)?;
//! let mut report = Report::of(&written)?;
//! let proof = written.verify(scan, &VerifyOptions::default(), quiet)?;
//! report.proof = Some(proof.figures.clone());
//! let page = taotie_report::bake_page::page(&report, &proof, Some(written.asset()))?;
//! io::write_text(Path::new("scan.report.html"), &taotie_report::html(&page))?;
//! # Ok::<(), taotie::Error>(())
//! ```

mod levels;
mod material;
mod misses;
mod normal_errors;
mod notices;
mod parts;
mod sections;
mod views;
mod worst;

use crate::viewer::{AssetSubject, MeasuredErrors};
use crate::{Fact, Notice, Page, Tone};
use std::path::Path;
use taotie::asset::{Asset, Figures, Limits, Proof, Report};
use taotie::{Result, Warnings};

/// Makes the page of a proof: verdict and warnings, facts, views of scan and asset, maps, and every figure. `asset` is `None`
/// if it was not baked here.
///
/// # Errors
/// [`taotie::Error::Invalid`] where a picture has no pixels.
pub fn page(report: &Report, proof: &Proof, asset: Option<&Asset>) -> Result<Page> {
    let figures = &proof.figures;
    let title = Path::new(&report.high).file_name().unwrap_or_default().to_string_lossy();
    Ok(Page {
        title: title.into_owned(),
        subtitle: "The scan, and the low-poly asset made from it".into(),
        notices: notices::notices(report, figures),
        facts: facts(report, figures),
        views: views::views(proof, asset)?.into_iter().chain(levels::worst_views(proof)?).collect(),
        sections: sections::sections(report, figures),
        footer: format!(
            "Made by taotie {}. All figures are in the .json file beside this page.",
            report.version
        ),
    })
}

/// Makes the page of a bake that is judged elsewhere, as the assets of a collection are: what is required of them may
/// change, and the page does not.
///
/// # Errors
/// As [`page`].
pub fn page_of_collection(report: &Report, proof: &Proof, asset: Option<&Asset>) -> Result<Page> {
    let mut unjudged = report.clone();
    unjudged.required.clear();
    let mut page = page(&unjudged, proof, asset)?;
    let elsewhere =
        "What is required of the asset, and whether it is met, stands on the page of its collection.";
    page.notices[0] = Notice::new(elsewhere, Tone::Changed);
    Ok(page)
}

/// Writes a page of a bake as one HTML document whose first view is the asset as it lies at `path`: by the shaders of
/// Taotie, with the error of its normals on it. Where it cannot be shown, the page is without it, and a warning says why.
pub fn html_with_asset(page: &Page, proof: &Proof, path: &Path) -> (String, Warnings) {
    let finest = proof.figures.finest();
    let (rms, hausdorff) = finest.map_or((0.0, 0.0), |finest| (finest.rms, finest.hausdorff.upper));
    let subject = AssetSubject {
        path,
        title: &path.file_name().unwrap_or_default().to_string_lossy(),
        limits: &Limits::default(),
        errors: proof.error_map.as_ref().map(|normals| MeasuredErrors { normals, rms, hausdorff }),
    };
    match subject.viewer() {
        Ok(viewer) => (viewer.within(page), viewer.warnings),
        Err(error) => {
            let mut warnings = Warnings::default();
            warnings.note(format!("the report does not show the asset itself: {error}"), 1);
            (crate::html(page), warnings)
        }
    }
}

fn facts(report: &Report, proof: &Figures) -> Vec<Fact> {
    let triangles = report.triangles.first().copied().unwrap_or_default();
    let mut facts = vec![
        Fact::new("Scan", format!("{} triangles, {} bytes", report.high_triangles, proof.bytes_in)),
        Fact::new("Asset", format!("{triangles} triangles, {} bytes", proof.bytes_out)),
    ];
    if report.size != [0; 2] {
        facts.push(Fact::new("Maps", format!("{} × {}", report.size[0], report.size[1])));
    }
    if !report.carried.is_empty() {
        facts.push(Fact::new("Carried", report.carried.join(", ")));
    }
    let Some(finest) = proof.finest() else { return facts };
    if let Some(angles) = &finest.overview.angles {
        facts.push(Fact::new("Normal error as seen, mean", format!("{:.2}°", angles.summary.mean)));
    }
    if let Some(patch) = &finest.patches.angle {
        facts.push(Fact::new("Worst 1 % of the surface", format!("{:.1}°", patch.mean)));
    }
    if let Some(color) = &finest.overview.color {
        facts.push(Fact::new("Colour error as seen, mean", format!("ΔE00 {:.2}", color.summary.mean)));
    }
    facts.push(Fact::new("Missed", format!("{:.3} %", finest.coverage.missed() * 100.0)));
    facts.push(Fact::new(
        "Shape error, at most",
        format!("{:.3} % of the diagonal", finest.hausdorff_of_diagonal.upper * 100.0),
    ));
    facts
}
