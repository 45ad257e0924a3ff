//! `taotie view`: a model as a web page.

mod args;

pub use args::ViewArgs;

use crate::studio::{self, Viewpoint};
use crate::{console, stop};
use anyhow::{Context, Result};
use args::FRAMING;
use serde_json::json;
use std::path::{Path, PathBuf};
use taotie::asset::{Bytes, Scan, ScanFile, ScanOptions, into_metres, model_unit};
use taotie_engine::length::Unit;
use taotie_engine::math::SimdLevel;
use taotie_engine::render::{Prepared, SurfaceSettings, scene_bytes};
use taotie_engine::{Progress, Warnings};
use taotie_io::{FileSet, load_model_within};
use taotie_report::viewer::{self, ScanSubject, Subject, Viewer};

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// Copies of the scene in memory: as it is, as it is written, compressed, and as text.
const COPIES: u64 = 4;

/// Runs the subcommand.
pub fn run(args: &ViewArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let mut warnings = Warnings::default();
    let viewer = viewer(args, &files, &mut warnings)?;
    let written = write(args, &viewer, &files)?;
    console::say_warnings(&warnings);
    let opened = args.output.is_none() && args.folder.is_none();
    if let Some(page) = written.first().filter(|_| opened) {
        open::that(page)
            .with_context(|| format!("{}: no browser opened it; write a page with -o", page.display()))?;
    }
    if args.json {
        return console::result(&serde_json::to_string_pretty(&report(args, &written, &warnings))?);
    }
    written.iter().try_for_each(|path| console::result(&path.display().to_string()))
}

/// Reads the models and makes their page.
fn viewer(args: &ViewArgs, files: &FileSet, warnings: &mut Warnings) -> Result<Viewer> {
    let limits = args.limits.limits();
    let environment = args.light.environment(&limits, warnings)?;
    let loaded = studio::load(&args.model, &args.material, args.surface.bump_scale, &limits)?;
    files.protect(&loaded.files)?;
    limits
        .check(format!("a page of {}", args.model.display()), Bytes(COPIES * scene_bytes(&loaded.scene)))?;
    let (facts, unit) = (viewer::facts(&loaded, &args.file_name()), model_unit(&loaded));
    warnings.absorb(loaded.warnings);
    args.light.note_unread(&loaded.scene, warnings);
    let settings = args.settings();
    // The surface's attributes are made for the best method; the page shows the one asked for.
    let best = SurfaceSettings { method: None, ..settings.surface };
    let prepared = Prepared::new(loaded.scene, &best).with_context(|| args.model.display().to_string())?;
    warnings.absorb(prepared.warnings().clone());
    let is_in_metres = unit == Some(Unit::Metre);
    let scan = args
        .scan
        .as_deref()
        .map(|path| ShownScan::read(ScanOfModel { path, is_in_metres }, args, files, warnings));
    let scan = scan.transpose()?;
    let viewpoint = Viewpoint::choose(&args.camera, FRAMING, prepared.scene())?;
    let view = viewpoint.at(0.0);
    let viewer = Viewer::new(&Subject {
        title: &args.title(),
        facts: &facts,
        unit,
        bookmarks: &args.bookmarks()?,
        prepared: &prepared,
        settings: &settings,
        camera: &view.camera(),
        lighting: &studio::lighting(&args.light, environment.as_ref(), prepared.scene(), view)?,
        development: &args.film.development(SimdLevel::default())?,
        scan: scan.as_ref().map(ShownScan::subject),
        errors: None,
    })?;
    warnings.absorb(viewer.warnings.clone());
    Ok(viewer)
}

/// The scan of a model.
struct ShownScan {
    scan: Scan,
    published: Option<Prepared>,
}

/// The file of a scan whose model is shown.
struct ScanOfModel<'a> {
    path: &'a Path,
    /// `true` if the model is in metres.
    is_in_metres: bool,
}

impl ShownScan {
    /// Reads the scan of a model as the options specify, otherwise as the model records it; in metres if the model
    /// is.
    fn read(
        of_model: ScanOfModel<'_>,
        args: &ViewArgs,
        files: &FileSet,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let ScanOfModel { path, is_in_metres } = of_model;
        let (limits, what) = (args.limits.limits(), path.display().to_string());
        let mut loaded = load_model_within(path, &limits).context("--scan")?;
        let mut options = args.reading.options().or(ScanOptions::recorded(&args.model, &limits)?);
        if is_in_metres {
            into_metres(&mut loaded.scene, options.unit).with_context(|| what.clone())?;
            options.unit = options.unit.map(|_| Unit::Metre);
        }
        files.protect(&loaded.files)?;
        let scene = args.publish_scan.then(|| loaded.scene.clone());
        let file = ScanFile::from_loaded(loaded, path, &limits)?.with_options(options);
        let scan = file.into_scan(Progress::SILENT)?;
        warnings.absorb(scan.warnings().clone());
        let Some(scene) = scene else {
            console::say("the page holds no part of the scan; --publish-scan shows it under the wipe");
            return Ok(Self { scan, published: None });
        };
        limits.check(format!("a page of {what}"), Bytes(COPIES * scene_bytes(&scene)))?;
        let scene = viewer::scene_to_show(&scene, scan.sorted(), warnings).with_context(|| what.clone())?;
        let published = Some(Prepared::new(scene, &SurfaceSettings::default()).context(what)?);
        Ok(Self { scan, published })
    }

    fn subject(&self) -> ScanSubject<'_> {
        ScanSubject { measured: &self.scan, published: self.published.as_ref() }
    }
}

/// Writes the page; returns its files, itself first.
fn write(args: &ViewArgs, viewer: &Viewer, files: &FileSet) -> Result<Vec<PathBuf>> {
    let (path, pages) = match (&args.output, &args.folder) {
        (_, Some(folder)) => {
            let mut pages = viewer.files();
            pages.extend(args.address.iter().flat_map(|address| viewer.manifests(address)));
            let written = pages.iter().map(|file| folder.join(&file.name)).collect::<Vec<_>>();
            for (path, file) in written.iter().zip(&pages) {
                files.write_bytes(path, &file.bytes)?;
            }
            files.commit()?;
            return Ok(written);
        }
        (Some(path), None) => (path.clone(), viewer.html()),
        (None, None) => (temporary(args)?, viewer.html()),
    };
    files.write_text(&path, &pages)?;
    files.commit()?;
    Ok(vec![path])
}

/// The path of a page in a new folder for temporary files, which stays for the browser.
fn temporary(args: &ViewArgs) -> Result<PathBuf> {
    let folder = tempfile::Builder::new().prefix("taotie-view-").tempdir();
    let folder = folder.context("a temporary folder could not be created; write a page with -o")?;
    let stem = args.model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(folder.keep().join(format!("{stem}.html")))
}

fn report(args: &ViewArgs, written: &[PathBuf], warnings: &Warnings) -> serde_json::Value {
    json!({
        "schema": SCHEMA,
        "version": env!("CARGO_PKG_VERSION"),
        "model": console::name_of(&args.model),
        "files": written.iter().map(|path| console::name_of(path)).collect::<Vec<_>>(),
        "scan": args.scan.as_deref().map(console::name_of),
        "environment": args.light.environment_json(),
        "warnings": console::json_warnings(warnings),
    })
}
