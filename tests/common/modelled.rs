//! Shapes as modelling programs create them, with the intended normal at each corner.

use std::f64::consts::TAU;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};

/// A triangle with the intended normals at its corners.
#[derive(Clone, Copy)]
pub struct Facet {
    pub corners: [Vec3<f64>; 3],
    pub normals: [Vec3<f64>; 3],
}

impl Facet {
    /// Returns a flat one.
    fn flat([a, b, c]: [Vec3<f64>; 3]) -> Self {
        Self { corners: [a, b, c], normals: [(b - a).cross(c - a).normalize(); 3] }
    }
}

/// Returns a flat convex polygon, its corners counter-clockwise from outside.
fn polygon(corners: &[Vec3<f64>]) -> impl Iterator<Item = Facet> {
    (1..corners.len() - 1).map(|i| Facet::flat([corners[0], corners[i], corners[i + 1]]))
}

/// Returns the points of a regular polygon.
pub fn ring(count: usize, radius: f64) -> Vec<[f64; 2]> {
    let angle = |i: usize| TAU * i as f64 / count as f64;
    (0..count).map(|i| [radius * scalar::cos(angle(i)), radius * scalar::sin(angle(i))]).collect()
}

fn at([x, y]: [f64; 2], z: f64) -> Vec3<f64> {
    Vec3::new(x, y, z)
}

/// Returns the walls over an outline, which runs counter-clockwise if they face outward. Round ones have radial
/// normals.
fn walls(outline: &[[f64; 2]], [low, high]: [f64; 2], is_round: bool) -> Vec<Facet> {
    let count = outline.len();
    let mut facets = Vec::new();
    for i in 0..count {
        let (p, q) = (outline[i], outline[(i + 1) % count]);
        let quad = [at(p, low), at(q, low), at(q, high), at(p, high)];
        for mut facet in polygon(&quad) {
            if is_round {
                let side = facet.normals[0];
                facet.normals = facet.corners.map(|c| {
                    let radial = Vec3::new(c.x, c.y, 0.0).normalize();
                    if radial.dot(side) < 0.0 { -radial } else { radial }
                });
            }
            facets.push(facet);
        }
    }
    facets
}

/// Returns a cylinder of `segments` segments that represents a round one.
pub fn cylinder(segments: usize) -> Vec<Facet> {
    let outline = ring(segments, 1.0);
    let mut facets = walls(&outline, [0.0, 2.0], true);
    facets.extend(caps(&outline, [0.0, 2.0]));
    facets
}

/// Returns both ends of a star-shaped outline.
fn caps(outline: &[[f64; 2]], [low, high]: [f64; 2]) -> Vec<Facet> {
    let count = outline.len();
    let end = |i: usize| {
        let (p, q) = (outline[i], outline[(i + 1) % count]);
        let middle = [0.0; 2];
        [[at(middle, high), at(p, high), at(q, high)], [at(middle, low), at(q, low), at(p, low)]]
    };
    (0..count).flat_map(end).map(Facet::flat).collect()
}

/// Returns a hexagonal nut with a round hole of `segments` segments, a multiple of six.
pub fn nut(segments: usize) -> Vec<Facet> {
    let (outer, hole) = (ring(6, 1.0), ring(segments, 0.5));
    let [low, high] = [0.0, 0.8];
    let mut facets = walls(&outer, [low, high], false);
    let inward: Vec<[f64; 2]> = hole.iter().rev().copied().collect();
    facets.extend(walls(&inward, [low, high], true));
    let each = segments / 6;
    for side in 0..6 {
        let (p, q) = (outer[side], outer[(side + 1) % 6]);
        for k in side * each..(side + 1) * each {
            facets.extend(annulus([p, hole[(k + 1) % segments], hole[k % segments]], [low, high]));
        }
        facets.extend(annulus([p, q, hole[(side + 1) * each % segments]], [low, high]));
    }
    facets
}

/// Returns a triangle at the top, counter-clockwise, and the same at the bottom.
fn annulus([a, b, c]: [[f64; 2]; 3], [low, high]: [f64; 2]) -> [Facet; 2] {
    [Facet::flat([at(a, high), at(b, high), at(c, high)]), Facet::flat([at(a, low), at(c, low), at(b, low)])]
}

/// Returns a gear with square teeth.
pub fn gear(teeth: usize) -> Vec<Facet> {
    let point = |i: usize| {
        let angle = TAU * i as f64 / (4 * teeth) as f64;
        // Flanks are steep: their ends are close together.
        let radius = if i % 4 < 2 { 1.25 } else { 1.0 };
        let angle = if i % 2 == 1 { angle } else { angle - 0.4 * TAU / (4 * teeth) as f64 };
        [radius * scalar::cos(angle), radius * scalar::sin(angle)]
    };
    let outline: Vec<[f64; 2]> = (0..4 * teeth).map(point).collect();
    let mut facets = walls(&outline, [0.0, 0.5], false);
    facets.extend(caps(&outline, [0.0, 0.5]));
    facets
}

/// Returns a box with a 45° chamfer along all edges.
pub fn chamfered_box() -> Vec<Facet> {
    let (side, flat) = (1.0, 0.85);
    let mut facets = Vec::new();
    let place = |axis: usize, [u, v, w]: [f64; 3]| {
        let mut p = [0.0; 3];
        (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u, v, w);
        Vec3::from_array(p)
    };
    let mut add = |mut corners: Vec<Vec3<f64>>| {
        let middle = corners.iter().fold(Vec3::splat(0.0), |sum, c| sum + *c);
        if (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(middle) < 0.0 {
            corners.reverse();
        }
        facets.extend(polygon(&corners));
    };
    let signs = [-1.0, 1.0];
    for axis in 0..3 {
        for s in signs {
            let around = [[-flat, -flat], [flat, -flat], [flat, flat], [-flat, flat]];
            add(around.map(|[v, w]| place(axis, [s * side, v, w])).to_vec());
            for t in signs {
                let quad = [[side, flat, -flat], [side, flat, flat], [flat, side, flat], [flat, side, -flat]];
                add(quad.map(|[v, w, u]| place(axis, [u, s * v, t * w])).to_vec());
            }
        }
    }
    for (a, b, c) in signs.iter().flat_map(|a| signs.iter().flat_map(move |b| signs.map(|c| (*a, *b, c)))) {
        let corner = [[side, flat, flat], [flat, side, flat], [flat, flat, side]];
        add(corner.map(|[x, y, z]| Vec3::new(a * x, b * y, c * z)).to_vec());
    }
    facets
}

/// Returns a cube of which each face is a grid of `squares`² squares.
pub fn gridded_cube(squares: usize) -> Vec<Facet> {
    let along = |i: usize| 2.0 * i as f64 / squares as f64 - 1.0;
    let mut facets = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            for i in 0..squares * squares {
                let (u, v) = (i % squares, i / squares);
                let mut quad = [(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)].map(|(u, v)| {
                    let mut p = [0.0; 3];
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, along(u), along(v));
                    Vec3::from_array(p)
                });
                if side < 0.0 {
                    quad.reverse();
                }
                facets.extend(polygon(&quad));
            }
        }
    }
    facets
}

/// Returns the facets rotated and moved off the axes, so that no normal and no plane is exact.
pub fn askew(facets: Vec<Facet>) -> Vec<Facet> {
    let [c, s] = [scalar::cos(0.7), scalar::sin(0.7)];
    let turn = |v: Vec3<f64>| {
        let v = Vec3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
        Vec3::new(v.x, c * v.y - s * v.z, s * v.y + c * v.z)
    };
    let shift = Vec3::new(3.0, -5.0, 10.0);
    let moved =
        |f: Facet| Facet { corners: f.corners.map(|p| turn(p) + shift), normals: f.normals.map(turn) };
    facets.into_iter().map(moved).collect()
}

/// Returns the mesh that STL gives: corners at one position are one vertex, and there are no normals.
pub fn welded(facets: &[Facet]) -> Mesh {
    let mut data = MeshData::default();
    let mut known = std::collections::HashMap::new();
    for facet in facets {
        data.triangles.push(facet.corners.map(|corner| {
            let p = corner.to_f32();
            *known.entry(p.to_array().map(f32::to_bits)).or_insert_with(|| {
                data.positions.push(p);
                data.positions.len() as u32 - 1
            })
        }));
    }
    Mesh::new(data).unwrap()
}

/// Returns the mesh that flat-shaded glTF gives: triangles that share nothing, each with the normal of its facet.
pub fn loose(facets: &[Facet]) -> Mesh {
    let mut data = MeshData::default();
    for facet in facets {
        let [a, b, c] = facet.corners;
        let first = data.positions.len() as u32;
        data.positions.extend(facet.corners.map(|p| p.to_f32()));
        data.normals.extend([(b - a).cross(c - a).normalize().to_f32(); 3]);
        data.triangles.push([first, first + 1, first + 2]);
    }
    Mesh::new(data).unwrap()
}
