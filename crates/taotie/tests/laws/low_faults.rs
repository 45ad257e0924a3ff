//! Faults of a given low-poly mesh that an artist would see: each is noted, with its place and share, and a sound
//! twin is not.

use std::sync::Arc;
use taotie::asset::{BakeOptions, Baker, MeshSource, Scan};
use taotie_engine::Progress;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};

/// Returns the warnings of a bake of `scan` onto `low`.
fn warned(scan: Mesh, low: Mesh) -> String {
    let low = Some(MeshSource::Mesh(Arc::new(low)));
    let baker = Baker::new(BakeOptions { low, size: 64, ..BakeOptions::default() });
    let asset = baker.bake(Scan::from_mesh(scan, Progress::SILENT).unwrap(), Progress::SILENT).unwrap();
    asset.warnings().iter().map(|(what, count)| format!("{count} {what}\n")).collect()
}

/// A box of side 2 of which each face has its own normals, unwrapped as a cross: its walls in a row, with uvs
/// continuous over their edges, or each with a gap around it.
fn walls(gap: f32) -> Mesh {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut add = |corners: [Vec3; 4], normal: Vec3, [u, v]: [f32; 2]| {
        let first = data.positions.len() as u32;
        data.positions.extend(corners);
        data.normals.extend([normal; 4]);
        let side = 0.25 - gap;
        let square = [(0.0, side), (side, side), (side, 0.0), (0.0, 0.0)];
        data.uvs[0].extend(square.map(|(x, y)| Vec2::new(u + x, v + y)));
        data.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| i + first)));
    };
    for i in 0..4 {
        let ((x, z), (next_x, next_z)) = (corners[i], corners[(i + 1) % 4]);
        let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let normal = p((x + next_x) / 2.0, 0.0, (z + next_z) / 2.0);
        let quad = [p(x, -1.0, z), p(next_x, -1.0, next_z), p(next_x, 1.0, next_z), p(x, 1.0, z)];
        let outward = (quad[1] - quad[0]).cross(quad[2] - quad[0]).dot(normal) > 0.0;
        let quad = if outward { quad } else { [quad[1], quad[0], quad[3], quad[2]] };
        add(quad, normal, [0.25 * if outward { i as f32 } else { 3.0 - i as f32 }, 0.25]);
    }
    Mesh::new(data).unwrap()
}

#[test]
fn hard_edges_inside_uv_islands_are_noted() {
    let (whole, cut) = (walls(0.0), walls(0.02));
    let text = warned(whole.clone(), whole.clone());
    // Three of four upright edges of length 2; each wall has a diagonal too.
    assert!(
        text.contains("hard edges inside UV islands of the low-poly mesh: 31.1 % of the length"),
        "{text}"
    );
    assert!(text.contains("around (") && text.contains("split the uvs"), "{text}");
    assert!(!warned(whole, cut).contains("hard edges"));
}

#[test]
fn reversed_triangles_of_a_low_poly_mesh_are_noted_with_their_place() {
    let low = Mesh::sphere(1.0, 40, 20);
    let middle = |t: &[u32; 3]| t.iter().fold(Vec3::splat(0.0), |sum, v| sum + low.positions()[*v as usize]);
    let near = |t: &[u32; 3]| middle(t).normalize().x > 0.97;
    let mut data = low.clone().into_data();
    data.triangles.iter_mut().filter(|t| near(t)).for_each(|t| t.swap(1, 2));
    let scan = Mesh::sphere(1.0, 80, 40);
    let sound = warned(scan.clone(), low.clone());
    assert!(!sound.contains("wound") && !sound.contains("face away"), "{sound}");
    let text = warned(scan, Mesh::new(data).unwrap());
    assert!(text.contains("triangles of the low-poly mesh wound opposite to their neighbours: 1."));
    assert!(text.contains("that face away from their own normals: 1."), "{text}");
    assert!(text.contains("% of its surface, around (0.9") || text.contains("around (1.0"), "{text}");
}

#[test]
fn a_part_of_the_scan_that_the_low_poly_mesh_lacks_is_noted() {
    let ball = |z: f32, radius: f64| {
        let data = Mesh::sphere(radius, 40, 20).into_data();
        let positions = data.positions.iter().map(|p| *p + Vec3::new(0.0, 0.0, z)).collect();
        MeshData { positions, ..data }
    };
    let mut both = ball(0.0, 1.0);
    let small = ball(1.5, 0.2);
    let first = both.positions.len() as u32;
    both.positions.extend(small.positions);
    both.normals.extend(small.normals);
    both.uvs[0].extend(&small.uvs[0]);
    both.triangles.extend(small.triangles.iter().map(|t| t.map(|v| v + first)));
    let both = Mesh::new(both).unwrap();
    let low = Mesh::sphere(1.0, 24, 12);
    let text = warned(both.clone(), low.clone());
    assert!(
        text.contains("the low-poly mesh lacks parts of the scan") && text.contains("of 3.8 % "),
        "{text}"
    );
    assert!(text.contains(", 1.") && text.contains("remove them from the scan"), "{text}");
    assert!(!warned(Mesh::sphere(1.0, 40, 20), low).contains("lacks parts"));
    assert!(!warned(both.clone(), both).contains("lacks parts"));
}
