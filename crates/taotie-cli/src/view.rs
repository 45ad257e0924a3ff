//! `taotie view`: a model as a web page.

use crate::proof_args::ScanArgs;
use crate::running::{LimitArgs, in_pool};
use crate::studio::{
    self, CameraArgs, EnvironmentReport, FilmArgs, Framing, LightArgs, MaterialArgs, ReflectionArgs,
    SurfaceArgs, Viewpoint,
};
use crate::{console, stop};
use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::{fs, io};
use taotie::asset::{Scan, ScanFile, ScanOptions, model_unit};
use taotie::{Bytes, Warning};
use taotie_engine::length::Unit;
use taotie_engine::math::SimdLevel;
use taotie_engine::render::{
    HeldPixels, Prepared, RenderSettings, SurfaceSettings, image_bytes, scene_bytes,
};
use taotie_engine::scene::Scene;
use taotie_engine::shade::Shading;
use taotie_engine::{Progress, Warnings};
use taotie_io::{FileSet, read_bytes};
use taotie_report::viewer::{self, Bookmark, FolderFiles, PageFile, ScanSubject, Subject, Viewer};

const EXAMPLES: &str = "\
Examples:
  taotie view vase.glb
  taotie view vase.glb -o vase.html
  taotie view vase.glb --light \"directional from=-75,10 strength=4\" -o raking.html
  taotie view vase.glb --env studio --folder site
  taotie view vase.glb --folder site --address https://museum.example/vase
  taotie view vase.glb --scan vase-scan.ply -o proof.html

The page shows what `taotie render` draws with the same options, with any reflectance model and surface method; move \
light and camera with the mouse, a finger or the keyboard.";

/// Writes a model as a single offline web page; opens it in a browser if no file is named.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct ViewArgs {
    /// The model: .gltf, .glb, .obj, .ply, .stl or .fbx
    pub model: PathBuf,
    /// The page to write: .html [default: a temporary file, which is opened]
    #[arg(short, long, value_name = "PAGE")]
    pub output: Option<PathBuf>,
    /// Write the page and the model as separate files into a folder, for a web server
    #[arg(long, value_name = "DIR", conflicts_with = "output")]
    pub folder: Option<PathBuf>,
    /// Address where the folder will be published: writes IIIF manifests into it, `manifest.json` for version 4 of
    /// the Presentation API, `manifest-3.json` for version 3
    #[arg(long, value_name = "URL", requires = "folder", value_parser = web_address)]
    pub address: Option<String>,
    /// The scan of the model: the page shows the measured error on the model, but no part of the scan. May be repeated
    /// for a scan of several files
    #[arg(long, value_name = "SCAN")]
    pub scan: Vec<PathBuf>,
    /// Put the scan itself into the page, shown next to the model under a wipe
    #[arg(long, requires = "scan")]
    pub publish_scan: bool,
    #[command(flatten)]
    pub reading: ScanArgs,
    /// Views that the page offers: a JSON list of { "title", "text", "link" }, as saved by a page
    #[arg(long, value_name = "FILE")]
    pub bookmarks: Option<PathBuf>,
    /// Heading of the page [default: the file's name]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,

    #[command(flatten)]
    pub surface: SurfaceArgs,
    #[command(flatten)]
    pub reflection: ReflectionArgs,
    #[command(flatten)]
    pub material: MaterialArgs,
    #[command(flatten)]
    pub light: LightArgs,
    #[command(flatten)]
    pub camera: CameraArgs,
    #[command(flatten)]
    pub film: FilmArgs,
    #[command(flatten)]
    pub limits: LimitArgs,
    /// Print a report as JSON
    #[arg(long, help_heading = "Running")]
    pub json: bool,
}

/// Parses a web address, as IIIF requires it.
fn web_address(text: &str) -> Result<String, String> {
    let is_whole = ["http://", "https://"].iter().any(|scheme| {
        text.strip_prefix(scheme).is_some_and(|rest| !rest.is_empty() && !rest.contains(['#', '?', ' ']))
    });
    is_whole
        .then(|| text.to_owned())
        .ok_or_else(|| "expected the address of a folder that begins with http:// or https://".into())
}

/// The picture that the first camera frames.
const FRAMING: Framing = Framing { size: [1024, 1024], all_around: false };

impl ViewArgs {
    /// Rejects options that cannot work together, before any work is done.
    fn check(&self) -> Result<()> {
        let every: Vec<Shading> =
            <Shading as taotie_engine::names::Named>::NAMES.iter().map(|(_, s)| *s).collect();
        self.material.check(&every)?;
        self.reflection.check(&every)?;
        self.light.check()?;
        self.camera.check()?;
        self.film.check(self.light.show_env)?;
        if self.light.show_env {
            bail!("--show-env: the page shows a plain background; leave it out");
        }
        if self.light.shadows {
            bail!(
                "--shadows: the page draws only those of its raking light; leave it out, or use `taotie render`"
            );
        }
        match &self.output {
            Some(path) if path.extension().is_none_or(|end| !end.eq_ignore_ascii_case("html")) => {
                bail!("{}: the page is written as .html", path.display())
            }
            _ => Ok(()),
        }
    }

    /// Rejects an output that cannot be written or that is an input.
    fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect([&self.model])?;
        files.protect(&self.scan)?;
        files.protect(&self.bookmarks)?;
        files.protect(studio::material_files(&self.material)?)?;
        files.protect(self.light.environment_file())?;
        match (&self.output, &self.folder) {
            (Some(path), _) => Ok(files.claim(path)?),
            (None, Some(folder)) => {
                FolderFiles::read(folder).check(FolderFiles::main_names(self.address.is_some()))?;
                Ok(files.claim_folder(folder)?)
            }
            (None, None) => Ok(()),
        }
    }

    /// Returns the settings that `taotie render` has with the same options.
    fn settings(&self) -> RenderSettings {
        let shown = self.surface.settings();
        self.reflection.apply(RenderSettings {
            samples: self.film.samples(),
            surface: SurfaceSettings { tangents: self.material.tangents, ..shown.surface },
            ..shown
        })
    }

    /// Reads the views that the page offers.
    fn bookmarks(&self) -> Result<Vec<Bookmark>> {
        let Some(path) = &self.bookmarks else { return Ok(Vec::new()) };
        let read = serde_json::from_slice(&read_bytes(path)?);
        read.with_context(|| format!("--bookmarks {}: not a list of bookmarks", path.display()))
    }

    /// Returns the heading of the page.
    fn title(&self) -> String {
        self.title.clone().unwrap_or_else(|| self.file_name())
    }

    /// Returns the name of the model's file.
    fn file_name(&self) -> String {
        self.model.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 2;

/// Returns the memory of a page: the scene with its instances placed, and its copies as written, compressed, and as
/// text.
fn page_bytes(scene: &Scene, settings: &RenderSettings) -> Bytes {
    const COPIES: u64 = 3;
    Bytes(COPIES * scene_bytes(scene) + image_bytes(scene, settings, HeldPixels::Codes))
}

/// Runs the subcommand.
pub fn run(args: &ViewArgs) -> Result<()> {
    in_pool(None, || view(args))?
}

fn view(args: &ViewArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let mut warnings = Warnings::default();
    let viewer = viewer(args, &files, &mut warnings)?;
    let written = write(args, &viewer, &files)?;
    console::say_warnings(&warnings);
    let opened = args.output.is_none() && args.folder.is_none();
    if let Some(page) = written.first().filter(|_| opened) {
        open(page)
            .with_context(|| format!("{}: no browser opened it; write a page with -o", page.display()))?;
    }
    if args.json {
        return console::result(&serde_json::to_string_pretty(&report(args, &written, &warnings))?);
    }
    written.iter().try_for_each(|path| console::result(&path.display().to_string()))
}

/// Opens a page in the browser.
#[cfg(any(unix, windows))]
fn open(page: &Path) -> io::Result<()> {
    open::that(page)
}

/// WebAssembly starts no programs.
#[cfg(not(any(unix, windows)))]
fn open(_: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Reads the models and makes their page.
fn viewer(args: &ViewArgs, files: &FileSet, warnings: &mut Warnings) -> Result<Viewer> {
    let limits = args.limits.limits();
    let environment = args.light.environment(&limits, warnings)?;
    let loaded = studio::load(&args.model, &args.material, args.surface.bump_scale, &limits)?;
    files.protect(&loaded.files)?;
    let settings = args.settings();
    limits.check(format!("a page of {}", args.model.display()), page_bytes(&loaded.scene, &settings))?;
    let (facts, unit) = (viewer::facts(&loaded, &args.file_name()), model_unit(&loaded));
    warnings.absorb(loaded.warnings);
    args.light.note_unread(&loaded.scene, warnings);
    // The surface's attributes are made for the best method; the page shows the one asked for.
    let best = SurfaceSettings { method: None, ..settings.surface };
    let prepared = Prepared::new(loaded.scene, &best).with_context(|| args.model.display().to_string())?;
    warnings.absorb(prepared.warnings().clone());
    let is_in_metres = unit == Some(Unit::Metre);
    let scan = match args.scan.is_empty() {
        true => None,
        false => Some(ShownScan::read(is_in_metres, args, files, warnings)?),
    };
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
        rays: None,
    })?;
    warnings.absorb(viewer.warnings.clone());
    Ok(viewer)
}

/// The scan of a model.
struct ShownScan {
    scan: Scan,
    published: Option<Prepared>,
}

impl ShownScan {
    /// Reads the scan of a model as the options specify, otherwise as the model records it; in metres if the model
    /// is.
    fn read(is_in_metres: bool, args: &ViewArgs, files: &FileSet, warnings: &mut Warnings) -> Result<Self> {
        let limits = args.limits.limits();
        let what = args.scan.first().map_or_else(String::new, |path| path.display().to_string());
        let options = args.reading.options().or(ScanOptions::recorded(&args.model, &limits)?);
        let mut file =
            ScanFile::read_all(&args.scan, options, &limits, Progress::SILENT).context("--scan")?;
        if is_in_metres {
            file = file.into_metres().with_context(|| what.clone())?;
        }
        files.protect(file.files())?;
        let scene = args.publish_scan.then(|| file.scene().clone());
        let scan = file.into_scan(Progress::SILENT)?;
        warnings.absorb(scan.warnings().clone());
        let Some(scene) = scene else {
            console::say("the page holds no part of the scan; --publish-scan shows it under the wipe");
            return Ok(Self { scan, published: None });
        };
        limits.check(format!("a page of {what}"), page_bytes(&scene, &args.settings()))?;
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
    let path = match (&args.output, &args.folder) {
        (_, Some(folder)) => return write_folder(folder, &viewer.files(args.address.as_deref()), files),
        (Some(path), None) => path.clone(),
        (None, None) => temporary(args)?,
    };
    files.write_text(&path, &viewer.html())?;
    files.commit()?;
    Ok(vec![path])
}

/// Writes a folder and returns its files. Files of an earlier page are replaced, or removed if this one lacks them, so
/// that no scan stays published.
fn write_folder(folder: &Path, pages: &[PageFile], files: &FileSet) -> Result<Vec<PathBuf>> {
    let names: Vec<&str> = pages.iter().map(|file| file.name.as_str()).collect();
    let earlier = FolderFiles::read(folder);
    earlier.check(names.iter().copied())?;
    // One of them may be an input.
    let others: Vec<PathBuf> =
        earlier.others(&names).into_iter().filter(|path| files.reserve(path).is_ok()).collect();
    for file in pages {
        files.write_bytes(&folder.join(&file.name), &file.bytes)?;
    }
    files.commit()?;
    for path in others {
        fs::remove_file(&path).with_context(|| format!("{}: a file of the earlier page", path.display()))?;
    }
    Ok(names.iter().map(|name| folder.join(name)).collect())
}

/// The path of a page in a new folder for temporary files, which stays for the browser.
fn temporary(args: &ViewArgs) -> Result<PathBuf> {
    let folder = tempfile::Builder::new().prefix("taotie-view-").tempdir();
    let folder = folder.context("a temporary folder could not be created; write a page with -o")?;
    let stem = args.model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(folder.keep().join(format!("{stem}.html")))
}

/// The report on a page.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The name of the model's file, without folders.
    model: String,
    /// The names of the written files, the page first.
    files: Vec<String>,
    /// The names of the scan's files, without folders; empty without a scan.
    scan: Vec<String>,
    /// The environment; `None` without one.
    environment: Option<EnvironmentReport>,
    /// Problems and corrections.
    warnings: Vec<Warning>,
}

fn report(args: &ViewArgs, written: &[PathBuf], warnings: &Warnings) -> Report {
    Report {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        model: console::name_of(&args.model),
        files: written.iter().map(|path| console::name_of(path)).collect(),
        scan: args.scan.iter().map(|path| console::name_of(path)).collect(),
        environment: args.light.environment_report(),
        warnings: warnings.list(),
    }
}
