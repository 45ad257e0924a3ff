//! The jue's methods measured against its relief as geometry.

use crate::compare::{self, Destination, Echoes, Report};
use anyhow::Result;
use serde_json::Value;
use std::path::{Path, PathBuf};
use taotie::comparison::{ComparisonOptions, Matching, Subject};
use taotie::scene::Scene;
use taotie_study::demo::stage::{self, Stage};

/// Pixels along a side of the comparison's pictures.
const SIDE: u32 = 560;
/// The angle at the top of the heat maps' scale, degrees.
const HEAT_TOP_DEG: f64 = 30.0;

/// Compares the methods on the cup with the displaced mesh `reference`; writes the report into a folder of its own
/// below `out`.
///
/// # Errors
/// Those of rendering and writing.
pub fn write(out: &Path, scene: &Scene, reference: Scene) -> Result<(Report, Vec<PathBuf>)> {
    let Stage { camera, lighting } = Stage::cup(scene)?;
    let options = ComparisonOptions {
        // The displaced mesh keeps the low mesh's uvs.
        matching: Matching::Uv,
        camera: Some(camera),
        lighting: Some(lighting),
        settings: Stage::settings(SIDE, 4),
        development: stage::development(),
        ..ComparisonOptions::default()
    };
    let subject =
        Subject::new("the built-in jue", scene).with_reference("its relief as geometry", &reference);
    let comparison = compare::compared(&subject, &options)?;
    let folder = out.join("comparison");
    let destination = Destination { folder: &folder, title: "A bronze jue of 251 vertices" };
    let echoes = Echoes { material: Value::Null, environment: Value::Null, heat_top_deg: HEAT_TOP_DEG };
    compare::write(&comparison, &echoes, &destination)
}

/// The errors of three methods, and why they stand in this order.
pub fn lines(report: &Report) -> Vec<String> {
    let mut lines = vec!["mean angular error against the displaced mesh, away from silhouettes:".to_string()];
    for (name, why) in REASONS {
        let mean = report.method(name).and_then(|method| method.inner_mean());
        let Some(mean) = mean else { continue };
        lines.push(format!("  {name:<15} {mean:>6.2}°  {why}"));
    }
    lines
}

/// In the order of their errors.
const REASONS: [(&str, &str); 3] = [
    ("smooth", "knows nothing of the relief: its error is the relief's own slope"),
    (
        "bump",
        "has the relief's slope from its heights, but not how the bronze differs from the mesh's smooth normals",
    ),
    (
        "tangent-normal",
        "has the bronze's normals themselves: what is left is the size of texels and their filtering",
    ),
];
