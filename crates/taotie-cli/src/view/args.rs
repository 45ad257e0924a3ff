//! The options of `taotie view`.

use crate::bake::ScanArgs;
use crate::limits::LimitArgs;
use crate::studio::{
    self, CameraArgs, FilmArgs, Framing, LightArgs, MaterialArgs, ReflectionArgs, SurfaceArgs,
};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie_engine::render::{RenderSettings, SurfaceSettings};
use taotie_engine::shade::Shading;
use taotie_io::{FileSet, read_bytes};
use taotie_report::viewer::Bookmark;

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
    /// The model: .gltf, .glb, .obj, .ply or .stl
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
    /// The scan of the model: the page shows the measured error on the model, but no part of the scan
    #[arg(long, value_name = "SCAN")]
    pub scan: Option<PathBuf>,
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
pub const FRAMING: Framing = Framing { size: [1024, 1024], all_around: false };

impl ViewArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
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
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect([&self.model])?;
        files.protect(&self.scan)?;
        files.protect(&self.bookmarks)?;
        files.protect(studio::material_files(&self.material)?)?;
        files.protect(self.light.environment_file())?;
        match (&self.output, &self.folder) {
            (Some(path), _) => Ok(files.claim(path)?),
            (None, Some(folder)) => Ok(files.claim_folder(folder)?),
            (None, None) => Ok(()),
        }
    }

    /// Returns the settings that `taotie render` has with the same options.
    pub fn settings(&self) -> RenderSettings {
        let shown = self.surface.settings();
        self.reflection.apply(RenderSettings {
            samples: self.film.samples(),
            surface: SurfaceSettings { tangents: self.material.tangents, ..shown.surface },
            ..shown
        })
    }

    /// Reads the views that the page offers.
    pub fn bookmarks(&self) -> Result<Vec<Bookmark>> {
        let Some(path) = &self.bookmarks else { return Ok(Vec::new()) };
        let read = serde_json::from_slice(&read_bytes(path)?);
        read.with_context(|| format!("--bookmarks {}: not a list of bookmarks", path.display()))
    }

    /// Returns the heading of the page.
    pub fn title(&self) -> String {
        self.title.clone().unwrap_or_else(|| self.file_name())
    }

    /// Returns the name of the model's file.
    pub fn file_name(&self) -> String {
        self.model.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}
