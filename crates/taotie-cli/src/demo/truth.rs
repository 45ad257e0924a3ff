//! The jue's methods measured against its relief as geometry.

use super::DemoArgs;
use super::stage::{self, Stage};
use crate::compare::{
    self, Comparison, Destination, Matching, Method, Plan, PointChoice, Report, Subject, SubjectReport,
};
use anyhow::Result;
use std::path::PathBuf;
use taotie::mesh::Mesh;
use taotie::scene::{Scene, SceneData};
use taotie::shade::Shading;

/// Pixels along a side of the comparison's pictures.
const SIDE: u32 = 560;
/// The angle at the top of the heat maps' scale, degrees.
const HEAT_TOP_DEG: f64 = 30.0;

/// Compares the methods on the cup with the displaced mesh `reference`; writes the report into a folder of its own.
///
/// # Errors
/// Those of rendering and writing.
pub fn write(args: &DemoArgs, scene: &Scene, reference: Scene) -> Result<(Report, Vec<PathBuf>)> {
    let Stage { camera, lighting } = Stage::cup(scene);
    let plan = Plan {
        methods: Method::defaults(),
        shadings: vec![Shading::Ggx],
        points: PointChoice::Spread(10),
        // The displaced mesh keeps the low mesh's uvs.
        matching: Matching::Uv,
        camera,
        lighting,
        settings: Stage::settings(SIDE, 4),
        development: stage::development(),
        heat_top_deg: HEAT_TOP_DEG,
        material: serde_json::Value::Null,
        environment: serde_json::Value::Null,
    };
    let subject = SubjectReport {
        model: "the built-in jue".into(),
        triangles: scene.triangle_count(),
        reference: Some("its relief as geometry".into()),
        reference_triangles: Some(reference.triangle_count()),
    };
    let mut pair = Subject { scene: scene.clone(), reference: Some(reference) };
    let comparison = Comparison::take(&mut pair, &plan)?;
    let folder = args.out.join("comparison");
    let destination = Destination { folder: &folder, title: "A bronze jue of 251 vertices" };
    compare::write(&comparison, &plan, &subject, &destination)
}

/// The same bronze with its relief as geometry, which `mesh` has.
pub fn with_relief(scene: &Scene, mesh: Mesh) -> Scene {
    let mut data = SceneData { meshes: vec![mesh], ..scene.data().clone() };
    for material in &mut data.materials {
        (material.normal, material.height) = (None, None);
    }
    Scene::new(data).expect("one mesh takes the place of another")
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
