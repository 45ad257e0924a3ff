//! Surface methods of the jue, measured against its relief as geometry.

use super::Output;
use super::stage::{self, Stage};
use taotie::comparison::{Comparison, ComparisonOptions, Matching, Subject};
use taotie_engine::scene::Scene;
use taotie_engine::{Progress, Result};
use taotie_report::comparison::{self, Document, Written};

/// The side of the comparison's pictures, pixels.
const SIDE: u32 = 560;

/// Compares the methods on the cup with the displaced mesh `reference`, and writes the report to the folder
/// `comparison`.
///
/// # Errors
/// Those of rendering and writing, and [`taotie_engine::Error::Cancelled`].
pub fn write(
    output: &Output<'_>,
    scene: &Scene,
    reference: &Scene,
    progress: Progress<'_>,
) -> Result<Written> {
    let options = options(scene)?;
    let subject = Subject::new("the built-in jue", scene).with_reference("its relief as geometry", reference);
    let compared = Comparison::of(&subject, &options, progress)?;
    let options = comparison::Options {
        title: "A bronze jue of 251 vertices".into(),
        ..comparison::Options::default()
    };
    comparison::write_in(output.files, &compared, &options, &output.folder.join("comparison"))
}

/// Returns the options of the comparison: all methods, seen by the camera of the cup.
///
/// # Errors
/// None are expected, since the scene is generated.
pub fn options(scene: &Scene) -> Result<ComparisonOptions> {
    let Stage { camera, lighting } = Stage::cup(scene)?;
    Ok(ComparisonOptions {
        // The displaced mesh keeps the low mesh's uvs.
        matching: Matching::Uv,
        camera: Some(camera),
        lighting: Some(lighting),
        settings: Stage::settings(SIDE, 4),
        development: stage::development(),
        ..ComparisonOptions::default()
    })
}

/// Returns the errors of the methods in [`REASONS`] as lines of text, with the reasons for their order.
pub fn lines(report: &Document) -> Vec<String> {
    let mut lines = vec!["mean angular error against the displaced mesh, away from silhouettes:".to_string()];
    for (name, why) in REASONS {
        let mean = report.method(name).and_then(|method| method.inner_mean());
        let Some(mean) = mean else { continue };
        lines.push(format!("  {name:<15} {mean:>6.2}°  {why}"));
    }
    lines
}

/// The methods with the reasons for their errors, the largest error first.
pub const REASONS: [(&str, &str); 3] = [
    ("smooth", "has no relief: its error is the relief's own slope"),
    (
        "bump",
        "has the slope of the relief from its heights, but not the bronze's deviation from the smooth mesh normals",
    ),
    ("tangent-normal", "has the bronze's own normals: the rest is due to texel size and filtering"),
];
