//! The document that `taotie compare --json` prints, as a program in another language would read it.
//!
//! Adding or removing a field changes the schema: it needs a new number, here and in the command.
#![allow(dead_code)]

use super::json::{Counted, Spread, parse};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CompareReport {
    schema: u32,
    kind: String,
    version: String,
    subject: Compared,
    against: String,
    unmatched: f64,
    parameters: BTreeMap<String, serde_json::Value>,
    rules: BTreeMap<String, String>,
    methods: Vec<ComparedMethod>,
    skipped: Vec<SkippedMethod>,
    points: Vec<Point>,
    notes: Vec<String>,
    times: Vec<MethodTime>,
    warnings: Vec<Counted>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodTime {
    method: String,
    milliseconds: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Compared {
    model: String,
    triangles: usize,
    reference: Option<String>,
    reference_triangles: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ComparedMethod {
    method: String,
    what: String,
    normals: String,
    error: Option<AngularError>,
    pictures: Vec<ComparedPicture>,
    models: Vec<ComparedModel>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ComparedModel {
    shading: String,
    baseline: String,
    difference: PictureFigures,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AngularError {
    heat: String,
    all: Option<Spread>,
    inner: Option<Spread>,
    histogram: Vec<u64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ComparedPicture {
    shading: String,
    file: String,
    difference: Option<PictureFigures>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PictureFigures {
    rmse: f64,
    psnr: Option<f64>,
    ssim: f64,
    flip: Option<Spread>,
    pixels: usize,
    flip_map: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SkippedMethod {
    method: String,
    reason: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    pixel: [u32; 2],
    normals: Vec<PointNormal>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PointNormal {
    method: String,
    normal: Option<[f32; 3]>,
    angle_to_first: Option<f64>,
    error: Option<f64>,
}

#[test]
fn of_compare() {
    let line = "compare a.gltf --method smooth,bump,tangent-normal --points 3 --size 48x32 --baseline phong -o out --json";
    let report: CompareReport = parse(line);
    assert_eq!((report.schema, report.kind.as_str()), (4, "taotie compare"));
    assert_eq!(report.parameters["baseline"], "phong");
    assert_eq!((report.subject.model.as_str(), report.subject.triangles), ("a.gltf", 2));
    assert_eq!((report.against.as_str(), report.unmatched), ("smooth", 0.0));
    assert_eq!(report.parameters["size"], serde_json::json!([48, 32]));
    assert_eq!(report.parameters["points"], "3");
    assert_eq!(report.parameters["heat_top_deg"], 30.0);
    assert_eq!(report.parameters["material"]["normal_space"], "tangent");
    assert!(
        ["silhouettes", "points", "pictures", "places"].iter().all(|rule| report.rules[*rule].len() > 20)
    );
    let [smooth, tangent] = report.methods.as_slice() else { panic!("two methods are drawn") };
    assert!(smooth.error.is_none() && smooth.pictures[0].difference.is_none());
    let model = &tangent.models[0];
    assert_eq!((model.shading.as_str(), model.baseline.as_str()), ("ggx", "phong"));
    assert_eq!(model.difference.flip_map, "tangent-normal.ggx-phong.flip.png");
    let error = tangent.error.as_ref().expect("it is measured");
    let all = error.all.as_ref().expect("it is seen");
    assert!(all.mean > 0.0 && all.median <= all.p95 && all.p95 <= all.max);
    assert_eq!(error.histogram.iter().sum::<u64>(), all.count as u64);
    assert_eq!(report.skipped[0].method, "bump");
    let timed: Vec<&str> = report.times.iter().map(|time| time.method.as_str()).collect();
    assert_eq!(timed, ["smooth", "tangent-normal"]);
    assert!(report.times.iter().all(|time| time.milliseconds > 0.0));
    assert_eq!(report.points.len(), 3);
    assert!(report.points.iter().all(|point| point.normals.len() == 2));
}
