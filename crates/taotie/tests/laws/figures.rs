//! Figures of a proof that say where an asset differs from its scan, and on how much of its surface.

use std::fmt::Write;
use taotie::Progress;
use taotie::asset::{Proof, Requirement, Scan, VerifyOptions, verify};
use taotie::math::Vec3;
use taotie::mesh::{Mesh, MeshData};

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

/// The same plate without waves, as OBJ: a UV island and a material for each half, and a crumb beside it on an island of its
/// own.
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
    let options = VerifyOptions { points: 4_000, map: 16, view: 16, ..VerifyOptions::default() };
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
        assert!(worst.color.is_none(), "the scan states no colours");
    }
    assert_eq!(parts.material_names[materials.angle.as_ref().unwrap().number], "left");
    // Half of the surface is beyond a small limit, none of it beyond a large one.
    let beyond = finest.beyond.angle.as_ref().unwrap();
    assert!((beyond.beyond(1.0).value - 0.5).abs() < 0.05, "{:?}", beyond.beyond(1.0));
    let within = |text: &str| proof.require(&Requirement::read(text).unwrap())[0].met;
    assert_eq!(
        ["within-1deg=99%", "within-1deg=40%", "within-80deg=95%", "within-0.1%=99%", "within-1%=99%"]
            .map(within),
        [false, true, true, false, true]
    );
    assert!(proof.detail_map.is_none() && proof.error_map.is_none(), "it has no textures");
}
