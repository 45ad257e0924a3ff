//! Welds equal positions, and those on either side of a seam, into one vertex, in an order in which neighbours in
//! space are neighbours in memory.
//!
//! Positions are sorted along a Morton curve, so that equal ones meet in one cell: this avoids a hash table, whose
//! size and order would matter at twenty million triangles.

use super::morton::morton;
use super::part::{Part, UnitCube};
use super::seams;
use crate::error::Warnings;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use rayon::prelude::*;

/// Marks triangles that are left out; they are sorted to the end.
const DROPPED: [u32; 3] = [u32::MAX; 3];

/// Returns the mesh on welded points. Each triangle begins with its lowest vertex, and triangles are sorted.
pub(super) fn weld(mesh: &Mesh, notes: &mut Warnings) -> (Part, UnitCube) {
    let positions = mesh.positions();
    let cube = UnitCube::of(positions);
    let (places, sources) = classes(positions, &sorted(positions, &cube));
    let points = parallel::collect(sources.len(), |i| cube.scaled(positions[sources[i] as usize]));
    let triangles = sound_triangles(mesh.triangles(), &places, notes);
    let part = Part { points, sources, triangles, labels: Vec::new() };
    let Some((becomes, joined)) = seams::closed(&part, mesh, &cube) else {
        return (part, cube);
    };
    notes.note("vertices on unwelded seams of the scan, welded before simplification", joined);
    let triangles = sound_triangles(&part.triangles, &becomes, notes);
    (Part { triangles, ..part }.compacted(), cube)
}

/// Returns the position index of each vertex: vertices with equal positions share one.
pub(in crate::bake) fn places(positions: &[Vec3]) -> Vec<u32> {
    classes(positions, &sorted(positions, &UnitCube::of(positions))).0
}

/// Returns vertex indices in the low half, sorted by cell, then position, then index.
fn sorted(positions: &[Vec3], cube: &UnitCube) -> Vec<u64> {
    let cell = |position: Vec3| u64::from(morton(cube.scaled(position)));
    let mut keys = parallel::collect(positions.len(), |v| cell(positions[v]) << 32 | v as u64);
    keys.par_sort_unstable();
    let by_position = |key: &u64| (bits(positions[*key as u32 as usize]), *key);
    keys.par_chunk_by_mut(|a, b| a >> 32 == b >> 32).for_each(|cell| {
        if cell.len() > 1 {
            cell.sort_unstable_by_key(by_position);
        }
    });
    keys
}

/// Returns the position index of each vertex, and the first vertex at each position.
fn classes(positions: &[Vec3], sorted: &[u64]) -> (Vec<u32>, Vec<u32>) {
    let (mut places, mut firsts) = (vec![0; positions.len()], Vec::new());
    let mut last = None;
    for key in sorted {
        let vertex = *key as u32;
        let here = bits(positions[vertex as usize]);
        if last != Some(here) {
            firsts.push(vertex);
            last = Some(here);
        }
        places[vertex as usize] = firsts.len() as u32 - 1;
    }
    firsts.shrink_to_fit();
    (places, firsts)
}

/// Returns the distinct triangles on position indices, without those with two equal corners.
fn sound_triangles(triangles: &[[u32; 3]], places: &[u32], notes: &mut Warnings) -> Vec<[u32; 3]> {
    let on_places = |t: usize| lowest_first(triangles[t].map(|v| places[v as usize]));
    let mut sound = parallel::collect(triangles.len(), on_places);
    sound.par_sort_unstable();
    sound.truncate(sound.partition_point(|triangle| *triangle != DROPPED));
    notes.note("triangles with two equal corners, left out", triangles.len() - sound.len());
    let with_twins = sound.len();
    sound.dedup();
    notes.note("duplicate triangles, left out", with_twins - sound.len());
    sound
}

/// Returns the triangle rotated so that its lowest vertex comes first.
fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    match () {
        () if a == b || b == c || c == a => DROPPED,
        () if a < b && a < c => [a, b, c],
        () if b < c => [b, c, a],
        () => [c, a, b],
    }
}

/// Returns the bits of a position, with a single sign for zero.
fn bits(position: Vec3) -> [u32; 3] {
    position.to_array().map(|v| (v + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

    #[test]
    fn equal_positions_are_one_and_bad_triangles_are_counted() {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let data = MeshData {
            positions: vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0), p(-0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0)],
            triangles: vec![[0, 1, 2], [2, 3, 4], [0, 3, 1], [2, 1, 5], [0, 2, 1], [1, 1, 1]],
            ..MeshData::default()
        };
        let mut notes = Warnings::default();
        let (part, cube) = weld(&Mesh::new(data).unwrap(), &mut notes);
        assert_eq!((part.points.len(), cube.extent), (4, 1.0));
        assert_eq!(part.triangles.len(), 3, "the triangle seen from behind stays: {:?}", part.triangles);
        let found: Vec<(&str, usize)> = notes.iter().collect();
        assert_eq!(
            found,
            [("triangles with two equal corners, left out", 2), ("duplicate triangles, left out", 1)]
        );
        assert!(
            part.sources.iter().all(|v| [0, 1, 2, 5].contains(v)),
            "the first of equal ones represents them"
        );
    }
}
