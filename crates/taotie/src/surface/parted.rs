//! Splits vertices where the normals of neighbouring facets diverge.

use super::creases::{Corner, Splitter, Spot, sorted_corners};
use super::normals::facet_normal;
use super::weld;
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::Mesh;

/// The normals of neighbouring facets diverge at a vertex if they differ by more than 45°, and the facets by more
/// than 25°.
const SAME_NORMAL: f32 = 0.707;
const SAME_FACET: f32 = 0.906;

/// Splits the vertices of a mesh where the unit normals in `corners`, one per corner of each triangle, diverge across
/// an edge. Each side gets the mean of its normals; all other vertices keep theirs. Tangents are dropped.
///
/// # Errors
/// None for a validated mesh.
///
/// # Panics
/// If the mesh has no normals, or there are fewer corners than triangles.
pub(crate) fn parted(mesh: &Mesh, corners: &[[Vec3; 3]]) -> Result<Mesh> {
    let places = weld::by_position(mesh.positions()).of;
    let corners_around = sorted_corners(mesh, &places, |_| true);
    let normal = |corner: &Corner| corners[corner.triangle as usize][usize::from(corner.number)];
    let facet = |corner: &Corner| facet_normal(mesh.corners(corner.triangle as usize));
    let is_smooth = |a: &Corner, b: &Corner| {
        let bend = facet(a).zip(facet(b)).map_or(1.0, |(a, b)| a.dot(b));
        bend > SAME_FACET || normal(a).dot(normal(b)) > SAME_NORMAL
    };
    let mut splitter = Splitter::new(mesh.clone().into_data());
    for around in corners_around.chunk_by(|a, b| a.place == b.place) {
        let fans = Spot::new(mesh, &places, around).fans(|i, j| is_smooth(&around[i], &around[j]));
        if fans.iter().all(|fan| *fan == fans[0]) {
            continue;
        }
        let mean = |fan: u32| {
            let own = around.iter().zip(&fans).filter(|(_, other)| **other == fan);
            own.fold(Vec3::splat(0.0), |sum, (corner, _)| sum + normal(corner))
        };
        for (corner, fan) in around.iter().zip(&fans) {
            splitter.set(corner, *fan, mean(*fan).normalize_or(normal(corner)));
        }
    }
    splitter.into_mesh()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;
    use crate::surface::with_normals;

    /// Two squares that share an edge, the second one turned up by an angle in degrees, with smooth normals.
    fn book(degrees: f64) -> Mesh {
        let (sin, cos) = {
            let angle = degrees.to_radians();
            (crate::math::scalar::sin(angle) as f32, crate::math::scalar::cos(angle) as f32)
        };
        let [left, spine, right] = [[-1.0, 0.0], [0.0, 0.0], [cos, sin]];
        let at = |[x, z]: [f32; 2]| [0.0, 1.0].map(|y| Vec3::new(x, y, z));
        let positions = [left, spine, right].into_iter().flat_map(at).collect();
        let triangles = vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
        with_normals(&Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap())
            .unwrap()
            .into_owned()
    }

    /// The normals of the facets at all their corners.
    fn flat(mesh: &Mesh) -> Vec<[Vec3; 3]> {
        (0..mesh.triangles().len()).map(|t| [facet_normal(mesh.corners(t)).unwrap(); 3]).collect()
    }

    #[test]
    fn an_edge_is_hard_where_normals_part_and_facets_bend() {
        let sharp = book(60.0);
        let split = parted(&sharp, &flat(&sharp)).unwrap();
        assert_eq!((sharp.positions().len(), split.positions().len()), (6, 8));
        for (t, facet) in flat(&sharp).iter().enumerate() {
            let normals = split.triangles()[t].map(|v| split.normals()[v as usize]);
            assert!(normals.iter().all(|normal| normal.dot(facet[0]) > 0.999), "{t}");
        }
        // A round spine has the same normal on both sides, a shallow one hardly a different one.
        let round = vec![[Vec3::new(0.0, 0.0, 1.0); 3]; 4];
        assert_eq!(parted(&sharp, &round).unwrap().positions().len(), 6);
        let shallow = book(40.0);
        assert_eq!(parted(&shallow, &flat(&shallow)).unwrap().positions().len(), 6);
    }
}
