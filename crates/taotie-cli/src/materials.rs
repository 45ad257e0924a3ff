//! `taotie materials`: the presets, their measured colours, and what they look like.

use crate::{console, options, stop};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie_engine::math::Vec3;
use taotie_engine::scene::{Material, PRESETS, Preset, preset};
use taotie_engine::shade::fresnel::{COS_82, f_schlick};
use taotie_report::sheet::swatches;
use taotie_report::table::Table;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// Reflectance of an ordinary dielectric at normal incidence.
const DIELECTRIC_F0: f32 = 0.04;

const EXAMPLES: &str = "\
Examples:
  taotie materials
  taotie materials -o swatches.png
  taotie render vessel.glb --material brass --env studio -o vessel.png

F0 is the reflectance along the normal, F82 that at 82 degrees from it, both in linear sRGB.";

/// Lists the material presets for `--material`.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct MaterialsArgs {
    /// Also write a PNG with a sphere of each preset in the built-in studio environment
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,
    /// Width and height of each sphere's picture, pixels
    #[arg(long, value_name = "N", default_value = "256", requires = "output", value_parser = options::square::<16>)]
    pub size: u32,
    /// Print the list as JSON
    #[arg(long)]
    pub json: bool,
}

/// The presets.
#[derive(Serialize)]
struct List<'a> {
    schema: u32,
    /// The presets, in the order of the documentation.
    materials: &'a [Entry],
    /// The path of the written picture; `None` without one.
    swatches: Option<&'a Path>,
}

/// A preset in the list.
#[derive(Serialize)]
struct Entry {
    /// Its name, for `--material`.
    name: &'static str,
    /// A description.
    what: &'static str,
    /// The source of its colours.
    source: &'static str,
    /// Linear RGB.
    base_color: [f32; 3],
    /// The metallic factor, [0, 1].
    metallic: f32,
    /// The perceptual roughness, [0, 1].
    roughness: f32,
    /// The reflectance along the normal, linear RGB.
    f0: [f32; 3],
    /// The reflectance at 82° from the normal, linear RGB.
    f82: [f32; 3],
    /// True if F82 is measured; otherwise it is Schlick's.
    f82_given: bool,
}

/// Runs the subcommand.
pub fn run(args: &MaterialsArgs) -> Result<()> {
    if let Some(path) = &args.output {
        let files = stop::files();
        files.claim(path)?;
        files.write_png(path, &swatches(args.size)?.png())?;
        files.commit()?;
    }
    let entries: Vec<Entry> = PRESETS.iter().filter_map(Entry::new).collect();
    if args.json {
        let list = List { schema: SCHEMA, materials: &entries, swatches: args.output.as_deref() };
        return console::result(&serde_json::to_string_pretty(&list)?);
    }
    console::result(text(&entries).trim_end())
}

impl Entry {
    fn new(listed: &Preset) -> Option<Self> {
        let material = preset(listed.name)?;
        let [r, g, b, _] = material.base_color;
        let f0 = reflectance(&material);
        Some(Self {
            name: listed.name,
            what: listed.what,
            source: listed.source,
            base_color: [r, g, b],
            metallic: material.metallic,
            roughness: material.roughness,
            f0,
            f82: material.f82.unwrap_or_else(|| f_schlick(Vec3::from_array(f0), COS_82 as f32).to_array()),
            f82_given: material.f82.is_some(),
        })
    }
}

/// Returns F0 as rendered.
fn reflectance(material: &Material) -> [f32; 3] {
    let mixed =
        |c: usize| DIELECTRIC_F0 * (1.0 - material.metallic) + material.base_color[c] * material.metallic;
    material.f0.unwrap_or_else(|| [0, 1, 2].map(mixed))
}

fn text(entries: &[Entry]) -> String {
    let mut table = Table::new(&["name", "F0", "F82", ">metallic", ">roughness", "what", "source"]);
    for entry in entries {
        let f82 = format!("{}{}", color(entry.f82), if entry.f82_given { "" } else { " (Schlick)" });
        table.row([
            entry.name.into(),
            color(entry.f0),
            f82,
            format!("{:.2}", entry.metallic),
            format!("{:.2}", entry.roughness),
            entry.what.into(),
            entry.source.into(),
        ]);
    }
    table.lines(0)
}

fn color(rgb: [f32; 3]) -> String {
    rgb.map(|c| format!("{c:.3}")).join(" ")
}
