//! The UV island of each triangle.

use super::weld::{Classes, bits};
use crate::mesh::{DisjointSets, Mesh};

/// Returns the UV island of each triangle, as a number shared by its triangles: those that meet at corners with the
/// same uvs. The mesh must have uvs.
pub(crate) fn uv_islands(mesh: &Mesh) -> Vec<u32> {
    let uvs = &mesh.uvs()[0];
    let corners = Classes::by(uvs.len(), |i| bits([uvs[i].x, uvs[i].y]));
    let mut sets = DisjointSets::new(corners.firsts.len());
    for [a, b, c] in mesh.triangles().iter().map(|t| t.map(|i| corners.of[i as usize])) {
        sets.join(a, b);
        sets.join(b, c);
    }
    let lowest = sets.into_lowest();
    mesh.triangles().iter().map(|t| lowest[corners.of[t[0] as usize] as usize]).collect()
}
