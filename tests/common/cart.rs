//! A cart of thin sheets, tubes and wires: parts that do not touch, walls closer together than triangles are long,
//! and edges shared by three triangles.
use crate::hostile::{bare, sheet};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::Mesh;

type V = Vec3<f64>;

/// Joins meshes, each as a separate part.
pub fn joined(parts: &[Mesh]) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let first = positions.len() as u32;
        positions.extend_from_slice(part.positions());
        triangles.extend(part.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    bare(positions, triangles)
}

/// Returns a closed box of size `sides` with its lowest corner at `low`, each side cut into `cells`.
fn plate(low: V, sides: V, cells: [u32; 3]) -> Mesh {
    // Two sides per axis; equal numbers give equal bits, so the edges are closed.
    let side = |axis: usize, end: u32| {
        let [right, up] = [(axis + 1) % 3, (axis + 2) % 3];
        let flipped = if end == 0 { [up, right] } else { [right, up] };
        let place = |u: f64, v: f64| {
            let mut p = [0.0; 3];
            p[axis] = f64::from(end);
            p[flipped[0]] = u;
            p[flipped[1]] = v;
            low + Vec3::new(p[0] * sides.x, p[1] * sides.y, p[2] * sides.z)
        };
        sheet(cells[flipped[0]], cells[flipped[1]], place)
    };
    let all: Vec<Mesh> = (0..6).map(|i| side(i / 2, i as u32 % 2)).collect();
    joined(&all)
}

/// Returns a closed pipe around a path, of `around` by `along` squares, with fans at its ends.
fn wire(radius: f64, [around, along]: [u32; 2], path: impl Fn(f64) -> V) -> Mesh {
    let point = |u: f64, v: f64| {
        let (at, ahead) = (path(v), path(v + 1e-4));
        let forward = (ahead - at).normalize();
        // No path runs along this axis.
        let right = forward.cross(Vec3::new(0.3, 0.8, 0.5)).normalize();
        // The last column equals the first, to the bit.
        let angle = TAU * (u % 1.0);
        at + (right * scalar::cos(angle) + forward.cross(right) * scalar::sin(angle)) * radius
    };
    let side = sheet(around, along, point);
    let end = |v: f64| {
        let disc = |u: f64, w: f64| if (w == 0.0) == (v == 1.0) { point(u, v) } else { path(v) };
        sheet(around, 1, disc)
    };
    joined(&[side, end(0.0), end(1.0)])
}

/// Returns a ring: a torus about the y axis.
fn wheel(middle: V) -> Mesh {
    let place = |u: f64, v: f64| {
        let (a, b) = (-TAU * (u % 1.0), TAU * (v % 1.0));
        let out = 0.2 + 0.02 * scalar::cos(b);
        middle + Vec3::new(out * scalar::cos(a), 0.02 * scalar::sin(b), out * scalar::sin(a))
    };
    sheet(60, 16, place)
}

/// Returns a bent sheet without thickness, visible from one side, or from the other if `turned`.
fn curved(radius: f64, turned: bool) -> Mesh {
    sheet(40, 20, move |u, v| {
        let (u, v) = if turned { (v, u) } else { (u, v) };
        let angle = PI * (0.25 + 0.5 * u);
        Vec3::new(0.5 + radius * scalar::cos(angle), 0.2 + 0.4 * v, 0.5 + radius * scalar::sin(angle))
    })
}

/// Returns three leaves on one edge.
fn fins(middle: V) -> Mesh {
    let leaf = |i: u32| {
        let angle = TAU * f64::from(i) / 3.0;
        let out = Vec3::new(scalar::cos(angle), 0.0, scalar::sin(angle)) * 0.15;
        sheet(12, 24, move |u, v| middle + out * u + Vec3::new(0.0, 0.4 * v, 0.0))
    };
    joined(&[leaf(0), leaf(1), leaf(2)])
}

/// Returns the cart: 1 by 0.8 by 1, with about 29,000 triangles in 15 parts.
pub fn cart() -> Mesh {
    let v = V::new;
    let thin = [40, 32, 2];
    let mut parts = vec![
        plate(v(0.0, 0.0, 0.25), v(1.0, 0.8, 0.01), thin),
        plate(v(0.0, 0.0, 0.30), v(0.01, 0.8, 0.2), [2, 32, 12]),
        plate(v(0.99, 0.0, 0.30), v(0.01, 0.8, 0.2), [2, 32, 12]),
        plate(v(0.05, 0.0, 0.30), v(0.9, 0.004, 0.2), [40, 2, 12]),
        plate(v(0.05, 0.796, 0.30), v(0.9, 0.004, 0.2), [40, 2, 12]),
        // A roof of two walls.
        curved(0.30, false),
        curved(0.304, true),
        fins(v(0.5, 0.2, 0.55)),
    ];
    parts.extend([0.05, 0.75].map(|y| {
        wire(0.004, [6, 80], move |t| {
            v(0.5 - 0.45 * scalar::cos(PI * t), y, 0.55 + 0.4 * scalar::sin(PI * t))
        })
    }));
    parts.push(wire(0.015, [12, 40], move |t| v(0.2, -0.05 + 0.9 * t, 0.15)));
    parts.extend([[0.2, -0.1], [0.8, -0.1], [0.2, 0.9], [0.8, 0.9]].map(|[x, y]| wheel(v(x, y, 0.0))));
    joined(&parts)
}

/// Returns the part of each position, by its bits; parts are numbered in no particular order.
pub fn parts(mesh: &Mesh) -> HashMap<[u32; 3], u32> {
    let bits = |v: u32| mesh.positions()[v as usize].to_array().map(|v| (v + 0.0).to_bits());
    let mut parts: HashMap<[u32; 3], u32> = HashMap::new();
    for vertex in mesh.triangles().iter().flatten() {
        let number = parts.len() as u32;
        parts.entry(bits(*vertex)).or_insert(number);
    }
    // The lowest number spreads across triangles until nothing changes.
    loop {
        let mut changed = false;
        for triangle in mesh.triangles() {
            let keys = triangle.map(bits);
            let least = keys.map(|key| parts[&key]).into_iter().min().expect("three corners");
            for key in keys {
                changed |= parts.insert(key, least) != Some(least);
            }
        }
        if !changed {
            return parts;
        }
    }
}

/// Returns the number of parts.
pub fn count(parts: &HashMap<[u32; 3], u32>) -> usize {
    parts.values().collect::<std::collections::HashSet<_>>().len()
}
