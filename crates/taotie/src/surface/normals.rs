//! Normals from geometry only: of a triangle, and of the vertices it shares.

use super::angles::{self, Share, unit};
use super::weld::{self, Classes};
use crate::error::Result;
use crate::math::{SimdLevel, Vec3};
use crate::mesh::Mesh;
use crate::parallel;
use fearless_simd::Level;
use std::borrow::Cow;
use std::ops::Range;

/// The normal of a vertex that is not part of any triangle with an area.
pub(super) const FALLBACK: Vec3 = Vec3::new(0.0, 0.0, 1.0);

/// The unit normal of a triangle on the side from which its corners run counter-clockwise; `None` without an area.
pub fn facet_normal(corners: [Vec3; 3]) -> Option<Vec3> {
    unit(doubled_area(corners.map(Vec3::to_f64))).map(Vec3::to_f32)
}

/// Returns one unit normal per position: the facet normals around it, each weighted by the triangle's angle there.
///
/// Bit-identical positions count as one vertex, so a surface that is cut for its uvs stays smooth. Triangles without
/// area are skipped. If the sum cancels, the vertex takes the normal of its first triangle; if it has none, (0, 0,
/// 1).
///
/// Law: independent of how a flat polygon is split into triangles (`laws::surface::normals_ignore_the_triangulation`).
/// Source: Thürmer and Wüthrich 1998, "Computing vertex normals from polygonal facets".
pub fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    vertex_normals_at(SimdLevel::fastest(), mesh)
}

/// [`vertex_normals`], computed at a SIMD level.
fn vertex_normals_at(level: Level, mesh: &Mesh) -> Vec<Vec3> {
    let places = weld::by_position(mesh.positions());
    let sums = angle_weighted_sums(level, mesh, &places);
    let cancelled = parallel::count(sums.len(), |i| unit(sums[i]).is_none());
    let firsts = if cancelled > 0 { first_facets(mesh) } else { Vec::new() };
    let normal_of = |i: usize| match unit(sums[places.of[i] as usize]) {
        Some(normal) => normal.to_f32(),
        None => firsts[i].unwrap_or(FALLBACK),
    };
    parallel::collect(places.of.len(), normal_of)
}

/// Returns the mesh with [`vertex_normals`] if it has none. Tangents without normals are meaningless and are dropped.
///
/// # Errors
/// None for a validated mesh.
pub fn with_normals(mesh: &Mesh) -> Result<Cow<'_, Mesh>> {
    with_normals_at(SimdLevel::fastest(), mesh)
}

/// [`with_normals`], computed at a SIMD level.
pub(crate) fn with_normals_at(level: Level, mesh: &Mesh) -> Result<Cow<'_, Mesh>> {
    if !mesh.normals().is_empty() {
        return Ok(Cow::Borrowed(mesh));
    }
    let mut data = mesh.clone().into_data();
    data.normals = vertex_normals_at(level, mesh);
    data.tangents = Vec::new();
    Ok(Cow::Owned(Mesh::new(data)?))
}

/// Sums in triangle order, whatever the number of threads: while one block is summed, the next is computed.
fn angle_weighted_sums(level: Level, mesh: &Mesh, places: &Classes) -> Vec<Vec3<f64>> {
    const BLOCK: usize = 1 << 15;
    let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
    let add = |block: usize, shares: &[Share], sums: &mut [Vec3<f64>]| {
        for (triangle, share) in mesh.triangles()[block * BLOCK..].iter().zip(shares) {
            for (vertex, angle) in triangle.iter().zip(share.angles) {
                sums[places.of[*vertex as usize] as usize] += share.normal * angle;
            }
        }
    };
    let blocks = mesh.triangles().len().div_ceil(BLOCK);
    let (mut ready, mut next) = (Vec::new(), Vec::new());
    for block in 0..=blocks {
        let range = block * BLOCK..mesh.triangles().len().min((block + 1) * BLOCK);
        rayon::join(
            || compute_shares(level, mesh, range, &mut next),
            || add(block.saturating_sub(1), &ready, &mut sums),
        );
        std::mem::swap(&mut ready, &mut next);
    }
    sums
}

/// Replaces the content of `shares` by the contributions of some triangles.
fn compute_shares(level: Level, mesh: &Mesh, triangles: Range<usize>, shares: &mut Vec<Share>) {
    const PART: usize = 1 << 10;
    shares.resize(triangles.len(), Share::NONE);
    parallel::pieces(shares, PART, &|i, part| angles::shares(level, mesh, triangles.start + i * PART, part));
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

/// For each vertex, sums the vectors of all vertices at its position, each distinct one counted once, so that cuts in
/// a surface do not matter.
pub(crate) fn mean_by_position(mesh: &Mesh, vectors: &[Vec3]) -> Vec<Vec3> {
    let places = weld::by_position(mesh.positions());
    let kinds = places.split_by(|v| weld::bits(vectors[v].to_array()));
    let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
    for first in &kinds.firsts {
        sums[places.of[*first as usize] as usize] += vectors[*first as usize];
    }
    places.of.iter().map(|place| sums[*place as usize]).collect()
}

/// Gives all vertices at one position the largest of their values.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

    /// Blocks, threads and lanes change nothing: the sums are those of one plain loop, to the last bit.
    #[test]
    fn sums_are_those_of_a_plain_loop() {
        let mut data: MeshData = Mesh::sphere(1.0, 300, 200).into_data();
        data.triangles.iter_mut().step_by(1000).for_each(|t| t[1] = t[0]);
        data.positions.iter_mut().skip(500).step_by(7000).for_each(|p| *p = *p * 1e-30);
        let mesh = Mesh::new(data).unwrap();
        assert!(mesh.triangles().len() > 100_000);
        let places = weld::by_position(mesh.positions());
        let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            let corners = mesh.corners(i).map(Vec3::to_f64);
            let Some(normal) = unit(doubled_area(corners)) else { continue };
            for (vertex, angle) in triangle.iter().zip(angles::corner_angles(corners)) {
                sums[places.of[*vertex as usize] as usize] += normal * angle;
            }
        }
        let bits =
            |sums: &[Vec3<f64>]| sums.iter().flat_map(|s| s.to_array().map(f64::to_bits)).collect::<Vec<_>>();
        for simd in SimdLevel::available() {
            let ours = angle_weighted_sums(simd.dispatch().unwrap(), &mesh, &places);
            assert!(bits(&ours) == bits(&sums), "{simd:?}");
        }
    }
}
