//! What must hold of the low mesh, its atlas and its maps.

use super::*;
use std::collections::HashMap;
use taotie::math::Vec3;

/// The index of the first vertex at each vertex's place.
fn welded(mesh: &Mesh) -> Vec<usize> {
    let key = |p: &Vec3| p.to_array().map(f32::to_bits);
    let mut first = HashMap::new();
    mesh.positions().iter().enumerate().map(|(i, p)| *first.entry(key(p)).or_insert(i)).collect()
}

#[test]
fn has_exactly_251_vertices_and_all_are_used() {
    let mesh = low_mesh();
    assert_eq!(mesh.positions().len(), 251);
    let used: std::collections::BTreeSet<u32> = mesh.triangles().iter().flatten().copied().collect();
    assert_eq!(used.len(), 251);
    assert!(mesh.tangents().is_empty());
}

#[test]
fn every_edge_is_shared_by_two_triangles_that_run_it_opposite_ways() {
    let mesh = low_mesh();
    let welded = welded(&mesh);
    let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
    for triangle in mesh.triangles() {
        let t = triangle.map(|i| welded[i as usize]);
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    for ((a, b), count) in &edges {
        let (p, q) = (mesh.positions()[*a], mesh.positions()[*b]);
        assert_eq!(*count, 1, "edge {p:?} {q:?} is run twice the same way");
        assert!(edges.contains_key(&(*b, *a)), "edge {p:?} {q:?} is open");
    }
}

/// The component of each vertex: the least welded index that triangles connect it to.
fn components(mesh: &Mesh) -> Vec<usize> {
    let welded = welded(mesh);
    let mut component = welded.clone();
    loop {
        let mut changed = false;
        for triangle in mesh.triangles() {
            let t = triangle.map(|i| welded[i as usize]);
            let least = t.iter().map(|i| component[*i]).min().unwrap();
            for i in t {
                changed |= component[i] != least;
                component[i] = least;
            }
        }
        if !changed {
            return welded.iter().map(|i| component[*i]).collect();
        }
    }
}

#[test]
fn every_part_encloses_a_positive_volume() {
    let mesh = low_mesh();
    let components = components(&mesh);
    let mut volumes: HashMap<usize, f64> = HashMap::new();
    for (i, triangle) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(i).map(Vec3::to_f64);
        *volumes.entry(components[triangle[0] as usize]).or_default() += a.dot(b.cross(c)) / 6.0;
    }
    assert_eq!(volumes.len(), 7, "vessel, three legs, two posts, handle");
    assert!(volumes.values().all(|v| *v > 1e-7), "{volumes:?}");
}

#[test]
fn has_no_sliver_and_stands_on_the_ground() {
    let mesh = low_mesh();
    assert_eq!(mesh.degenerate_triangles(), 0);
    for i in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(i).map(Vec3::to_f64);
        assert!((b - a).cross(c - a).length() > 1e-6, "triangle {i} is a sliver: {a:?} {b:?} {c:?}");
    }
    let lowest = mesh.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    assert_eq!(lowest, 0.0);
}

#[test]
fn normals_are_unit_and_on_the_side_of_their_faces() {
    let mesh = low_mesh();
    for n in mesh.normals() {
        assert!((n.length() - 1.0).abs() < 1e-6);
    }
}
