//! `taotie inspect`: the content of a model file and its defects.
//!
//! The library's [`Inspection`] is made once; the text and the JSON are two ways to print it.

mod audit;
mod sizes;
mod text;
mod words;

use crate::limits::LimitArgs;
use crate::{Outcome, console};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use taotie::asset::Bytes;
use taotie::inspection::Inspection;
use taotie::io::{GltfSizes, GltfSource};
use taotie::render::{framing_bytes, scene_bytes};
use taotie::scene::Scene;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 5;

const EXAMPLES: &str = "\
Examples:
  taotie inspect statue.glb
  taotie inspect statue.obj --json
  taotie inspect statue.glb --audit schema.json

Counted as defects:
  UVs       triangles with a corner outside [0, 1], without UV area, or mirrored (UVs run clockwise)
  tangents  more than 1 % from unit length, more than 1 degree from perpendicular to the normal,
            triangles whose corners differ in handedness; where the material has a normal map, the
            angle to MikkTSpace's tangents
  texels    of a tangent-space normal map whose blue is not above one half";

/// Lists the content of a model file and its defects.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct InspectArgs {
    /// The model: .gltf, .glb, .obj, .ply or .stl
    pub model: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
    /// Check the model against a schema of the Khronos glTF Asset Auditor instead; exit code 1 if a check fails
    #[arg(long, value_name = "SCHEMA")]
    pub audit: Option<PathBuf>,
    /// Dimensions of the product that the model shows, JSON as the auditor reads it
    #[arg(long, value_name = "FILE", requires = "audit")]
    pub product_info: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// The report as it is printed.
#[derive(Debug, Serialize)]
struct Report {
    /// [`SCHEMA`].
    schema: u32,
    /// Of the program.
    version: &'static str,
    /// The path asked for.
    model: String,
    #[serde(flatten)]
    inspection: Inspection,
    /// Suggestions.
    hints: Vec<String>,
}

/// Runs the subcommand.
pub fn run(args: &InspectArgs) -> Result<Outcome> {
    match &args.audit {
        Some(schema) => audit::run(args, schema),
        None => inspect(args).map(|()| Outcome::Fine),
    }
}

fn inspect(args: &InspectArgs) -> Result<()> {
    let limits = args.limits.limits();
    let loaded = taotie::io::load_model_within(&args.model, &limits)?;
    limits.check(args.model.display().to_string(), Bytes(need(&loaded.scene)))?;
    let mut inspection = Inspection::of(&loaded);
    if loaded.structure.is_some() {
        inspection.sizes = Some(GltfSizes::read(GltfSource::File(&args.model), &limits)?);
    }
    let report = Report {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        model: args.model.display().to_string(),
        hints: inspection.hints().iter().filter_map(words::hint).collect(),
        inspection,
    };
    match args.json {
        true => console::result(&serde_json::to_string_pretty(&report)?),
        false => console::result(text::of(&report).trim_end()),
    }
}

/// Returns the bytes that an inspection takes: the scene, the tangents that its own are held against, and what is counted.
fn need(scene: &Scene) -> u64 {
    /// What is counted of a triangle, over all instances.
    const TRIANGLE: u64 = 12;
    scene_bytes(scene) + framing_bytes(scene, |_| true) + scene.triangle_count() as u64 * TRIANGLE
}
