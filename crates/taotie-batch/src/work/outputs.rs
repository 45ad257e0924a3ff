//! The outputs of a job in progress: the asset with its proof, its pictures, and the page that shows it in a browser.

use crate::job::{Go, Job, Message};
use crate::record::{ASSET, EstimateFigures, SCHEMA};
use crate::settings::{AssetSettings, PhotometricSettings, Task, Thumbnail, Turntable};
use crate::store::{AssetObject, Store, VERSION, entries};
use std::path::{Path, PathBuf};
use taotie::asset::{Baker, Certificate, Proof, Report, ScanFile, Signature, WrittenAsset};
use taotie::studio::{self, MaterialOptions};
use taotie::{Bytes, Limits, Picture, Progress, RenderSettings, Result, Scene};
use taotie_engine::Warnings;
use taotie_engine::image::{Encoding, Texels};
use taotie_io::{AnimatedImage, AnimationFormat, AnimationSpec, FileSet, ImageCodec, LossyTexture};
use taotie_photometric::PhotographSet;
use taotie_report::bake_page;
use taotie_report::viewer::{AssetSubject, Staging};

/// The callbacks of a process: to its driver, and to signal handling.
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// Creates a set of files that signals can stop.
    pub files: &'a (dyn Fn() -> FileSet + Sync),
    /// Sends a message to the driver.
    pub send: &'a (dyn Fn(Message) + Sync),
    /// Waits for the driver's permission to begin.
    pub go: &'a (dyn Fn() -> Go + Sync),
    /// Estimates normals from photographs and adds all files to their set; notes warnings.
    pub estimate: &'a (dyn Fn(&Order<'_>, &mut Warnings) -> Result<EstimateFigures> + Sync),
}

/// An estimate that the host makes.
pub struct Order<'a> {
    /// The name of the folder or file.
    pub name: &'a str,
    /// The photographs.
    pub set: &'a PhotographSet,
    /// The options, and whether a page is written.
    pub settings: &'a PhotometricSettings,
    /// The folder to write to, which is part of `files`.
    pub folder: &'a Path,
    /// The set that the files are added to.
    pub files: &'a FileSet,
    /// Limits of memory and image sizes.
    pub limits: Limits,
    /// Stages.
    pub progress: Progress<'a>,
}

/// A job in progress.
pub struct Work<'a> {
    /// The job.
    pub job: &'a Job,
    /// The callbacks of its process.
    pub host: Host<'a>,
    /// The files that it writes.
    pub store: Store,
    /// Its stages.
    pub progress: Progress<'a>,
}

impl Work<'_> {
    /// Returns the name of the scan's file, or of the folder or file of photographs.
    pub fn name(&self) -> String {
        let id = || self.job.id.rsplit('/').next().unwrap_or_default().into();
        self.job.scan.file_name().map_or_else(id, |name| name.to_string_lossy().into_owned())
    }

    /// Returns the name of the scan's file without its extension, or of the folder of photographs: the stem of file names.
    pub fn stem(&self) -> String {
        let name = self.name();
        let is_folder = matches!(self.job.settings.task, Task::Photometric(_)) && self.job.scan.is_dir();
        let stem = if is_folder { None } else { Path::new(&name).file_stem() };
        let stem = stem.map_or(name.clone(), |stem| stem.to_string_lossy().into_owned());
        if stem.is_empty() { "asset".into() } else { stem }
    }

    /// Returns the memory limit for presenting an asset.
    pub fn limit(&self) -> Option<Bytes> {
        self.job.limits.memory
    }
}

/// A path to write, and the set of files it belongs to.
pub type Target<'a> = (&'a Path, &'a FileSet);

/// Bakes a scan, proves it, and writes all files to an address.
///
/// # Errors
/// Errors of any step; in that case no files are left behind.
pub fn asset(
    work: &Work<'_>,
    settings: &AssetSettings,
    file: ScanFile,
    address: &str,
) -> Result<AssetObject> {
    let (job, progress) = (work.job, work.progress);
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
    report.warnings.extend(proof.warnings.list());
    report.prove(proof.figures.clone(), proof.maps.clone());
    let certificate = Certificate::of_written(&written, &proof.figures, &options, &Signature::default());
    report.certificate = Some(certificate?);
    let mut all = written.files().to_vec();
    if settings.report {
        all.extend(report_files(report.clone(), &proof, &written, &files)?);
    }
    progress.begin("commit")?;
    files.commit()?;
    let object = AssetObject {
        kind: ASSET.into(),
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
fn report_files(
    mut report: Report,
    proof: &Proof,
    written: &WrittenAsset,
    files: &FileSet,
) -> Result<[PathBuf; 2]> {
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

/// The codec of thumbnails. Measured at 256²: 5 ms and 2.4 kB; lossless, 44 ms and 15 kB.
pub const THUMBNAIL: ImageCodec = ImageCodec::LossyWebP(90);

/// Writes a picture of a model as lossy WebP.
///
/// # Errors
/// Read and write errors.
pub fn thumbnail(
    model: &Path,
    (path, files): Target<'_>,
    Thumbnail { size }: Thumbnail,
    work: &Work<'_>,
) -> Result<()> {
    let bitmap = picture(size).take(load(model, work)?)?;
    files.write_bytes(path, &LossyTexture::new(bitmap, Encoding::Srgb).encoded(size, THUMBNAIL)?)
}

/// Writes one turn of a model as an animated PNG.
///
/// # Errors
/// Read and write errors.
pub fn turntable(
    model: &Path,
    (path, files): Target<'_>,
    Turntable { size, frames }: Turntable,
    work: &Work<'_>,
) -> Result<()> {
    let (format, seconds) = (AnimationFormat::Png, 4.0);
    let spec = AnimationSpec { format, width: size, height: size, frames, seconds, alpha: true };
    let mut image = AnimatedImage::create(files, path, &spec)?;
    picture(size).turntable(load(model, work)?, frames, |bitmap| {
        let Texels::U8(pixels) = bitmap.texels() else { unreachable!("a picture has 8 bits per channel") };
        image.add(pixels)
    })?;
    image.finish()
}

fn load(model: &Path, work: &Work<'_>) -> Result<Scene> {
    let limits = Limits { memory: work.limit(), ..Limits::default() };
    Ok(studio::load(model, &MaterialOptions::default(), &limits)?.scene)
}

/// Returns the settings of a square picture.
fn picture(size: u32) -> Picture {
    let settings = RenderSettings { width: size, height: size, ..RenderSettings::default() };
    Picture { settings, ..Picture::default() }
}

/// Writes the page that shows a model in a browser.
///
/// # Errors
/// Read and write errors.
pub fn viewer_page(model: &Path, (path, files): Target<'_>, work: &Work<'_>) -> Result<()> {
    let limits = Limits { memory: work.limit(), ..Limits::default() };
    let title = work.stem();
    let subject = AssetSubject {
        path: model,
        title: &title,
        limits: &limits,
        errors: None,
        rays: None,
        staging: Staging::default(),
    };
    let (page, _) = subject.page(&|viewer| viewer.html())?;
    files.write_text(path, &page)
}
