//! `taotie demo`: the built-in bronze by every surface method and every shading model, and measured against the truth.

mod export;
mod gallery;
mod glb;
mod moving;
mod stage;
mod truth;

use crate::compare::Report;
use crate::console::{self, Bar};
use crate::jue;
use crate::studio::in_pool;
use anyhow::Result;
use clap::Args;
use gallery::Made;
use serde_json::json;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  taotie demo
  taotie demo --out pictures --size 512
  taotie demo --high";

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 2;

/// Renders the built-in bronze jue by every method and model, and measures them.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct DemoArgs {
    /// Folder to write to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "taotie-demo")]
    pub out: PathBuf,
    /// Side of each picture of the contact sheet, pixels
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = clap::value_parser!(u32).range(64..=2048))]
    pub size: u32,
    /// Also writes the bronze with its relief as geometry, more than two million triangles, as jue-high.glb
    #[arg(long)]
    pub high: bool,
    /// Threads; all of the machine's if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub threads: Option<u32>,
    /// Print a report as JSON
    #[arg(long)]
    pub json: bool,
}

/// Texels along a side of the jue's maps.
const MAPS: u32 = 2048;

/// What was made.
struct Demo {
    files: Vec<PathBuf>,
    made: Vec<Made>,
    comparison: Report,
    moving: moving::Report,
}

/// Runs the subcommand.
pub fn run(args: &DemoArgs) -> Result<()> {
    std::fs::create_dir_all(&args.out).map_err(|error| taotie::Error::io(&args.out, error))?;
    let threads = args.threads.map(|threads| threads as usize);
    let demo = in_pool(threads, || demo(args))??;
    if args.json {
        return console::result(&serde_json::to_string_pretty(&demo.json())?);
    }
    demo.print()
}

fn demo(args: &DemoArgs) -> Result<Demo> {
    let scene = jue::scene(MAPS);
    let object_scene = gallery::with_object_map(&scene);
    let mut files = export::write(&args.out, &scene)?;
    files.push(glb::write_pouring(&args.out, &scene)?);
    let progress = Bar::new("pictures");
    let (sheet, made) = gallery::write_sheet(args, [&object_scene, &scene], &|done| progress.set(done))?;
    files.push(sheet);
    files.push(gallery::write_large(args, &scene)?);
    drop(progress);
    let high = truth::with_relief(&scene, jue::displaced_mesh(jue::FINEST));
    if args.high {
        files.push(glb::write_high(&args.out, &high)?);
    }
    let progress = Bar::new("moving surface");
    let (moving, written) =
        moving::write(args, [&object_scene, &scene], &high.meshes()[0], &|done| progress.set(done))?;
    files.extend(written);
    drop(progress);
    let (comparison, written) = truth::write(args, &scene, high)?;
    files.extend(written);
    Ok(Demo { files, made, comparison, moving })
}

impl Demo {
    fn print(&self) -> Result<()> {
        console::result(&format!("{:<22} {:<15} {:<22} {:>8}", "picture", "surface", "shading", "ms"))?;
        for made in &self.made {
            console::result(&made.line())?;
        }
        console::result("")?;
        for line in truth::lines(&self.comparison).into_iter().chain(moving::lines(&self.moving)) {
            console::result(&line)?;
        }
        console::result("")?;
        for file in &self.files {
            console::result(&format!("wrote {}", file.display()))?;
        }
        Ok(())
    }

    fn json(&self) -> serde_json::Value {
        json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "files": self.files,
            "pictures": self.made.iter().map(Made::json).collect::<Vec<_>>(),
            "comparison": self.comparison,
            "moving": self.moving,
        })
    }
}
