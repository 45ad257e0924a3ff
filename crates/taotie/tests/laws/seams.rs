//! Simplified surfaces whose vertices were not welded: seams, patches and loose triangles with small differences
//! between the copies of a vertex give the same result as the welded surface.

use crate::distance::{Surface, deviation};
use crate::hostile::{bare, embossed_ball, unwelded};
use crate::random::Random;
use std::collections::HashMap;
use taotie_engine::Progress;
use taotie_engine::bake::{Simplified, SimplifyMethod, SimplifyOptions, simplify};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;

fn to(mesh: &Mesh, triangles: usize) -> Simplified {
    let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
    simplify(mesh, &options, Progress::SILENT).unwrap()
}

/// Returns the mesh at another size, with every vertex moved by up to `noise` of the size along each axis.
fn noisy(mesh: &Mesh, size: f64, noise: f64) -> Mesh {
    let mut random = Random(3);
    let moved =
        mesh.positions().iter().map(|p| ((p.to_f64() + random.vector() * (2.0 * noise)) * size).to_f32());
    bare(moved.collect(), mesh.triangles().to_vec())
}

/// Returns the mesh cut into patches along the planes of a grid, each patch with its own vertices.
fn patches(mesh: &Mesh, cells: f32) -> Mesh {
    let (mut numbers, mut positions) = (HashMap::new(), Vec::new());
    let triangle = |t: usize| {
        let patch = mesh.corners(t)[0].to_array().map(|v| (v * cells).floor() as i32);
        mesh.triangles()[t].map(|v| {
            *numbers.entry((patch, v)).or_insert_with(|| {
                positions.push(mesh.positions()[v as usize]);
                positions.len() as u32 - 1
            })
        })
    };
    let triangles = (0..mesh.triangles().len()).map(triangle).collect();
    bare(positions, triangles)
}

/// Returns the number of edges with only one triangle, vertices at equal positions counted as one.
fn open_edges(mesh: &Mesh) -> usize {
    let place = |v: u32| mesh.positions()[v as usize].to_array().map(|v| (v + 0.0).to_bits());
    let edges = mesh.triangles().iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    let edges: std::collections::HashSet<_> = edges.map(|(a, b)| (place(*a), place(*b))).collect();
    edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).count()
}

/// Panics if the simplified mesh does not have the requested number of triangles, is not closed, or is not near the
/// closed surface of a scan.
fn check(what: &str, scan: &Mesh, low: &Simplified, [mean, most]: [f64; 2]) {
    let step = scan.positions().len() / 3_000;
    let [found_mean, found_most] = deviation(scan, &low.mesh, step);
    let surface = Surface::new(scan);
    let middle =
        |t: usize| low.mesh.corners(t).into_iter().fold(Vec3::default(), |sum, p| sum + p) * (1.0 / 3.0);
    let middles = (0..low.mesh.triangles().len()).map(|t| surface.distance(middle(t)) / scan.diagonal());
    let farthest = middles.fold(0.0, f64::max);
    let found = low.mesh.triangles().len();
    println!("{what}: {found} triangles {:?}, {found_mean:.1e} {found_most:.1e} {farthest:.1e}", low.method);
    assert!(low.reached && low.method == SimplifyMethod::Collapsed, "{what}: {:?}", low.method);
    assert!(
        found_mean < mean && found_most.max(farthest) < most,
        "{what}: {found_mean} {found_most} {farthest}"
    );
    assert_eq!(open_edges(&low.mesh), 0, "{what}");
    assert!(low.notes.iter().any(|(note, _)| note.contains("unwelded seams")), "{what}: {:?}", low.notes);
}

#[test]
fn a_ball_with_an_unwelded_seam_stays_a_ball() {
    for size in [1e-3, 1.0, 1e3] {
        // The last column of vertices coincides with the first except for rounding, and so do all vertices at either
        // pole.
        let ball = Mesh::sphere(size, 400, 60);
        check(&format!("size {size}"), &ball, &to(&ball, 200), [1e-2, 3e-2]);
    }
}

#[test]
fn patches_with_noise_between_them_are_one_surface() {
    let ball = patches(&embossed_ball(40_000), 6.0);
    for (size, noise) in [(1.0, 1e-7), (1.0, 1e-6), (1e-3, 1e-6), (1e3, 1e-6)] {
        let ball = noisy(&ball, size, noise);
        check(&format!("patches of size {size}, noise {noise}"), &ball, &to(&ball, 400), [6e-3, 3e-2]);
    }
}

#[test]
fn loose_triangles_with_noise_between_them_are_one_surface() {
    let loose = unwelded(&embossed_ball(20_000));
    for noise in [1e-7, 1e-6] {
        let loose = noisy(&loose, 1.0, noise);
        check(&format!("noise {noise}"), &loose, &to(&loose, 1_000), [3e-3, 2e-2]);
    }
}

#[test]
fn seams_of_large_surfaces_are_welded_before_blocks_and_threads_do_not_matter() {
    let ball = Mesh::sphere(1.0, 1_000, 320);
    let [one, three] = [1, 3].map(|threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| to(&ball, 1_000))
    });
    check("blocks", &Mesh::sphere(1.0, 200, 100), &one, [3e-3, 2e-2]);
    assert_eq!(one.mesh.positions(), three.mesh.positions());
    assert_eq!(one.mesh.triangles(), three.mesh.triangles());
}
