//! Figures of a proof that show where an asset differs from its scan, and on how much of its surface.

use std::fmt::Write;
use taotie::Limits;
use taotie::asset::{PartKind, Proof, Requirement, Scan, VerifyOptions, verify};
use taotie_engine::Progress;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::proof::PatchQuantity;

/// A unit plate of cells², with waves on its left half.
fn wavy(cells: usize) -> MeshData {
    let mut data = MeshData::default();
    for row in 0..=cells {
        for column in 0..=cells {
            let [x, z] = [column, row].map(|i| i as f32 / cells as f32);
            let height = if x < 0.5 { 0.004 * (libm::sinf(x * 75.4) * libm::sinf(z * 75.4)) } else { 0.0 };
            data.positions.push(Vec3::new(x, height, z));
        }
    }
    let vertex = |column: usize, row: usize| (row * (cells + 1) + column) as u32;
    for row in 0..cells {
        for column in 0..cells {
            let [a, b] = [vertex(column, row), vertex(column + 1, row)];
            let [c, d] = [vertex(column + 1, row + 1), vertex(column, row + 1)];
            data.triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    data
}

/// The same plate without waves, as OBJ: a UV island and a material for each half, and a crumb next to it on a
/// separate island.
fn flat() -> String {
    let mut text = "mtllib low.mtl\nvn 0 1 0\n".to_owned();
    let mut vertices = 0;
    let mut quad = |text: &mut String, [left, right]: [f64; 2], [near, far]: [f64; 2], shift: f64| {
        for [x, z] in [[left, near], [left, far], [right, far], [right, near]] {
            let _ = write!(text, "v {x} 0 {z}\nvt {} {z}\n", x * 0.4 + shift);
        }
        let [a, b, c, d] = [1, 2, 3, 4].map(|i| vertices + i).map(|i| format!("{i}/{i}/1"));
        let _ = writeln!(text, "f {a} {b} {c} {d}");
        vertices += 4;
    };
    text += "usemtl left\n";
    quad(&mut text, [0.0, 0.5], [0.0, 1.0], 0.0);
    text += "usemtl right\n";
    quad(&mut text, [0.5, 1.0], [0.0, 1.0], 0.1);
    quad(&mut text, [1.001, 1.002], [0.0, 0.001], 0.3);
    text
}

fn proof() -> Proof {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("low.obj");
    std::fs::write(&path, flat()).unwrap();
    std::fs::write(folder.path().join("low.mtl"), "newmtl left\nKd 1 1 1\nnewmtl right\nKd 1 1 1\n").unwrap();
    let scan = Scan::from_mesh(Mesh::new(wavy(96)).unwrap(), Progress::SILENT).unwrap();
    let options =
        VerifyOptions { points: 4_000, map: 16, view: 16, patch_view: 64, ..VerifyOptions::default() };
    verify(&path, scan, &options, Progress::SILENT).unwrap()
}

#[test]
fn the_worst_island_and_material_are_those_with_the_waves() {
    let proof = proof();
    let finest = proof.figures.finest().unwrap();
    let (parts, all) = (&finest.worst_parts, finest.overview.angles.unwrap().summary.mean);
    let islands = parts.islands.as_ref().expect("it has three islands");
    assert_eq!((islands.count, islands.skipped), (3, 1), "the crumb has too few samples");
    let materials = parts.materials.as_ref().expect("it has two materials");
    assert_eq!((materials.count, materials.skipped), (2, 0));
    for worst in [islands, materials] {
        let angle = worst.angle.as_ref().unwrap();
        assert!(angle.mean > 1.5 * all && angle.mean > 5.0, "{} {all}", angle.mean);
        assert!((angle.share - 0.5).abs() < 0.05 && angle.center[0] < 0.5, "{angle:?}");
        assert!(angle.interval[0] < angle.mean && angle.mean < angle.interval[1], "{angle:?}");
        let at = angle.worst;
        assert!(at.center[0] < 0.5 && (0.02..0.3).contains(&at.radius) && at.toward[1] != 0.0, "{at:?}");
        assert!(worst.color.is_none(), "the scan has no colours");
    }
    let flips: Vec<(PartKind, PatchQuantity)> =
        proof.part_flips.iter().map(|found| (found.part, found.of)).collect();
    assert_eq!(flips, [PartKind::Island, PartKind::Material].map(|part| (part, PatchQuantity::Angle)));
    assert!(proof.part_flips.iter().all(|found| found.flip > 0.01), "{:?}", proof.part_flips);
    assert_eq!(parts.material_names[materials.angle.as_ref().unwrap().number], "left");
    // Half of the surface is beyond a small limit, none of it beyond a large one.
    let beyond = finest.beyond.angle.as_ref().unwrap();
    assert!((beyond.beyond(1.0).value - 0.5).abs() < 0.05, "{:?}", beyond.beyond(1.0));
    let within = |text: &str| proof.evaluate(&Requirement::read(text).unwrap())[0].met;
    assert_eq!(
        ["within-1deg=99%", "within-1deg=40%", "within-80deg=95%", "within-0.1%=99%", "within-1%=99%"]
            .map(within),
        [false, true, true, false, true]
    );
    assert!(proof.detail_map.is_none() && proof.error_map.is_none(), "it has no textures");
}

/// A blade of this width with two sharp edges along x: an OBJ of quadrilaterals.
fn blade(width: f64, cells: usize) -> String {
    let mut text = String::new();
    for i in 0..=cells {
        let x = i as f64 / cells as f64;
        let _ = write!(text, "v {x} {width} 0\nv {x} 0 0.02\nv {x} {} 0\nv {x} 0 -0.02\n", -width);
    }
    for [at, side] in (0..cells).flat_map(|i| [0, 1, 2, 3].map(|side| [4 * i, side])) {
        let [a, b] = [side, (side + 1) % 4].map(|corner| at + corner + 1);
        let _ = writeln!(text, "f {a} {b} {} {}", b + 4, a + 4);
    }
    text
}

#[test]
fn the_edge_of_a_blade_is_missed_only_where_nothing_is_near_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let scan = path("scan.obj", blade(0.1, 64));
    let scan = Scan::read(&scan, &Limits::default(), Progress::SILENT).unwrap();
    let missed = |width: f64| {
        let asset = path("asset.obj", blade(width, 16));
        let options = VerifyOptions { points: 4_000, map: 16, view: 16, ..VerifyOptions::default() };
        let proof = verify(&asset, &scan, &options, Progress::SILENT).unwrap();
        let coverage = proof.figures.finest().unwrap().coverage;
        (coverage.missed_of_scan, coverage.missed_of_asset)
    };
    // The diagonal is 1.02: within 0.5 % of it there is a surface, whichever side of the blade is closest.
    assert_eq!(missed(0.097), (0.0, 0.0));
    assert_eq!(missed(0.103), (0.0, 0.0));
    let (of_scan, of_asset) = missed(0.08);
    // All but the last 0.5 % of a fifth of the width: 0.015 of 0.1.
    assert!((0.10..0.20).contains(&of_scan) && of_asset == 0.0, "{of_scan} {of_asset}");
}
