//! Normals from geometry alone: of a triangle, and of the vertices it shares.

use super::weld;
use crate::error::Result;
use crate::math::{Vec3, scalar};
use crate::mesh::Mesh;
use rayon::prelude::*;
use std::borrow::Cow;

/// The normal of a vertex that no triangle with an area touches.
pub(super) const FALLBACK: Vec3 = Vec3::new(0.0, 0.0, 1.0);

/// The unit normal of a triangle on the side from which its corners run counter-clockwise; `None` without an area.
pub fn facet_normal(corners: [Vec3; 3]) -> Option<Vec3> {
    unit(doubled_area(corners.map(Vec3::to_f64))).map(Vec3::to_f32)
}

/// One unit normal a position: the facet normals around it, each weighted by the triangle's angle there.
///
/// Positions that are equal to the last bit count as one vertex, so a surface that is cut for its uvs stays
/// smooth. Triangles without area are passed over. Where the sum cancels, the vertex takes the normal of its
/// first triangle; where there is none, (0, 0, 1).
///
/// Law: independent of how a flat polygon is split into triangles (`laws_surface::normals_ignore_the_triangulation`).
/// Source: Thürmer and Wüthrich 1998, "Computing vertex normals from polygonal facets".
pub fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let places = weld::by_position(mesh.positions());
    let sums = angle_weighted_sums(mesh, &places);
    let normals: Vec<Option<Vec3<f64>>> = sums.into_iter().map(unit).collect();
    let lacking = places.of.iter().any(|place| normals[*place as usize].is_none());
    let firsts = if lacking { first_facets(mesh) } else { Vec::new() };
    let normal_of = |(i, place): (usize, &u32)| match normals[*place as usize] {
        Some(normal) => normal.to_f32(),
        None => firsts[i].unwrap_or(FALLBACK),
    };
    places.of.iter().enumerate().map(normal_of).collect()
}

/// The mesh with [`vertex_normals`] where it has none. Tangents without normals mean nothing and are left out.
///
/// # Errors
/// None can happen to a mesh that was checked.
pub fn with_normals(mesh: &Mesh) -> Result<Cow<'_, Mesh>> {
    if !mesh.normals().is_empty() {
        return Ok(Cow::Borrowed(mesh));
    }
    let mut data = mesh.clone().into_data();
    data.normals = vertex_normals(mesh);
    data.tangents = Vec::new();
    Ok(Cow::Owned(Mesh::new(data)?))
}

/// Sums in triangle order, whatever the number of threads.
fn angle_weighted_sums(mesh: &Mesh, places: &weld::Classes) -> Vec<Vec3<f64>> {
    const BLOCK: usize = 1 << 16;
    let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
    for (block, triangles) in mesh.triangles().chunks(BLOCK).enumerate() {
        let first = block * BLOCK;
        let shares: Vec<[Vec3<f64>; 3]> = (first..first + triangles.len())
            .into_par_iter()
            .map(|t| corner_shares(mesh.corners(t)))
            .collect();
        for (triangle, shares) in triangles.iter().zip(shares) {
            for (vertex, share) in triangle.iter().zip(shares) {
                sums[places.of[*vertex as usize] as usize] += share;
            }
        }
    }
    sums
}

/// The facet normal times the angle at each corner, in radians; zero without an area.
fn corner_shares(corners: [Vec3; 3]) -> [Vec3<f64>; 3] {
    let [a, b, c] = corners.map(Vec3::to_f64);
    match unit(doubled_area([a, b, c])) {
        Some(normal) => corner_angles([a, b, c]).map(|angle| normal * angle),
        None => [Vec3::splat(0.0); 3],
    }
}

/// The angle at each corner of a triangle, in radians.
pub(super) fn corner_angles([a, b, c]: [Vec3<f64>; 3]) -> [f64; 3] {
    [angle_between(b - a, c - a), angle_between(c - b, a - b), angle_between(a - c, b - c)]
}

/// Kahan's formula in its cross-product form: exact for small angles, where the arc cosine is not.
fn angle_between(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    scalar::atan2(a.cross(b).length(), a.dot(b))
}

/// The normal of the first triangle with an area at each vertex.
fn first_facets(mesh: &Mesh) -> Vec<Option<Vec3>> {
    let mut firsts = vec![None; mesh.positions().len()];
    for (i, triangle) in mesh.triangles().iter().enumerate() {
        for vertex in triangle {
            let first: &mut Option<Vec3> = &mut firsts[*vertex as usize];
            if first.is_none() {
                *first = facet_normal(mesh.corners(i));
            }
        }
    }
    firsts
}

fn doubled_area([a, b, c]: [Vec3<f64>; 3]) -> Vec3<f64> {
    (b - a).cross(c - a)
}

/// The unit vector; `None` where nothing but rounding is left.
fn unit(v: Vec3<f64>) -> Option<Vec3<f64>> {
    let length = v.length();
    (length > 1e-300 && length.is_finite()).then(|| v / length)
}

/// Gives all vertices at one place the largest of their values.
pub(crate) fn shared_by_position(mesh: &Mesh, values: &mut [f32]) {
    let places = weld::by_position(mesh.positions());
    let mut largest = vec![f32::NEG_INFINITY; places.firsts.len()];
    for (place, value) in places.of.iter().zip(&*values) {
        let most = &mut largest[*place as usize];
        *most = most.max(*value);
    }
    for (place, value) in places.of.iter().zip(values) {
        *value = largest[*place as usize];
    }
}
