//! The edges of meshes: how many faces meet at each, and at what angle.

use super::check::{Check, CheckResult};
use super::schema::ModelSchema;
use super::words::counted;
use crate::groups::Groups;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use crate::scene::Scene;
use crate::surface::by_position;

/// The cosine at which faces meet at 90° or more, with two thousandths of a degree for rounding.
const RIGHT_ANGLE: f64 = 3e-5;

const NOT_REQUIRED: &str = "not required";

/// The edges of a mesh that a check counts. Vertices at bit-identical positions count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Edges {
    /// Edges of two faces whose normals are 90° or more apart.
    hard: usize,
    /// Edges of more than two faces.
    non_manifold: usize,
    /// Edges of one face.
    open: usize,
}

/// Checks the edges of all meshes, if the schema asks.
pub(super) fn results(scene: &Scene, schema: &ModelSchema) -> Vec<CheckResult> {
    let (beveled, manifold) = (schema.require_beveled_edges, schema.require_manifold_edges);
    let mut all = Edges::default();
    if beveled || manifold {
        scene.meshes().iter().for_each(|mesh| all.add(Edges::of(mesh)));
    }
    let hard = format!("{} of 90° or more (at most 0)", counted(all.hard, "hard edge"));
    let crowded = counted(all.non_manifold, "edge");
    let crowded = format!("{crowded} of more than two faces (at most 0), {} open", counted(all.open, "edge"));
    let result = |check, required: bool, faults: usize, what: String| match required {
        true => CheckResult::of_faults(check, faults, what),
        false => CheckResult::not_tested(check, NOT_REQUIRED),
    };
    vec![
        result(Check::BeveledEdges, beveled, all.hard, hard),
        result(Check::ManifoldEdges, manifold, all.non_manifold, crowded),
    ]
}

impl Edges {
    fn of(mesh: &Mesh) -> Self {
        let places = by_position(mesh.positions());
        // Each edge with its triangle, grouped by the lower of the two positions that it joins.
        let entries = || {
            mesh.triangles().iter().enumerate().flat_map(|(triangle, corners)| {
                let [a, b, c] = corners.map(|corner| places.of[corner as usize]);
                let collapsed = a == b || b == c || c == a;
                let edges = [(a, b), (b, c), (c, a)].into_iter().filter(move |_| !collapsed);
                edges.map(move |(p, q)| (p.min(q) as usize, (p.max(q), triangle as u32)))
            })
        };
        let edges = Groups::new(places.firsts.len(), entries);
        let sums = parallel::fold(edges.len(), |sum: &mut Self, place| {
            let mut from_here = edges.of(place).to_vec();
            from_here.sort_unstable();
            for edge in from_here.chunk_by(|a, b| a.0 == b.0) {
                sum.count(mesh, edge);
            }
        });
        let mut all = Self::default();
        sums.into_iter().for_each(|sum| all.add(sum));
        all
    }

    /// Counts an edge with its faces.
    fn count(&mut self, mesh: &Mesh, faces: &[(u32, u32)]) {
        match faces {
            [_] => self.open += 1,
            [(_, one), (_, other)] => self.hard += usize::from(is_hard(mesh, [*one, *other])),
            _ => self.non_manifold += 1,
        }
    }

    fn add(&mut self, other: Self) {
        self.hard += other.hard;
        self.non_manifold += other.non_manifold;
        self.open += other.open;
    }
}

/// Returns true if the normals of two faces are 90° or more apart. Faces without area have none.
fn is_hard(mesh: &Mesh, faces: [u32; 2]) -> bool {
    let [n, m]: [Vec3<f64>; 2] = faces.map(|face| {
        let [a, b, c] = mesh.corners(face as usize).map(Vec3::to_f64);
        (b - a).cross(c - a)
    });
    let lengths = n.length() * m.length();
    lengths > 0.0 && n.dot(m) <= RIGHT_ANGLE * lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

    fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        let positions = positions.iter().map(|p| Vec3::from_array(*p)).collect();
        Mesh::new(MeshData { positions, triangles: triangles.to_vec(), ..MeshData::default() }).unwrap()
    }

    /// Two faces sharing the edge from 0 to 1, the second one rotated out of the plane of the first by an angle.
    fn folded(cosine: f32, sine: f32) -> Edges {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -cosine, -sine]];
        Edges::of(&mesh(&corners, &[[0, 1, 2], [1, 0, 3]]))
    }

    #[test]
    fn edges_are_hard_from_a_right_angle_on() {
        assert_eq!(folded(1.0, 0.0), Edges { hard: 0, non_manifold: 0, open: 4 });
        assert_eq!(folded(0.0175, 0.9998).hard, 0, "89 degrees");
        assert_eq!(folded(0.0, 1.0).hard, 1, "90 degrees");
        assert_eq!(folded(-0.8, 0.6).hard, 1);
    }

    /// A corner that is stored twice, with two uvs, is one position.
    #[test]
    fn vertices_at_the_same_place_are_one() {
        let corners =
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let split = Edges::of(&mesh(&corners, &[[0, 1, 2], [4, 3, 5]]));
        assert_eq!(split, Edges { hard: 1, non_manifold: 0, open: 4 });
        let third = [&corners[..], &[[0.0, -1.0, 0.0]]].concat();
        let crowded = Edges::of(&mesh(&third, &[[0, 1, 2], [4, 3, 5], [1, 0, 6]]));
        assert_eq!(crowded, Edges { hard: 0, non_manifold: 1, open: 6 });
    }

    #[test]
    fn collapsed_triangles_have_no_edges() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]];
        assert_eq!(Edges::of(&mesh(&corners, &[[0, 1, 2]])), Edges::default());
    }
}
