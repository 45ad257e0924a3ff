//! How the triangles of a mesh are connected: across their edges, and in UV islands, whose hard edges are found.

use super::weld::{self, Classes, bits};
use crate::groups::{DisjointSets, Groups};
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use std::sync::atomic::{AtomicU32, Ordering};

/// Marks a side without exactly one triangle across it.
const NONE: u32 = u32::MAX;

/// The neighbours of each triangle. Vertices at equal positions count as one.
///
/// Side k of a triangle runs from its corner k to the next one. Sides of one triangle or of more than two have no
/// neighbour; nor have those of triangles with two corners at one position.
pub(crate) struct Edges {
    /// The position index of each vertex.
    pub places: Classes,
    across: Vec<[u32; 3]>,
}

/// An edge shared by exactly two triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// One of the triangles.
    pub triangle: usize,
    /// The side of that triangle, 0 to 2.
    pub side: usize,
    /// The other triangle.
    pub other: usize,
}

impl Edges {
    /// Finds the neighbours in a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self::with_places(mesh, weld::by_position(mesh.positions()))
    }

    /// Finds the neighbours in a mesh, given its classes of vertices at equal positions.
    pub fn with_places(mesh: &Mesh, places: Classes) -> Self {
        let count = mesh.triangles().len();
        let ends = || (0..count).flat_map(|t| lower_ends(mesh, &places.of, t));
        let groups = Groups::new(places.firsts.len(), ends);
        let across: Vec<[AtomicU32; 3]> = (0..count).map(|_| [NONE; 3].map(AtomicU32::new)).collect();
        let link = |(triangle, side): (u32, u8), other: u32| {
            across[triangle as usize][usize::from(side)].store(other, Ordering::Relaxed);
        };
        parallel::fold(groups.count(), |sorted: &mut Vec<Side>, place| {
            sorted.clear();
            for triangle in groups.of(place) {
                let sides = sides_of(mesh, &places.of, *triangle);
                sorted.extend(sides.filter(|(lower, _)| *lower == place).map(|(_, side)| side));
            }
            sorted.sort_unstable();
            for run in sorted.chunk_by(|a, b| a.0 == b.0) {
                if let [(_, one, k), (_, other, l)] = *run {
                    link((one, k), other);
                    link((other, l), one);
                }
            }
        });
        drop(groups);
        let across = across.into_iter().map(|sides| sides.map(AtomicU32::into_inner)).collect();
        Self { places, across }
    }

    /// Returns the triangle across a side; `None` if there is not exactly one.
    pub fn across(&self, triangle: usize, side: usize) -> Option<usize> {
        let other = self.across[triangle][side];
        (other != NONE).then_some(other as usize)
    }

    /// Returns the edges of a triangle, with that triangle first, that it shares with exactly one other.
    pub fn around(&self, triangle: usize) -> impl Iterator<Item = Edge> + '_ {
        (0..3).filter_map(move |side| Some(Edge { triangle, side, other: self.across(triangle, side)? }))
    }

    /// Returns each edge shared by exactly two triangles once, in the order of triangles.
    pub fn iter(&self) -> impl Iterator<Item = Edge> + '_ {
        let all = (0..self.across.len()).flat_map(|triangle| self.around(triangle));
        all.filter(|edge| edge.triangle < edge.other)
    }

    /// Returns true if both triangles run along their edge in the same direction, so that they face opposite ways.
    pub fn is_reversed(&self, mesh: &Mesh, edge: Edge) -> bool {
        let ends = self.ends(mesh, edge);
        let corners = self.corners(mesh, edge.other);
        (0..3).any(|k| [corners[k], corners[(k + 1) % 3]] == ends)
    }

    /// Returns the position indices of both ends of an edge, in the direction of its first triangle.
    pub fn ends(&self, mesh: &Mesh, edge: Edge) -> [u32; 2] {
        let corners = self.corners(mesh, edge.triangle);
        [corners[edge.side], corners[(edge.side + 1) % 3]]
    }

    fn corners(&self, mesh: &Mesh, triangle: usize) -> [u32; 3] {
        mesh.triangles()[triangle].map(|v| self.places.of[v as usize])
    }
}

/// The higher position index of a side, its triangle, and the index of the side in it.
type Side = (u32, u32, u8);

/// Returns the sides of a triangle, each with its lower position index; none if two corners are at one position.
fn sides_of(mesh: &Mesh, places: &[u32], triangle: u32) -> impl Iterator<Item = (usize, Side)> {
    let [a, b, c] = mesh.triangles()[triangle as usize].map(|v| places[v as usize]);
    let is_whole = a != b && b != c && c != a;
    let side =
        move |(from, to, number): (u32, u32, u8)| (from.min(to) as usize, (from.max(to), triangle, number));
    [(a, b, 0), (b, c, 1), (c, a, 2)].into_iter().filter(move |_| is_whole).map(side)
}

/// Returns the lower position indices of the sides of a triangle, each once: the lowest has two sides, the highest none.
fn lower_ends(mesh: &Mesh, places: &[u32], triangle: usize) -> impl Iterator<Item = (usize, u32)> {
    let mut ends = mesh.triangles()[triangle].map(|v| places[v as usize]);
    ends.sort_unstable();
    let is_whole = ends[0] != ends[1] && ends[1] != ends[2];
    [ends[0], ends[1]].into_iter().filter(move |_| is_whole).map(move |end| (end as usize, triangle as u32))
}

/// Returns the UV island of each triangle, as a number shared by its triangles: those that meet at corners with the
/// same uvs. The mesh must have uvs.
pub fn uv_islands(mesh: &Mesh) -> Vec<u32> {
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

/// The minimum cosine between two normals at one vertex that count as equal: that of 15°.
const ALIKE: f32 = 0.966;

/// The length of a mesh's edges, and its hard edges inside UV islands.
pub struct HardEdges {
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

    #[test]
    fn neighbours_are_found_across_cuts_and_not_at_fins() {
        let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let positions = vec![
            p(0.0, 0.0, 0.0),
            p(1.0, 0.0, 0.0),
            p(0.0, 1.0, 0.0),
            p(1.0, 1.0, 0.0),
            // The second one again, as behind a cut.
            p(1.0, 0.0, 0.0),
            p(0.0, 0.0, 1.0),
        ];
        let mesh = |triangles: &[[u32; 3]]| {
            let data = MeshData {
                positions: positions.clone(),
                triangles: triangles.to_vec(),
                ..MeshData::default()
            };
            Mesh::new(data).unwrap()
        };
        let square = mesh(&[[0, 1, 2], [4, 3, 2], [0, 0, 1]]);
        let edges = Edges::of(&square);
        let found: Vec<Edge> = edges.iter().collect();
        assert_eq!(found, [Edge { triangle: 0, side: 1, other: 1 }]);
        assert_eq!(edges.across(1, 2), Some(0));
        assert!(!edges.is_reversed(&square, found[0]));
        assert_eq!(edges.ends(&square, found[0]), [1, 2]);
        let turned = mesh(&[[0, 1, 2], [3, 4, 2]]);
        let edges = Edges::of(&turned);
        assert!(edges.iter().all(|edge| edges.is_reversed(&turned, edge)) && edges.iter().count() == 1);
        let fin = mesh(&[[0, 1, 2], [4, 3, 2], [1, 2, 5]]);
        assert_eq!(Edges::of(&fin).iter().count(), 0, "three triangles meet there");
    }

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
