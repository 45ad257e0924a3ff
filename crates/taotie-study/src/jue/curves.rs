//! The edges of a mesh as cubic curves tangent to the planes of its vertex normals.

use super::welds::Welds;
use std::collections::HashMap;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;

/// The control points of an edge's curve, from the end with the smaller index to the other.
pub(super) type Curve = [Vec3<f64>; 4];

/// Returns the curve of every edge, keyed by the positions of its ends.
pub(super) fn curves(mesh: &Mesh, welds: &Welds) -> HashMap<(u32, u32), Curve> {
    let mut sides: HashMap<(u32, u32), Vec<[Vec3<f64>; 2]>> = HashMap::new();
    let normal = |i: u32| mesh.normals()[i as usize].to_f64();
    for [a, b, c] in mesh.triangles() {
        for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
            let (p, q) = welds.ordered(from, to);
            sides.entry(welds.edge(p, q)).or_default().push([normal(p), normal(q)]);
        }
    }
    let position = |i: u32| mesh.positions()[i as usize].to_f64();
    sides
        .into_iter()
        .map(|((a, b), sides)| {
            let (p, q) = (position(a), position(b));
            let (first, last) = (sides[0], sides[sides.len() - 1]);
            let out = handle(q - p, first[0], last[0]);
            let back = handle(p - q, first[1], last[1]);
            ((a, b), [p, p + out, q + back, q])
        })
        .collect()
}

/// The maximum distance of a curve's control point from its chord, metres: long edges, such as those of the spout,
/// stay nearly straight.
const LARGEST_BEND: f64 = 0.0022;

/// Returns the control handle, a third of the edge `d`, at an end with these normals on its two sides.
///
/// If the normals agree, the handle is bent into the tangent plane; at a crease, into both planes along their
/// intersection. If that points elsewhere, as at tips and corners, the handle stays straight.
fn handle(d: Vec3<f64>, n: Vec3<f64>, m: Vec3<f64>) -> Vec3<f64> {
    let crease = n.cross(m);
    let tangent = if crease.length() < 1e-6 {
        d - n * n.dot(d)
    } else {
        let along = crease.normalize();
        let reach = along.dot(d);
        let wayward = reach.abs() < 0.88 * d.length() || crease.length() < 0.3;
        if wayward { d } else { along * reach }
    };
    let bend = (tangent - d) / 3.0;
    let length = bend.length();
    d / 3.0 + if length > LARGEST_BEND { bend * (LARGEST_BEND / length) } else { bend }
}

/// Returns the point of a curve at `t`, by the Bernstein sum, which is symmetric and short.
pub(super) fn bezier([a, b, c, d]: &Curve, t: f64) -> Vec3<f64> {
    let s = 1.0 - t;
    *a * (s * s * s) + *b * (3.0 * s * s * t) + *c * (3.0 * s * t * t) + *d * (t * t * t)
}
