//! Faults of a surface itself.

use crate::mesh::Mesh;
use crate::parallel;
use crate::surface;
use rayon::prelude::*;

/// The faults of a surface itself, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges where more than two triangles meet.
    pub crowded_edges: usize,
    /// Triangles that have the same corners as an earlier one, whichever way they face.
    pub duplicates: usize,
    /// Triangles without area.
    pub flat: usize,
}

impl Faults {
    /// Counts the faults of a mesh, vertices at one position counted as one.
    pub fn of(mesh: &Mesh) -> Self {
        let places = surface::by_position(mesh.positions()).of;
        let triangles = mesh.triangles();
        let corners = |t: usize| triangles[t].map(|v| places[v as usize]);
        let mut wholes: Vec<[u32; 3]> = parallel::collect(triangles.len(), corners);
        wholes.retain(|[a, b, c]| a != b && b != c && c != a);
        let edge = |[a, b]: [u32; 2]| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let edges: Vec<[u64; 3]> = parallel::collect(wholes.len(), |t| {
            let [a, b, c] = wholes[t];
            [edge([a, b]), edge([b, c]), edge([c, a])]
        });
        let mut edges = edges.into_flattened();
        edges.par_sort_unstable();
        let (mut open_edges, mut crowded_edges) = (0, 0);
        for edge in edges.chunk_by(|a, b| a == b) {
            open_edges += usize::from(edge.len() == 1);
            crowded_edges += usize::from(edge.len() > 2);
        }
        drop(edges);
        parallel::change(&mut wholes, |_, corners| corners.sort_unstable());
        wholes.par_sort_unstable();
        let duplicates = wholes.windows(2).filter(|pair| pair[0] == pair[1]).count();
        Self { open_edges, crowded_edges, duplicates, flat: mesh.degenerate_triangles() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;

    #[test]
    fn each_fault_is_counted() {
        let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let positions = vec![
            corner(0.0, 0.0, 0.0),
            corner(1.0, 0.0, 0.0),
            corner(0.0, 1.0, 0.0),
            corner(0.0, 0.0, 1.0),
            // The first once more: cut for uvs, but one place.
            corner(0.0, 0.0, 0.0),
            corner(0.0, -1.0, 0.0),
        ];
        let faults = |triangles: &[[u32; 3]]| {
            let data = MeshData {
                positions: positions.clone(),
                triangles: triangles.to_vec(),
                ..MeshData::default()
            };
            Faults::of(&Mesh::new(data).unwrap())
        };
        let closed = [[0, 2, 1], [4, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(faults(&closed), Faults::default());
        assert_eq!(faults(&closed[..3]), Faults { open_edges: 3, ..Faults::default() });
        let fin = [closed.as_slice(), &[[0, 1, 5]]].concat();
        assert_eq!(faults(&fin), Faults { open_edges: 2, crowded_edges: 1, ..Faults::default() });
        let twice = [closed.as_slice(), &[[1, 0, 2], [0, 0, 1]]].concat();
        assert_eq!(faults(&twice), Faults { crowded_edges: 3, duplicates: 1, flat: 1, ..Faults::default() });
    }
}
