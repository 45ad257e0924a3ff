//! Pairs whose largest distance is known exactly: the bounds of a proof contain it, and are as close as promised.

use crate::pairs::{grid, joined, mesh, moved, proof, scan_of, turned};
use taotie_engine::bake;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::MeshData;
use taotie_engine::proof::{Side, Source, distance_bounds};
use taotie_engine::scene::{Material, Scene};

/// The maximum distance between bounds, in model units.
const WIDTH: f32 = 1e-3;

/// A cube whose faces look outward, half as wide as `half`, each face of `cells`² squares.
fn cube(half: f64, cells: usize) -> MeshData {
    let face = |axis: usize, side: f64| {
        grid([cells; 2], false, |u, v| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) =
                (side * half, (2.0 * u - 1.0) * half, (1.0 - 2.0 * v) * half);
            Vec3::from_array(p)
        })
    };
    let faces = (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
    joined(faces.map(|(axis, side)| outward(face(axis, side))))
}

/// Orients all triangles of a part of a convex shape around the origin so that they face away from it.
fn outward(data: MeshData) -> MeshData {
    let [a, b, c] = data.triangles[0].map(|v| data.positions[v as usize]);
    let is_inward = (b - a).cross(c - a).dot(a + b + c) < 0.0;
    turned(data, |_| is_inward)
}

/// A plate of side 2 in the plane y = 0 with a pyramid in its middle: `half` is half the side of its base.
fn spiked(half: f64, height: f64) -> MeshData {
    const CELLS: usize = 8;
    grid([CELLS; 2], false, |u, v| {
        let at = |t: f64| {
            // The inner half of the grid is the base.
            let t = 2.0 * t - 1.0;
            if t.abs() <= 0.5 {
                t * 2.0 * half
            } else {
                t.signum() * (half + (t.abs() - 0.5) * 2.0 * (1.0 - half))
            }
        };
        let [x, z] = [at(u), at(v)];
        Vec3::new(x, height * (1.0 - x.abs().max(z.abs()) / half).max(0.0), z)
    })
}

/// Bounds the distances from one shape to another, of all its surface or of its visible part.
#[track_caller]
fn holds(from: &MeshData, to: &MeshData, (is_partly_hidden, truth): (bool, f64)) {
    let surface = |data: &MeshData| {
        bake::Scan::new(Scene::of_mesh(mesh(data.clone()), Material::default()).unwrap()).unwrap()
    };
    let (from, to) = (surface(from), surface(to));
    let side = Side::of(&from);
    let bounds = distance_bounds(Source { side: &side, is_partly_hidden, known: 0.0 }, &to, WIDTH);
    let (apart, most) = (bounds.upper - bounds.lower, f64::from(WIDTH) + 1e-5);
    assert!(bounds.lower <= truth && truth <= bounds.upper, "{bounds:?} do not contain {truth}");
    assert!(apart <= most, "{bounds:?} are {apart} apart");
}

/// Asserts that the distance in a proof, between the visible parts of both, contains the truth within bounds as close
/// as documented.
#[track_caller]
fn proof_holds(scan: MeshData, asset: MeshData, truth: f64) {
    let scene = Scene::of_mesh(mesh(asset), Material::default()).unwrap();
    let proof = proof(&scene, &scan_of(scan), Vec::new());
    let found = &proof.figures.levels[0];
    let bounds = found.hausdorff;
    assert!(bounds.lower <= truth && truth <= bounds.upper, "{bounds:?} do not contain {truth}");
    let (apart, most) =
        (bounds.upper - bounds.lower, (0.05 * truth).max(5e-4 * proof.figures.diagonal) + 1e-5);
    assert!(apart <= most, "{bounds:?} are {apart} apart");
    let parts = found.hausdorff_of_diagonal;
    assert!((parts.upper * proof.figures.diagonal - bounds.upper).abs() < 1e-6, "{parts:?}");
}

#[test]
fn of_a_cube_and_a_larger_one() {
    let (by, corner) = (0.1, 0.1 * 3f64.sqrt());
    for cells in [1, 7] {
        let (cube, larger) = (cube(1.0, cells), cube(1.0 + by, 3));
        for is_partly_hidden in [false, true] {
            holds(&cube, &larger, (is_partly_hidden, by));
            holds(&larger, &cube, (is_partly_hidden, corner));
        }
        proof_holds(cube.clone(), larger.clone(), corner);
        proof_holds(larger, cube, corner);
    }
}

#[test]
fn of_a_plate_and_one_with_a_pyramid() {
    let (half, height) = (0.125, 0.2);
    let flat = || spiked(half, 0.0);
    // Below the tip, the faces of the pyramid are the closest.
    let below = half * height / half.hypot(height);
    holds(&spiked(half, height), &flat(), (false, height));
    holds(&flat(), &spiked(half, height), (false, below));
    proof_holds(flat(), spiked(half, height), height);
    proof_holds(spiked(half, height), flat(), height);
}

#[test]
fn of_a_cube_and_the_same_moved() {
    let by = Vec3::new(0.03, 0.05, -0.07);
    let moved_by = || moved(cube(1.0, 5), |p| p + by);
    let truth = by.to_f64().length();
    for is_partly_hidden in [false, true] {
        holds(&cube(1.0, 2), &moved_by(), (is_partly_hidden, truth));
        holds(&moved_by(), &cube(1.0, 2), (is_partly_hidden, truth));
    }
    proof_holds(cube(1.0, 2), moved_by(), truth);
}

/// The inner cube is farther from the asset than anything visible.
#[test]
fn of_a_cube_with_another_inside() {
    let (by, inner) = (0.1, 0.5);
    let (scan, asset) = (joined([cube(1.0, 4), cube(inner, 4)]), cube(1.0 + by, 3));
    holds(&scan, &asset, (false, 1.0 + by - inner));
    holds(&scan, &asset, (true, by));
    for is_partly_hidden in [false, true] {
        holds(&asset, &scan, (is_partly_hidden, by * 3f64.sqrt()));
    }
    proof_holds(scan, asset, by * 3f64.sqrt());
}
