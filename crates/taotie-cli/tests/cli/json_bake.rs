//! The document that `taotie bake --json` prints, and writes as `OUT.report.json`.
//!
//! A field more or less is a change of schema: it needs a new number, here and in the command.
#![allow(dead_code)]

use super::balls::{LOW, SCAN};
use super::json::Spread;
use super::place::Place;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BakeReport {
    schema: u32,
    kind: String,
    version: String,
    high: String,
    high_sha256: String,
    high_triangles: usize,
    low: Option<String>,
    origin: Origin,
    triangles: Vec<usize>,
    size: [u32; 2],
    parameters: Parameters,
    files: Vec<String>,
    maps: Vec<Map>,
    carried: Vec<String>,
    left: Vec<Left>,
    proof: Option<Proof>,
    required: Vec<Met>,
    trials: Vec<Trial>,
    stages: Vec<Stage>,
    warnings: Vec<Counted>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Origin {
    simplified: Option<Simplified>,
    islands: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Simplified {
    method: String,
    error: f64,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Parameters {
    triangles: Option<u32>,
    error_deg: Option<f64>,
    lods: Vec<u32>,
    size: Option<u32>,
    maps: Vec<String>,
    space: String,
    samples: u32,
    bits: u8,
    dilation: AutoOr,
    ao_rays: u32,
    ao_distance: Option<f64>,
    roughness: Option<f64>,
    ray_distance: AutoOr,
    cage: Option<String>,
    images: String,
    webp_quality: Option<u8>,
    uastc_rdo: Option<u8>,
    jpeg: Option<u8>,
    meshopt: bool,
    green: String,
    crease_angle_deg: AutoOr,
    scan_green: String,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(untagged)]
enum AutoOr {
    Auto(String),
    Given(f64),
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Map {
    map: String,
    material: Option<String>,
    file: Option<String>,
    bits: u8,
    black: Option<f64>,
    white: Option<f64>,
    unit: String,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Left {
    what: String,
    part: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Proof {
    angles: Option<Spread>,
    histogram: Vec<usize>,
    without_map: Option<Spread>,
    floor_8_bit: Option<[f64; 2]>,
    missed_texels: f64,
    fallback: f64,
    lost: f64,
    hausdorff: f64,
    hausdorff_of_diagonal: f64,
    rms: f64,
    rms_of_diagonal: f64,
    diagonal: f64,
    density: Option<Spread>,
    uv_use: f64,
    views: Vec<View>,
    full_views: Vec<View>,
    material: MaterialFigures,
    unseen: Vec<String>,
    parts: Vec<Part>,
    fit: Option<Fit>,
    bytes_in: u64,
    bytes_out: u64,
    levels: Vec<Level>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Part {
    material: String,
    triangles: usize,
    angles: Option<Spread>,
    without_map: Option<Spread>,
    missed: f64,
    lost: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Level {
    triangles: usize,
    angles: Option<Spread>,
    histogram: Vec<usize>,
    without_map: Option<Spread>,
    missed: f64,
    lost: f64,
    hausdorff: f64,
    hausdorff_of_diagonal: f64,
    rms: f64,
    rms_of_diagonal: f64,
    material: MaterialFigures,
    views: Vec<View>,
    full_views: Vec<View>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialFigures {
    color: Option<Spread>,
    metallic: Option<Spread>,
    roughness: Option<Spread>,
    emission: Option<Spread>,
    alpha: Option<Spread>,
    not_finite: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct View {
    azimuth_deg: f64,
    elevation_deg: f64,
    flip: f64,
    ssim: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fit {
    away: f64,
    turned: f64,
    distance_of_diagonal: f64,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Met {
    figure: String,
    most: f64,
    level: Option<usize>,
    value: Option<f64>,
    met: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Trial {
    triangles: usize,
    size: u32,
    mean_angle: f64,
    bytes: Option<u64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stage {
    stage: String,
    milliseconds: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Counted {
    what: String,
    count: usize,
}

#[test]
fn of_a_pair() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let line =
        "bake scan.obj --low low.obj -o out.glb --size 64 --maps normal,height --require mean-angle=9 --json";
    let printed = place.json(line);
    let written: serde_json::Value = serde_json::from_slice(&place.read("out.report.json")).unwrap();
    assert_eq!(printed, written);
    let report: BakeReport = serde_json::from_value(printed).expect("the document has this form");
    assert_eq!((report.schema, report.version.as_str()), (3, env!("CARGO_PKG_VERSION")));
    assert_eq!((report.high.as_str(), report.low.as_deref()), ("scan.obj", Some("low.obj")));
    assert_eq!((report.high_triangles, report.triangles, report.size), (9024, vec![528], [64; 2]));
    assert_eq!(report.high_sha256.len(), 64);
    let auto = || AutoOr::Auto("auto".into());
    let parameters = Parameters {
        triangles: None,
        error_deg: None,
        lods: vec![],
        size: Some(64),
        maps: vec!["normal".into(), "height".into()],
        space: "tangent".into(),
        samples: 4,
        bits: 8,
        dilation: auto(),
        ao_rays: 64,
        ao_distance: None,
        roughness: None,
        ray_distance: auto(),
        cage: None,
        images: "png".into(),
        webp_quality: None,
        uastc_rdo: None,
        jpeg: None,
        meshopt: false,
        green: "up".into(),
        crease_angle_deg: auto(),
        scan_green: "auto".into(),
    };
    assert_eq!(report.parameters, parameters);
    assert_eq!(report.files, ["out.glb", "out.height.png", "out.report.html", "out.report.json"]);
    let [normal, height] = report.maps.as_slice() else { panic!("two maps were asked for") };
    assert_eq!((normal.map.as_str(), &normal.file), ("normal", &None));
    assert_eq!((height.file.as_deref(), height.bits), (Some("out.height.png"), 16));
    assert!(height.black < Some(0.0) && height.white > Some(0.0), "{height:?}");
    assert_eq!((report.carried.as_slice(), report.left.as_slice()), (&[][..], &[][..]), "it is grey clay");
    let proof = report.proof.expect("it was measured");
    let angles = proof.angles.expect("points were found");
    assert_eq!(proof.histogram.iter().sum::<usize>(), angles.count);
    assert!(angles.mean < angles.p95 && angles.p95 < angles.max);
    assert!(angles.mean * 4.0 < proof.without_map.expect("points were found").mean);
    assert_eq!((proof.missed_texels, proof.lost, proof.views.len()), (0.0, 0.0, 8));
    assert!(proof.rms < proof.hausdorff && proof.uv_use > 0.8);
    assert!(proof.material.color.is_none() && proof.full_views.is_empty(), "the scan has no material");
    assert_eq!(proof.unseen, ["colour and material, of which the scan says nothing", "heights"]);
    assert!(proof.parts.is_empty() && normal.material.is_none(), "there is one material");
    let [level] = proof.levels.as_slice() else { panic!("there is one level") };
    assert_eq!((level.triangles, level.hausdorff, level.views.len()), (528, proof.hausdorff, 8));
    assert_eq!(proof.floor_8_bit, Some([0.17, 0.38]));
    assert_eq!(
        proof.bytes_out as usize,
        ["out.glb", "out.height.png"].map(|f| place.read(f).len()).iter().sum::<usize>()
    );
    assert_eq!(
        report.required,
        [Met { figure: "mean-angle".into(), most: 9.0, level: Some(0), value: Some(angles.mean), met: true }]
    );
    assert!(report.trials.is_empty() && report.warnings.is_empty());
    assert!(report.stages.iter().all(|stage| stage.milliseconds >= 0.0));
}

#[test]
fn of_a_scan_alone_without_proof() {
    let place = Place::with("scan.obj", SCAN.obj());
    let line = "bake scan.obj -o out.glb --triangles 800 --size 64 --ray-distance 0.1 --dilation 2 --no-verify --json";
    let report: BakeReport = serde_json::from_value(place.json(line)).expect("the document has this form");
    let simplified = report.origin.simplified.expect("it was simplified");
    assert_eq!(simplified.method, "edge-collapse");
    assert!(simplified.error > 0.0 && simplified.error < 0.1, "{}", simplified.error);
    assert!(report.origin.islands.expect("it was unwrapped") > 1);
    let parameters = &report.parameters;
    assert_eq!((&parameters.dilation, &parameters.ray_distance), (&AutoOr::Given(2.0), &AutoOr::Given(0.1)));
    assert_eq!((parameters.triangles, parameters.size), (Some(800), Some(64)));
    assert!(report.proof.is_none() && report.required.is_empty());
    assert_eq!(report.files, ["out.glb"]);
}
