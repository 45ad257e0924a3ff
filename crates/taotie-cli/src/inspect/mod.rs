//! `taotie inspect`: the content of a model file and its defects.
//!
//! The library's [`Inspection`] is made once; the text and the JSON are two ways to print it.

mod args;
mod audit;
mod report;
mod sizes;
mod text;
mod values;
mod words;

pub use args::InspectArgs;

use crate::{Outcome, console};
use anyhow::Result;
use report::Report;
use taotie::asset::Bytes;
use taotie::inspection::Inspection;
use taotie_engine::render::{framing_bytes, scene_bytes};
use taotie_engine::scene::Scene;
use taotie_io::{GltfSizes, GltfSource};

/// Runs the subcommand.
pub fn run(args: &InspectArgs) -> Result<Outcome> {
    match &args.audit {
        Some(schema) => audit::run(args, schema),
        None => inspect(args).map(|()| Outcome::Fine),
    }
}

fn inspect(args: &InspectArgs) -> Result<()> {
    let limits = args.limits.limits();
    let loaded = taotie_io::load_model_within(&args.model, &limits)?;
    limits.check(args.model.display().to_string(), Bytes(need(&loaded.scene)))?;
    let mut inspection = Inspection::of(&loaded);
    if loaded.structure.is_some() {
        inspection.sizes = Some(GltfSizes::read(GltfSource::File(&args.model), &limits)?);
    }
    let report = Report::new(&args.model, inspection);
    match args.json {
        true => console::result(&serde_json::to_string_pretty(&report)?),
        false => console::result(text::of(&report).trim_end()),
    }
}

/// Returns the memory of an inspection, bytes: the scene, the tangents to compare its own with, and the counts.
fn need(scene: &Scene) -> u64 {
    /// Counts of a triangle, over all instances, bytes.
    const TRIANGLE: u64 = 12;
    scene_bytes(scene) + framing_bytes(scene, |_| true) + scene.triangle_count() as u64 * TRIANGLE
}
