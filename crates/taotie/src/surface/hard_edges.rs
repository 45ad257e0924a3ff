//! Hard edges inside UV islands.

use super::edges::{Edge, Edges};
use crate::math::Vec3;
use crate::mesh::Mesh;

/// The minimum cosine between two normals at one vertex that count as equal: that of 15°.
const ALIKE: f32 = 0.966;

/// The length of a mesh's edges, and its hard edges inside UV islands.
pub(crate) struct HardEdges {
    /// Both ends of each hard edge inside an island.
    pub inside: Vec<[Vec3<f64>; 2]>,
    /// The length of all edges between two triangles, in model units.
    pub length: f64,
}

impl HardEdges {
    /// Finds edges at which normals differ by more than 15° while the first uvs are continuous. A mesh without
    /// normals or uvs has none.
    pub fn inside_islands(mesh: &Mesh) -> Self {
        let mut found = Self { inside: Vec::new(), length: 0.0 };
        let (normals, [uvs, ..]) = (mesh.normals(), mesh.uvs()) else { return found };
        if normals.is_empty() {
            return found;
        }
        let edges = Edges::of(mesh);
        for edge in edges.iter() {
            let ends = vertices(mesh, &edges, edge);
            let positions = ends.map(|[one, _]| mesh.positions()[one].to_f64());
            found.length += (positions[1] - positions[0]).length();
            let goes_on = ends.iter().all(|[one, other]| uvs[*one] == uvs[*other]);
            let parts = ends.iter().any(|[one, other]| normals[*one].dot(normals[*other]) < ALIKE);
            if goes_on && parts {
                found.inside.push(positions);
            }
        }
        found
    }
}

/// Returns the vertices of both triangles at each end of an edge.
fn vertices(mesh: &Mesh, edges: &Edges, edge: Edge) -> [[usize; 2]; 2] {
    let own = mesh.triangles()[edge.triangle];
    let others = mesh.triangles()[edge.other];
    [edge.side, (edge.side + 1) % 3].map(|k| {
        let place = edges.places.of[own[k] as usize];
        let other = others.into_iter().find(|v| edges.places.of[*v as usize] == place);
        [own[k], other.unwrap_or(own[k])].map(|v| v as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::mesh::MeshData;

    /// Two squares that meet at a right angle, with the normals of each, and uvs that are continuous or cut between
    /// them.
    fn fold(normals: [Vec3; 2], cut: f32) -> Mesh {
        let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let squares = [
            [p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(1.0, 1.0, 0.0), p(0.0, 1.0, 0.0)],
            [p(1.0, 0.0, 0.0), p(1.0, 0.0, -1.0), p(1.0, 1.0, -1.0), p(1.0, 1.0, 0.0)],
        ];
        let uv = |u: f32, v: f32| Vec2::new(u, v);
        let uvs =
            |start: f32| [uv(start, 0.0), uv(start + 0.25, 0.0), uv(start + 0.25, 0.25), uv(start, 0.25)];
        let data = MeshData {
            positions: squares.concat(),
            normals: [[normals[0]; 4], [normals[1]; 4]].concat(),
            uvs: vec![[uvs(0.0), uvs(0.25 + cut)].concat()],
            triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
            ..MeshData::default()
        };
        Mesh::new(data).unwrap()
    }

    #[test]
    fn hard_edges_count_where_uvs_go_on() {
        let (up, right) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0));
        let count = |mesh: &Mesh| HardEdges::inside_islands(mesh).inside.len();
        let hard = HardEdges::inside_islands(&fold([up, right], 0.0));
        assert_eq!(hard.inside, [[Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0)]]);
        assert!((hard.length - (1.0 + 2.0 * 2.0f64.sqrt())).abs() < 1e-6, "{}", hard.length);
        assert_eq!(count(&fold([up, right], 0.25)), 0, "an island ends there");
        let between = (up + right).normalize();
        assert_eq!(count(&fold([between, between], 0.0)), 0, "smooth");
    }
}
