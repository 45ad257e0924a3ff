//! `taotie inspect`: what is in a model and what is wrong with it.
//!
//! A [`Report`] is made once; the text and the JSON are two ways to print it.

mod hints;
mod layers;
mod material;
mod mesh;
mod normal_map;
mod report;
mod tangents;
mod text;
mod uvs;

use crate::console;
use anyhow::Result;
use clap::Args;
use report::Report;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  taotie inspect statue.glb
  taotie inspect statue.obj --json

Counted as unhealthy:
  uvs       triangles with a corner outside [0, 1], without uv area, or mirrored (uvs run clockwise)
  tangents  more than 1 % from unit length, more than 1 degree from perpendicular to the normal,
            triangles whose corners differ in handedness; where the material has a normal map, the
            angle to MikkTSpace's tangents
  texels    of a tangent-space normal map whose blue is not above one half";

/// Says what is in a model and what is wrong with it.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct InspectArgs {
    /// The model: .gltf, .glb, .obj, .ply or .stl
    pub model: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
}

/// Runs the subcommand.
pub fn run(args: &InspectArgs) -> Result<()> {
    let loaded = taotie::io::load_model(&args.model)?;
    let report = Report::new(&args.model, &loaded);
    match args.json {
        true => console::result(&serde_json::to_string_pretty(&report)?),
        false => console::result(text::of(&report).trim_end()),
    }
}
