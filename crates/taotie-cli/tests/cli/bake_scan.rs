//! Options of `taotie bake` for reading a scan.

use super::bake::number;
use super::balls::SCAN;
use super::models::square_json;
use super::place::Place;
use serde_json::Value;
use std::fmt::Write;
use taotie_engine::Warnings;
use taotie_engine::bake::Faults;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene};
use taotie_io::{encode_scene, load_model};

/// Returns a hexagonal prism as STL, whose facets are intended.
fn prism() -> String {
    let corner = |i: usize, z: f64| {
        let [x, y] =
            [[1.0, 0.0], [0.5, 0.866], [-0.5, 0.866], [-1.0, 0.0], [-0.5, -0.866], [0.5, -0.866]][i % 6];
        format!("vertex {x} {y} {z}\n")
    };
    let facet = |corners: [String; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat())
    };
    let ends = ["vertex 0 0 1\n".to_owned(), "vertex 0 0 0\n".to_owned()];
    let mut text = "solid\n".to_owned();
    for i in 0..6 {
        let j = i + 1;
        text += &facet([corner(i, 0.0), corner(j, 0.0), corner(j, 1.0)]);
        text += &facet([corner(i, 0.0), corner(j, 1.0), corner(i, 1.0)]);
        text += &facet([ends[0].clone(), corner(i, 1.0), corner(j, 1.0)]);
        text += &facet([ends[1].clone(), corner(j, 0.0), corner(i, 0.0)]);
    }
    text + "endsolid\n"
}

#[test]
fn hard_edges_of_a_modelled_shape_are_kept_unless_asked_otherwise() {
    let place = Place::with("nut.stl", prism());
    let said = |options: &str| {
        let line = format!("bake nut.stl -o out.glb --size 64 --no-verify {options}");
        let assert = place.taotie(&line).assert().success();
        String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
    };
    let kept = "scan without smooth normals: smoothed below 26°, 18 hard edges kept (";
    assert!(said("").contains(kept), "{}", said(""));
    assert!(said("--crease-angle 70").contains("smoothed below 70°, 12 hard edges kept ("));
    for options in ["--crease-angle 180", "--flat"] {
        assert!(!said(options).contains("hard edges"), "{options}");
    }
    assert!(said("--scan-green down").contains("the direction of green has no effect"));
}

#[test]
fn options_of_the_scan_that_cannot_be_are_refused() {
    let place = Place::with("nut.stl", prism());
    let cases = [
        ("--crease-angle 200", "expected an angle between 0 and 180 degrees"),
        ("--crease-angle sharp", "expected an angle in degrees"),
        ("--crease-angle 30 --flat", "cannot be used with"),
        ("--scan-green left", "invalid value 'left'"),
        ("--noise smooth", "unknown handling of noise `smooth`: expected one of: keep, remove"),
    ];
    for (options, words) in cases {
        let assert = place.taotie(&format!("bake nut.stl -o out.glb {options}")).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words), "{options}: {said}");
    }
    assert_eq!(place.files(), ["nut.stl"]);
}

/// Returns an OBJ file whose vertices are moved by noise of a known standard deviation, away from or to the origin.
fn with_noise(obj: &str, sigma: f64) -> String {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut moved = |line: &str| {
        let Some(place) = line.strip_prefix("v ") else { return format!("{line}\n") };
        let gauss: f64 = (0..12).map(|_| random() - 0.5).sum();
        let numbers = place.split(' ').map(|number| number.parse::<f64>().unwrap() * (1.0 + sigma * gauss));
        format!("v {}\n", numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(" "))
    };
    obj.lines().map(&mut moved).collect()
}

/// Noise is measured if requested, its removal brings the asset nearer to the shape without it, and the proof compares
/// with the scan as given.
#[test]
fn noise_is_measured_and_removed_only_if_asked() {
    const SIGMA: f64 = 0.004;
    let place = Place::with("clean.obj", SCAN.obj());
    place.write("scan.obj", with_noise(&SCAN.obj(), SIGMA));
    let bake = |name: &str, options: &str| {
        let line = format!("bake scan.obj -o {name}.glb --triangles 3000 --size 512 {options}");
        let assert = place.taotie(&line).assert().success();
        let report: Value = serde_json::from_slice(&place.read(&format!("{name}.report.json"))).unwrap();
        (String::from_utf8_lossy(&assert.get_output().stdout).into_owned(), report)
    };
    let (text, plain) = bake("plain", "");
    assert!(!text.contains("noise") && plain.get("noise").is_none(), "{text}");
    let (text, kept) = bake("kept", "--noise keep");
    assert!(text.contains("noise of the scan") && text.contains("; kept"), "{text}");
    assert!((number(&kept, "/noise/sigma") / SIGMA - 1.0).abs() < 0.2, "{}", kept["noise"]);
    assert_eq!(place.read("kept.glb"), place.read("plain.glb"));
    let (text, removed) = bake("removed", "--noise remove");
    assert!(text.contains("; removed: vertices moved by ") && text.contains(", p95 "), "{text}");
    let angle = number(&removed, "/noise/removed/mean_deg");
    assert!(angle > 1.0 && number(&removed, "/noise/removed/rms") > 0.5 * SIGMA, "{}", removed["noise"]);
    assert_eq!(removed["parameters"]["noise"], "remove");
    let page = |name: &str| String::from_utf8_lossy(&place.read(&format!("{name}.report.html"))).into_owned();
    assert!(page("removed").contains("removed noise") && !page("kept").contains("removed noise"));

    let mean = |asset: &str, scan: &str| {
        let assert = place.taotie(&format!("verify {asset}.glb --scan {scan}.obj --json")).assert().success();
        let report: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
        number(&report, "/proof/levels/0/overview/angles/summary/mean")
    };
    let of_report = number(&removed, "/proof/levels/0/overview/angles/summary/mean");
    assert_eq!(mean("removed", "scan"), of_report, "the proof is against the scan as given");
    assert!(of_report > 0.5 * angle, "{of_report} {angle}");
    let [kept, removed] = ["kept", "removed"].map(|asset| mean(asset, "clean"));
    assert!(removed < 0.75 * kept, "{removed} {kept}");
}

/// A packed glTF scan is not its file, which has the noise.
#[test]
fn a_search_packs_the_scan_without_its_noise() {
    let place = Place::with("scan.obj", with_noise(&SCAN.obj(), 0.004));
    let mesh = load_model(place.path("scan.obj")).unwrap().scene.meshes()[0].clone();
    let red = Material { base_color: [0.8, 0.1, 0.1, 1.0], ..Material::default() };
    let scene = Scene::of_mesh(mesh, red).unwrap();
    place.write("scan.glb", encode_scene(&scene, &["ball".into()], &mut Warnings::default()).unwrap());
    let line = "bake scan.glb -o out.glb --error 0.1 --noise remove --no-verify --json";
    let assert = place.taotie(line).assert().success();
    let report: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert!(number(&report, "/noise/removed/mean_deg") > 1.0, "{}", report["noise"]);
    let trials = report["trials"].as_array().unwrap();
    let packed = trials.iter().filter(|trial| trial["is_scan"] == true);
    let nearest = packed.map(|trial| number(trial, "/mean_angle")).fold(f64::INFINITY, f64::min);
    assert!(nearest < 0.1, "{nearest}");
}

#[test]
fn noise_that_cannot_be_measured_is_reported() {
    let place = Place::with("nut.stl", prism());
    let line = "bake nut.stl -o out.glb --size 64 --no-verify --noise remove";
    let assert = place.taotie(line).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("noise neither measured nor removed: the scan has too few vertices"), "{said}");
}

/// Returns two balls that overlap, a third inside, and one with a hole next to them, as OBJ of separate triangles.
fn soup() -> String {
    const MISSING: usize = 2080;
    let (mut text, mut count) = (String::new(), 0);
    for (radius, x) in [(1.0, 0.0), (0.8, 1.1), (0.5, 0.2), (0.6, -1.8)] {
        let ball = Mesh::sphere(radius, 64, 32);
        for t in 0..ball.triangles().len() {
            let corners = ball.corners(t).map(|p| p + Vec3::new(x, 0.0, 0.0));
            if x < 0.0 && t == MISSING {
                continue;
            }
            for p in corners {
                let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
            }
            let _ = writeln!(text, "f {} {} {}", count + 1, count + 2, count + 3);
            count += 3;
        }
    }
    text
}

/// Returns the faults of a model's triangles in world space.
fn faults(place: &Place, name: &str) -> Faults {
    let scene = taotie::load_model(place.path(name)).unwrap().scene;
    Faults::of(&Mesh::joined(scene.meshes()).unwrap())
}

#[test]
fn a_soup_becomes_a_watertight_mesh_close_to_its_visible_surface() {
    let place = Place::with("soup.obj", soup());
    let line = "bake soup.obj -o out.glb --remesh --triangles 800 --size 128 --json";
    let report = place.json(line);
    let Faults { open_edges, crowded_edges, duplicates, .. } = faults(&place, "out.glb");
    assert_eq!((open_edges, crowded_edges, duplicates), (0, 0, 0));
    let remesh = &report["origin"]["simplified"]["remesh"];
    assert_eq!((&remesh["scan_shells"], &remesh["shells"]), (&4.into(), &2.into()), "{remesh}");
    assert!(remesh["open_borders"].as_u64() > Some(0), "{remesh}");
    assert_eq!(report["parameters"]["remesh"], true);
    let said = report["warnings"].to_string();
    assert!(said.contains("remeshed: 4 separate parts and "), "{said}");
    assert!(!said.contains("that simplification left open"), "{said}");
    let line =
        "verify out.glb --scan soup.obj --require mean-angle=1,missed=0.1%,hausdorff=1%,completeness=99%";
    place.taotie(line).assert().success();
}

#[test]
fn remeshing_needs_a_scan_to_make_the_mesh_from() {
    let place = Place::with("soup.obj", soup());
    let cases = [
        ("bake soup.obj -o out.glb --remesh --low soup.obj", "cannot be used with"),
        ("bake soup.obj -o out.png --remesh", "--remesh: out.png holds only maps"),
    ];
    for (line, words) in cases {
        let assert = place.taotie(line).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words), "{line}: {said}");
    }
}

/// Returns a sphere of radius 1 as OBJ, moved along x.
fn sphere_at(x: f64) -> String {
    let ball = Mesh::sphere(1.0, 32, 16);
    let position = |p: &Vec3| format!("v {} {} {}\n", f64::from(p.x) + x, p.y, p.z);
    let corners = |t: &[u32; 3]| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    let positions: String = ball.positions().iter().map(position).collect();
    positions + &ball.triangles().iter().map(corners).collect::<String>()
}

#[test]
fn coordinates_far_from_the_origin_are_told_or_refused() {
    let place = Place::with("near.obj", sphere_at(0.0));
    place.write("away.obj", sphere_at(2000.0));
    place.write("far.obj", sphere_at(4_500_000.0));
    let bake =
        |name: &str| place.taotie(&format!("bake {name}.obj -o {name}.glb --triangles 200 --size 64 --json"));
    let said = |name: &str| {
        let output = bake(name).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = said("away");
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("too far from the origin") && text.contains("such as (2000, 0, 0)"), "{text}");
    assert!(!text.contains("interior") && !text.contains("cannot be seen"), "{text}");
    let (code, text) = said("far");
    assert_eq!(code, Some(2));
    assert!(text.contains("far.obj") && text.contains("such as (4500000, 0, 0)"), "{text}");
    assert!(!said("near").1.contains("origin"));
}

#[test]
fn a_quad_keeps_both_of_its_triangles() {
    let place = Place::with("a.gltf", square_json().to_string());
    for options in ["", "--preset web", "--require standard"] {
        let report = place.json(&format!("bake a.gltf -o b.glb --json {options}"));
        let covered = &report["proof"]["levels"][0]["coverage"];
        assert_eq!(covered["completeness"], 1.0, "{options}: {covered}");
        assert_eq!(place.json("inspect b.glb --json")["counts"]["triangles"], 2, "{options}");
    }
}
