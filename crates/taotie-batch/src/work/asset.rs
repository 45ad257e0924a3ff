//! An asset and its proof, as one object.

use super::context::Work;
use crate::address::VERSION;
use crate::objects::{AssetObject, entries};
use crate::record::SCHEMA;
use std::path::PathBuf;
use taotie::asset::{Baker, Certificate, Proof, Report, ScanFile, Signature, Warning, WrittenAsset};
use taotie_engine::Result;
use taotie_io::FileSet;
use taotie_report::bake_page;

/// Bakes a scan, proves it, and writes all files to an address.
///
/// # Errors
/// Errors of any step; in that case no files are left behind.
pub fn make(work: &Work<'_>, file: ScanFile, address: &str) -> Result<AssetObject> {
    let (job, progress) = (work.job, work.progress);
    let settings = &job.settings.asset;
    let files = (work.host.files)();
    let path = work.store.claim(address, &files)?.join(format!("{}.glb", work.stem()));
    files.protect(file.files())?;
    let baker = Baker::new(settings.bake.clone()).with_limits(job.limits).with_files(&files);
    let scan = file.into_scan(progress)?;
    let asset = baker.bake(&scan, progress)?;
    let written = asset.write_in(&files, &path, &settings.packing, progress)?;
    let mut report = Report::of(&written)?;
    let options = bake_page::options(settings.verify.clone(), settings.report);
    let proof = written.verify(scan, &options, progress)?;
    report.warnings.extend(Warning::list(&proof.warnings));
    report.proof = Some(proof.figures.clone());
    let certificate = Certificate::of_written(&written, &proof.figures, &options, &Signature::default());
    report.certificate = Some(certificate?);
    let mut all = written.files().to_vec();
    if settings.report {
        all.extend(page(report.clone(), &proof, &written, &files)?);
    }
    progress.begin("commit")?;
    files.commit()?;
    let object = AssetObject {
        kind: "asset".into(),
        schema: SCHEMA,
        version: VERSION.into(),
        triangles_in: report.high_triangles,
        triangles: report.triangles,
        size: report.size,
        figures: proof.figures,
        warnings: report.warnings,
        files: entries(&named(&all))?,
    };
    work.store.complete(address, &object, &(work.host.files)())?;
    Ok(object)
}

/// Writes the report: a page and JSON. Neither contains paths or times, which vary between machines.
fn page(mut report: Report, proof: &Proof, written: &WrittenAsset, files: &FileSet) -> Result<[PathBuf; 2]> {
    let [html, json] = ["report.html", "report.json"].map(|kind| written.path().with_extension(kind));
    report.files.extend([html.clone(), json.clone()]);
    files.write_text(
        &html,
        &taotie_report::html(&bake_page::page_of_collection(&report, proof, Some(written.asset()))?),
    )?;
    files.write_text(&json, &serde_json::to_string_pretty(&report).expect("all keys are text"))?;
    Ok([html, json])
}

/// Pairs paths with their file names.
fn named(files: &[PathBuf]) -> Vec<(String, PathBuf)> {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), path.clone())).collect()
}
