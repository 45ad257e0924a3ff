//! The relief as geometry: the low-poly mesh rounded, subdivided and displaced.
//!
//! Each triangle becomes a cubic patch tangent to the planes of the vertex normals (Vlachos et al. 2001, "Curved PN
//! triangles"), so that the surface without relief is as round as the smooth shading of the low-poly mesh suggests.
//! Patches meet without cracks: the curve of an edge depends only on data shared by both triangles, and relief is 0
//! on UV island borders.

use super::patch::{Patch, Point, edge_of};
use super::rounded::Rounded;
use super::split::{Piece, Split};
use super::welds::Welds;
use rayon::prelude::*;
use std::collections::HashMap;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};

/// Returns the low-poly mesh with every triangle split and displaced by `height`, and the normals of the displaced
/// surface; see [`Split`].
pub(super) fn mesh(low: &Mesh, finest: f64, height: impl Fn(f32, f32) -> f32 + Sync) -> Mesh {
    let welds = Welds::new(low);
    let Rounded { patches, .. } = Rounded::new(low, &welds);
    let split = |patch: &Patch<'_>| Split::new(patch, finest, &height).run();
    let pieces: Vec<Piece> = patches.par_iter().map(split).collect();
    let normals = shared(pieces.iter().flat_map(|piece| &piece.points), &slots(&patches, &pieces));
    let points = || pieces.iter().flat_map(|piece| &piece.points);
    let data = MeshData {
        positions: points().map(|point| point.position.to_f32()).collect(),
        normals,
        uvs: vec![points().map(|point| point.uv).collect()],
        triangles: joined(&pieces),
        ..MeshData::default()
    };
    Mesh::new(data).expect("indices are in range and all points are finite")
}

/// Returns the triangles of all pieces, with their points concatenated.
fn joined(pieces: &[Piece]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let mut first = 0;
    for piece in pieces {
        triangles.extend(piece.triangles.iter().map(|t| t.map(|i| i + first)));
        first += piece.points.len() as u32;
    }
    triangles
}

/// Returns a slot for every point; points that share their normal have the same slot.
fn slots(patches: &[Patch<'_>], pieces: &[Piece]) -> Vec<u32> {
    let mut shared: HashMap<(u32, u32, u32), u32> = HashMap::new();
    let mut next = 0;
    let mut slots = Vec::new();
    for (patch, piece) in patches.iter().zip(pieces) {
        for point in &piece.points {
            let fresh = next;
            let slot = match edge_of(point.weights) {
                Some((i, k)) => *shared.entry(patch.edge_key(i, k)).or_insert(fresh),
                None => fresh,
            };
            next += u32::from(slot == fresh);
            slots.push(slot);
        }
    }
    slots
}

/// Returns the mean normal of all points with the same slot.
fn shared<'a>(points: impl Iterator<Item = &'a Point>, slots: &[u32]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::splat(0.0); slots.len()];
    for (point, slot) in points.zip(slots) {
        sums[*slot as usize] += point.normal;
    }
    slots.iter().map(|slot| sums[*slot as usize].normalize_or(Vec3::new(0.0, 1.0, 0.0)).to_f32()).collect()
}
