//! `taotie demo`: the built-in bronze with every surface method and every shading model, compared with its relief as
//! geometry.

use crate::console::{self, Bar};
use crate::running::RunArgs;
use crate::{options, stop};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use taotie_engine::Progress;
use taotie_io::FileSet;
use taotie_report::comparison::Document;
use taotie_study::demo::gallery::{self, Made};
use taotie_study::demo::{Output, Vessel, export, glb, moving, truth};
use taotie_study::jue;

const EXAMPLES: &str = "\
Examples:
  taotie demo
  taotie demo --out pictures --size 512
  taotie demo --high";

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 2;

/// Renders the built-in bronze jue, a ritual vessel, with every surface method and shading model, and measures their
/// error.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct DemoArgs {
    /// Folder to write to; created if missing
    #[arg(long, value_name = "DIR", default_value = "taotie-demo")]
    pub out: PathBuf,
    /// Width and height of each picture of the contact sheet, pixels
    #[arg(long, value_name = "N", default_value = "360", value_parser = options::square::<64>)]
    pub size: u32,
    /// Also write the bronze with its relief as geometry, more than two million triangles, as jue-high.glb
    #[arg(long)]
    pub high: bool,
    #[command(flatten)]
    pub run: RunArgs,
}

/// Texels along a side of the jue's maps.
const MAPS: u32 = 2048;

/// The written files, and their figures.
#[derive(Serialize)]
struct Demo {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The paths of the written files.
    files: Vec<PathBuf>,
    /// The pictures of the contact sheet.
    pictures: Vec<Made>,
    /// The surface methods compared with the relief as geometry.
    comparison: Document,
    /// The kinds of normal maps on the moving vessel.
    moving: moving::Report,
}

/// Runs the subcommand.
pub fn run(args: &DemoArgs) -> Result<()> {
    let files = stop::files();
    files.claim_folder(&args.out)?;
    let demo = args.run.in_pool(|| demo(args, &files))??;
    if args.run.json {
        return console::result(&serde_json::to_string_pretty(&demo)?);
    }
    demo.print()
}

fn demo(args: &DemoArgs, set: &FileSet) -> Result<Demo> {
    let vessel = Vessel::new(MAPS);
    let output = Output { files: set, folder: &args.out, side: args.size };
    let mut files = export::write(&output, &vessel)?;
    files.push(glb::write_pouring(&output, &vessel)?);
    let bar = Bar::new("pictures");
    let (sheet, pictures) = gallery::write_sheet(&vessel, &output, &|done| bar.set(done))?;
    files.push(sheet);
    files.push(gallery::write_large(&vessel, &output)?);
    drop(bar);
    let high = jue::displaced_mesh(jue::FINEST);
    if args.high {
        files.push(glb::write_high(&output, &high)?);
    }
    let bar = Bar::new("moving surface");
    let (moving, sheet) = moving::write(&vessel, &high, &output, &|done| bar.set(done))?;
    files.push(sheet);
    drop(bar);
    let high = jue::with_relief(vessel.scene(), high);
    let bar = Bar::new("compare");
    let listener = |_: &'static str, done: f64| bar.hear(done);
    let compared = truth::write(&output, vessel.scene(), &high, Progress::new(&listener))?;
    files.extend(compared.files);
    set.commit()?;
    let version = env!("CARGO_PKG_VERSION");
    Ok(Demo { schema: SCHEMA, version, files, pictures, comparison: compared.document, moving })
}

fn line_of(made: &Made) -> String {
    let Made { title, surface, shading, milliseconds, .. } = made;
    format!("{title:<22} {surface:<15} {shading:<22} {milliseconds:>8.0}")
}

impl Demo {
    fn print(&self) -> Result<()> {
        console::result(&format!("{:<22} {:<15} {:<22} {:>8}", "picture", "surface", "shading", "ms"))?;
        for made in &self.pictures {
            console::result(&line_of(made))?;
        }
        console::result("")?;
        for line in truth::lines(&self.comparison).into_iter().chain(self.moving.lines()) {
            console::result(&line)?;
        }
        console::result("")?;
        for file in &self.files {
            console::result(&format!("wrote {}", file.display()))?;
        }
        Ok(())
    }
}
