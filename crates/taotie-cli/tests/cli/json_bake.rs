//! The document that `taotie bake --json` prints, and writes as `OUT.report.json`.
//!
//! Adding or removing a field changes the schema: it needs a new number, here and in the command.
#![allow(dead_code)]

use super::balls::{LOW, SCAN};
use super::json::Spread;
use super::place::Place;
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BakeReport {
    schema: u32,
    kind: String,
    version: String,
    certificate: Option<Certificate>,
    high: String,
    high_sha256: String,
    #[serde(default)]
    high_others: Vec<HashedFile>,
    high_triangles: usize,
    low: Option<String>,
    origin: Origin,
    triangles: Vec<usize>,
    size: [u32; 2],
    parameters: Option<Parameters>,
    files: Vec<String>,
    maps: Vec<Map>,
    carried: Vec<String>,
    left: Vec<Left>,
    proof: Option<Proof>,
    bake: Option<BakeFigures>,
    trials: Vec<Trial>,
    stages: Vec<Stage>,
    warnings: Vec<Counted>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Certificate {
    verdict: String,
    required: Vec<Met>,
    figures: Vec<KeyFigure>,
    not_compared: Vec<String>,
    scan: Vec<HashedFile>,
    scan_models: usize,
    scan_triangles: usize,
    asset: Vec<HashedFile>,
    triangles: Vec<usize>,
    maps: Vec<HashedMap>,
    program: String,
    options: ProofOptions,
    date: Option<String>,
    operator: Option<String>,
    command: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct KeyFigure {
    figure: String,
    value: f64,
    interval: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HashedFile {
    name: String,
    bytes: u64,
    sha256: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HashedMap {
    uses: String,
    file: Option<String>,
    bytes: Option<u64>,
    sha256: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProofOptions {
    scan: ScanOptions,
    points: usize,
    view: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScanOptions {
    crease_angle_deg: Option<f64>,
    green: Option<String>,
    unit: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Origin {
    is_scan: bool,
    simplified: Option<Simplified>,
    islands: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Simplified {
    method: String,
    error: f64,
    remesh: Option<Remesh>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Remesh {
    scan_shells: usize,
    open_borders: usize,
    shells: usize,
    triangles: usize,
    volume: f64,
    closing: f64,
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Parameters {
    triangles: Option<u32>,
    goal: Option<String>,
    bytes: Option<u64>,
    lods: Vec<Value>,
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
    image_formats: Vec<String>,
    meshopt: bool,
    codecs: String,
    position_bits: Option<u8>,
    normal_bits: Option<u8>,
    green: String,
    crease_angle_deg: AutoOr,
    scan_green: String,
    unit: Option<String>,
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
    error: Option<MapError>,
}

#[derive(Deserialize, Debug, PartialEq)]
struct MapError {
    unit: String,
    mean: f64,
    max: f64,
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
    unit: Option<String>,
    metres_per_unit: Option<f64>,
    diagonal: f64,
    unseen: Vec<String>,
    parts: Vec<Part>,
    fit: Option<Fit>,
    bytes_in: u64,
    bytes_out: u64,
    gpu_bytes: Option<u64>,
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
struct BakeFigures {
    missed_texels: f64,
    missed_samples: f64,
    lost_samples: f64,
    uv_use: f64,
    floor_8_bit: Option<[f64; 2]>,
    unproved_maps: Vec<String>,
}

/// A figure estimated from samples.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Estimate {
    summary: Spread,
    mean_interval: [f64; 2],
    p95_interval: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Overview {
    angles: Option<Estimate>,
    color: Option<Estimate>,
    material: Option<Estimate>,
    pixels: usize,
    across: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Patch {
    mean: f64,
    interval: [f64; 2],
    center: [f64; 3],
    radius: f64,
    toward: [f64; 3],
    is_of_scan: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Patches {
    angle: Option<Patch>,
    color: Option<Patch>,
    material: Option<Patch>,
    detail: Option<Patch>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Silhouette {
    mean_pixels: f64,
    max_pixels: f64,
    max_length: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Coverage {
    missed_of_scan: f64,
    missed_of_asset: f64,
    missed_interval: [f64; 2],
    missed_at: Option<[f64; 3]>,
    completeness: f64,
    hidden_of_scan: f64,
    is_interior: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bounds {
    lower: f64,
    upper: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Resolution {
    texel: f64,
    coarser: f64,
    share: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Exceedance {
    limits: Vec<f64>,
    shares: Vec<f64>,
    samples: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Beyond {
    angle: Option<Exceedance>,
    color: Option<Exceedance>,
    distance: Option<Exceedance>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    islands: Option<Value>,
    materials: Option<Value>,
    material_names: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Level {
    triangles: usize,
    overview: Overview,
    patches: Patches,
    worst_parts: Parts,
    beyond: Beyond,
    silhouette: Silhouette,
    coverage: Coverage,
    hausdorff: Bounds,
    hausdorff_of_diagonal: Bounds,
    rms: f64,
    rms_of_diagonal: f64,
    resolution: Option<Resolution>,
    surface_angles: Option<Spread>,
    histogram: Vec<usize>,
    without_map: Option<Spread>,
    surface_missed: f64,
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
    is_length: bool,
    level: Option<usize>,
    value: Option<f64>,
    interval: Option<[f64; 2]>,
    met: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Trial {
    is_scan: bool,
    is_chosen: bool,
    triangles: usize,
    size: u32,
    has_normal_map: bool,
    normals: Option<String>,
    bits: Bits,
    mean_angle: f64,
    p95_angle: f64,
    mean_color: Option<f64>,
    p95_color: Option<f64>,
    angle_ratio: f64,
    color_ratio: Option<f64>,
    ceiling_ratio: f64,
    is_near: bool,
    bytes: u64,
    gpu_bytes: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bits {
    positions: u8,
    uvs: u8,
    normals: u8,
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
    assert_eq!((report.schema, report.version.as_str()), (11, env!("CARGO_PKG_VERSION")));
    assert_eq!((report.high.as_str(), report.low.as_deref()), ("scan.obj", Some("low.obj")));
    assert_eq!((report.high_triangles, report.triangles, report.size), (9024, vec![528], [64; 2]));
    assert_eq!(report.high_sha256.len(), 64);
    let auto = || AutoOr::Auto("auto".into());
    let parameters = Parameters {
        triangles: None,
        goal: None,
        bytes: None,
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
        image_formats: vec![],
        meshopt: false,
        codecs: "portable".into(),
        position_bits: None,
        normal_bits: None,
        green: "up".into(),
        crease_angle_deg: auto(),
        scan_green: "auto".into(),
        unit: None,
    };
    assert_eq!(report.parameters, Some(parameters));
    assert_eq!(report.files, ["out.glb", "out.height.png", "out.report.html", "out.report.json"]);
    let [normal, height] = report.maps.as_slice() else { panic!("two maps were asked for") };
    assert_eq!((normal.map.as_str(), &normal.file), ("normal", &None));
    assert_eq!((height.file.as_deref(), height.bits), (Some("out.height.png"), 16));
    assert!(height.black < Some(0.0) && height.white > Some(0.0), "{height:?}");
    assert_eq!((report.carried.as_slice(), report.left.as_slice()), (&[][..], &[][..]), "it is grey clay");
    let proof = report.proof.expect("it was measured");
    assert_eq!((proof.unit.as_deref(), proof.metres_per_unit), (None, None), "OBJ states no unit");
    let bake = report.bake.expect("it was baked");
    let [level] = proof.levels.as_slice() else { panic!("there is one level") };
    let angles = level.surface_angles.as_ref().expect("points were found");
    assert_eq!(level.histogram.iter().sum::<usize>(), angles.count);
    assert!(angles.mean < angles.p95 && angles.p95 < angles.max);
    assert!(angles.mean * 4.0 < level.without_map.as_ref().expect("points were found").mean);
    let overview = level.overview.angles.as_ref().expect("pixels were found");
    let (seen, [low, high]) = (&overview.summary, overview.mean_interval);
    assert!(low < seen.mean && seen.mean < high && level.overview.pixels == seen.count);
    assert_eq!(level.overview.across, 512.0);
    assert!(overview.p95_interval[0] <= seen.p95 && seen.p95 <= overview.p95_interval[1]);
    let patch = level.patches.angle.as_ref().expect("there is a worst patch");
    assert!(patch.interval[0] <= patch.mean && patch.mean <= patch.interval[1] && patch.radius > 0.0);
    let lost = level.patches.detail.as_ref().expect("there is relief");
    assert!((0.0..1.0).contains(&lost.mean), "{}", lost.mean);
    let Beyond { angle, color, distance } = &level.beyond;
    let [angle, distance] = [angle, distance].map(|curve| curve.as_ref().expect("samples were taken"));
    for Exceedance { limits, shares, samples } in [angle, distance] {
        assert!(limits.is_sorted() && shares.is_sorted_by(|a, b| a >= b) && shares.last() == Some(&0.0));
        assert!(limits.len() == shares.len() && limits.len() < 140 && *samples > 1_000);
    }
    assert!(color.is_none() && level.worst_parts.material_names.is_empty());
    assert!(
        level.worst_parts.islands.is_none() && level.worst_parts.materials.is_none(),
        "there is one of each"
    );
    assert_eq!((bake.missed_texels, bake.missed_samples, bake.lost_samples), (0.0, 0.0, 0.0));
    assert_eq!((level.surface_missed, level.views.len(), level.triangles), (0.0, 8, 528));
    assert!(
        level.hausdorff.lower <= level.hausdorff.upper
            && level.rms < level.hausdorff.lower
            && bake.uv_use > 0.8
    );
    assert!(level.hausdorff_of_diagonal.upper < level.hausdorff.upper && level.rms_of_diagonal < level.rms);
    let Coverage { missed_of_scan, missed_of_asset, completeness, hidden_of_scan, is_interior, .. } =
        level.coverage;
    assert_eq!((missed_of_scan, missed_of_asset, hidden_of_scan, is_interior), (0.0, 0.0, 0.0, false));
    assert!(completeness > 0.5 && level.silhouette.mean_pixels <= level.silhouette.max_pixels);
    assert!(level.resolution.as_ref().is_some_and(|resolution| resolution.texel > 0.0));
    assert!(level.material.color.is_none() && level.full_views.is_empty(), "the scan has no material");
    assert!(level.overview.color.is_none() && level.patches.color.is_none());
    assert!(level.overview.material.is_none() && level.patches.material.is_none());
    assert_eq!(proof.unseen, ["colour and material, which the scan does not specify"]);
    assert_eq!((bake.unproved_maps, bake.floor_8_bit), (Vec::<String>::new(), Some([0.17, 0.38])));
    let error = height.error.as_ref().expect("it is measured");
    assert!(
        error.unit == "model units" && error.mean < 0.0015 && error.max < 0.01,
        "{} {}",
        error.mean,
        error.max
    );
    assert!(proof.parts.is_empty() && normal.material.is_none(), "there is one material");
    assert_eq!(proof.bytes_out as usize, place.read("out.glb").len());
    let certificate = report.certificate.expect("it was measured");
    let [met] = certificate.required.as_slice() else { panic!("one figure was required") };
    assert_eq!(
        (certificate.verdict.as_str(), certificate.scan[0].sha256.as_str()),
        ("met", report.high_sha256.as_str())
    );
    assert_eq!((met.figure.as_str(), met.most, met.level, met.met), ("mean-angle", 9.0, Some(0), true));
    assert_eq!((met.value, met.interval), (Some(seen.mean), Some([low, high])));
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
    let parameters = report.parameters.as_ref().expect("it was baked");
    assert_eq!((&parameters.dilation, &parameters.ray_distance), (&AutoOr::Given(2.0), &AutoOr::Given(0.1)));
    assert_eq!((parameters.triangles, parameters.size), (Some(800), Some(64)));
    assert!(report.proof.is_none() && report.certificate.is_none());
    assert_eq!(report.files, ["out.glb"]);
}
