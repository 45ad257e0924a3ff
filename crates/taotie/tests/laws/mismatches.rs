//! The proof names a change of the whole asset: other axes, another unit, a mirror, reversed winding. It names none
//! if only parts or detail are missing.

use std::fmt::Write;
use taotie::asset::{Proof, Scan, VerifyOptions, measure, verify};
use taotie_engine::Progress;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Material, Scene};

/// The beginning of the warning.
const LOOKS: &str = "the asset looks ";

/// A kind of teapot, which no rotation and no reflection maps to itself: a ball with a spout, a handle and a foot.
fn pot([columns, rows]: [usize; 2]) -> MeshData {
    let mut all = MeshData::default();
    let parts: [([f32; 3], [f32; 3]); 4] = [
        ([0.0, 1.0, 0.0], [0.8, 0.9, 0.85]),
        ([1.0, 1.2, 0.1], [0.5, 0.15, 0.12]),
        ([-0.9, 1.1, 0.0], [0.2, 0.5, 0.1]),
        ([0.0, 0.15, -0.3], [0.5, 0.15, 0.6]),
    ];
    for ([x, y, z], [a, b, c]) in parts {
        let first = all.positions.len() as u32;
        let part = Mesh::sphere(1.0, columns, rows);
        let place = |p: &Vec3| Vec3::new(x + a * p.x, y + b * p.y, z + c * p.z);
        all.positions.extend(part.positions().iter().map(place));
        all.triangles.extend(part.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    all
}

fn scan() -> Scan {
    Scan::from_mesh(Mesh::new(pot([64, 32])).unwrap(), Progress::SILENT).unwrap()
}

fn changed(data: MeshData, change: impl Fn(Vec3) -> Vec3) -> MeshData {
    MeshData { positions: data.positions.into_iter().map(change).collect(), ..data }
}

fn reversed(data: MeshData) -> MeshData {
    MeshData { triangles: data.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect(), ..data }
}

fn proof(asset: &MeshData) -> Proof {
    let mut text = String::new();
    for p in &asset.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in asset.triangles.iter().map(|t| t.map(|v| v + 1)) {
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pot.obj");
    std::fs::write(&path, text).unwrap();
    let options = VerifyOptions { points: 500, map: 16, view: 16, ..VerifyOptions::default() };
    verify(&path, scan(), &options, Progress::SILENT).unwrap()
}

/// Returns the description of the asset in the proof's warning.
fn said(asset: &MeshData) -> Option<String> {
    let proof = proof(asset);
    let mut found = proof.warnings.iter().map(|(what, _)| what).filter(|what| what.starts_with(LOOKS));
    let said = found.next().map(|what| what.trim_start_matches(LOOKS).to_owned());
    assert_eq!(found.next(), None, "it is reported once");
    said
}

#[test]
fn axes_units_mirrors_and_winding_are_named() {
    let pot = || pot([32, 16]);
    let said = |change: fn(Vec3) -> Vec3| said(&changed(pot(), change)).expect("a warning names it");
    let turned = said(|p| Vec3::new(p.x, -p.z, p.y));
    let start = "turned by 90° about x (Z up instead of Y up): without that, asset and scan are 0.";
    assert!(
        turned.starts_with(start) && turned.contains("of the diagonal apart on average instead of "),
        "{turned}"
    );
    assert!(said(|p| Vec3::new(-p.x, p.y, p.z)).starts_with("mirrored in x: "));
    assert!(said(|p| p * 1000.0).starts_with("1000 times larger (mm instead of m): "));
    assert!(said(|p| p * 0.001).starts_with("1000 times smaller (m instead of mm): "));
    assert!(said(|p| p * 2.54).starts_with("2.54 times larger (cm instead of in): "));
    let both = said(|p| Vec3::new(p.x, -p.z, p.y) * 100.0);
    let start = "turned by 90° about x (Z up instead of Y up) and 100 times larger (cm instead of m): ";
    assert!(both.starts_with(start) && both.ends_with(" diagonals"), "{both}");
    assert!(
        said(|p| p + Vec3::new(0.0, 0.4, 0.0)).starts_with("moved by (0.00"),
        "up to the triangles of the asset"
    );
    let inside_out = self::said(&reversed(pot())).expect("a warning names it");
    assert!(inside_out.starts_with("inside out: 99."), "{inside_out}");
}

#[test]
fn sound_and_partly_missing_assets_are_not_changed_as_a_whole() {
    let pot = || pot([32, 16]);
    let without = |is: fn(Vec3) -> bool| {
        let data = pot();
        let keep = |t: &[u32; 3]| !t.iter().all(|v| is(data.positions[*v as usize]));
        MeshData { triangles: data.triangles.iter().copied().filter(keep).collect(), ..data.clone() }
    };
    assert_eq!(said(&pot()), None);
    assert_eq!(said(&self::pot([10, 5])), None, "coarse");
    assert_eq!(said(&without(|p| p.x > 0.8)), None, "the spout is missing");
    assert_eq!(said(&without(|p| p.x > 0.0)), None, "half of it is missing");
    assert_eq!(said(&without(|p| p.y > 0.3)), None, "only the foot exists");
    assert_eq!(said(&changed(pot(), |p| p * 1.02)), None, "a little too large");
    let partly = {
        let (data, other) = (pot(), reversed(pot()));
        let is_left = |t: &[u32; 3]| data.positions[t[0] as usize].x < 0.0;
        let pairs = data.triangles.iter().zip(&other.triangles);
        MeshData {
            triangles: pairs.map(|(t, turned)| if is_left(t) { *turned } else { *t }).collect(),
            ..data.clone()
        }
    };
    assert_eq!(said(&partly), None, "only some triangles are reversed");
}

#[test]
fn a_model_that_is_refused_is_told_why() {
    let far = changed(pot([32, 16]), |p| p * 1000.0);
    let model = Scene::of_mesh(Mesh::new(far).unwrap(), Material::default()).unwrap();
    let error =
        measure(&model, &scan(), &VerifyOptions::default(), Progress::SILENT).unwrap_err().to_string();
    assert!(error.contains("the meshes do not overlap"), "{error}");
    assert!(error.contains("; the asset looks 1000 times larger (mm instead of m): "), "{error}");
}
