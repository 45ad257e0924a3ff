//! Collects vertices and triangles and makes a mesh with smooth normals from them.

use super::normals::vertex_normals;
use taotie::math::{Vec2, Vec3};
use taotie::mesh::{Mesh, MeshData};

/// A group of faces that share their normals: two vertices at the same place do so where their group is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Smooth(pub u32);

/// The group that stands for a round surface.
pub(super) const ROUND: Smooth = Smooth(0);

/// A mesh in the making.
///
/// No UV island of the atlas is mirrored, so a triangle's orientation follows from its uvs and nobody needs to
/// think about the order of its corners.
#[derive(Debug, Default)]
pub(super) struct Builder {
    positions: Vec<Vec3<f64>>,
    uvs: Vec<Vec2<f64>>,
    groups: Vec<u32>,
    triangles: Vec<[usize; 3]>,
    /// Triangles from here on in `hidden` close a part inside another and shape no normals.
    hidden: Vec<[usize; 3]>,
}

impl Builder {
    /// Adds a vertex and gives its index. Metres; uv origin top left.
    pub fn vertex(&mut self, position: Vec3<f64>, uv: Vec2<f64>, group: Smooth) -> usize {
        self.positions.push(position);
        self.uvs.push(uv);
        self.groups.push(group.0);
        self.positions.len() - 1
    }

    /// The place of a vertex in the atlas.
    pub fn uv(&self, vertex: usize) -> Vec2<f64> {
        self.uvs[vertex]
    }

    /// Adds a triangle, its corners in any order.
    pub fn triangle(&mut self, corners: [usize; 3]) {
        let corners = self.oriented(corners);
        self.triangles.push(corners);
    }

    /// Adds a triangle that lies inside another part.
    pub fn hidden_triangle(&mut self, corners: [usize; 3]) {
        let corners = self.oriented(corners);
        self.hidden.push(corners);
    }

    /// Adds two triangles for the corners of a quadrilateral in order around it, split along its shorter diagonal.
    /// Of equal diagonals the one from the first corner is taken where `first` holds.
    pub fn quad(&mut self, [a, b, c, d]: [usize; 4], first: bool) {
        let length = |i: usize, j: usize| (self.positions[i] - self.positions[j]).length();
        let (ac, bd) = (length(a, c), length(b, d));
        let tie = (ac - bd).abs() < 1e-6;
        if (tie && first) || (!tie && ac < bd) {
            self.triangle([a, b, c]);
            self.triangle([a, c, d]);
        } else {
            self.triangle([a, b, d]);
            self.triangle([b, c, d]);
        }
    }

    fn oriented(&self, [a, b, c]: [usize; 3]) -> [usize; 3] {
        let (p, q, r) = (self.uvs[a], self.uvs[b], self.uvs[c]);
        // v points down, so what is counter-clockwise in the picture has a negative determinant.
        let det = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        if det < 0.0 { [a, b, c] } else { [a, c, b] }
    }

    /// The mesh, with smooth normals within each group.
    pub fn finish(self) -> Mesh {
        let normals = self.normals();
        let triangles = self.triangles.iter().chain(&self.hidden).map(|t| t.map(|i| i as u32)).collect();
        let data = MeshData {
            positions: self.positions.iter().map(|p| p.to_f32()).collect(),
            normals: normals.iter().map(|n| n.to_f32()).collect(),
            uvs: vec![self.uvs.iter().map(|uv| Vec2::new(uv.x as f32, uv.y as f32)).collect()],
            triangles,
            ..MeshData::default()
        };
        Mesh::new(data).expect("every index comes from `vertex` and every number is finite")
    }

    /// Seams are welded for this, so that UV islands do not show.
    fn normals(&self) -> Vec<Vec3<f64>> {
        let leaders: Vec<usize> = (0..self.positions.len()).map(|i| self.leader(i)).collect();
        let welded: Vec<[usize; 3]> = self.triangles.iter().map(|t| t.map(|i| leaders[i])).collect();
        let normals = vertex_normals(&self.positions, &welded, |i| self.groups[i] == ROUND.0);
        leaders.iter().map(|leader| normals[*leader]).collect()
    }

    /// The first vertex at the same place in the same group.
    fn leader(&self, i: usize) -> usize {
        (0..i)
            .find(|j| self.groups[*j] == self.groups[i] && self.positions[*j] == self.positions[i])
            .unwrap_or(i)
    }
}
