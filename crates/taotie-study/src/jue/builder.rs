//! Collects vertices and triangles and builds a mesh with smooth normals from them.

use super::normals::vertex_normals;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};

/// A smoothing group: vertices at the same position share their normal if they are in the same group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Smooth(pub u32);

/// The group for round surfaces.
pub(super) const ROUND: Smooth = Smooth(0);

/// A mesh under construction.
///
/// No UV island of the atlas is mirrored, so a triangle's orientation follows from its uvs and its corners can be
/// given in any order.
#[derive(Debug, Default)]
pub(super) struct Builder {
    positions: Vec<Vec3<f64>>,
    uvs: Vec<Vec2<f64>>,
    groups: Vec<u32>,
    triangles: Vec<[usize; 3]>,
    /// Triangles that close a part inside another one and do not affect normals.
    hidden: Vec<[usize; 3]>,
}

impl Builder {
    /// Adds a vertex and returns its index. Metres; uv origin top left.
    pub fn vertex(&mut self, position: Vec3<f64>, uv: Vec2<f64>, group: Smooth) -> usize {
        self.positions.push(position);
        self.uvs.push(uv);
        self.groups.push(group.0);
        self.positions.len() - 1
    }

    /// Returns the uv of a vertex.
    pub fn uv(&self, vertex: usize) -> Vec2<f64> {
        self.uvs[vertex]
    }

    /// Adds a triangle, with its corners in any order.
    pub fn triangle(&mut self, corners: [usize; 3]) {
        let corners = self.oriented(corners);
        self.triangles.push(corners);
    }

    /// Adds a triangle that lies inside another part.
    pub fn hidden_triangle(&mut self, corners: [usize; 3]) {
        let corners = self.oriented(corners);
        self.hidden.push(corners);
    }

    /// Adds two triangles for a quadrilateral with corners in order around it, split along the shorter diagonal. If
    /// both are equal, `first` selects the diagonal from the first corner.
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
        // v points down, so counter-clockwise triangles have a negative determinant.
        let det = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        if det < 0.0 { [a, b, c] } else { [a, c, b] }
    }

    /// Returns the mesh, with smooth normals within each group.
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
        Mesh::new(data).expect("all indices come from `vertex` and all numbers are finite")
    }

    /// Returns the normals. Seams are welded, so that UV islands do not show.
    fn normals(&self) -> Vec<Vec3<f64>> {
        let leaders: Vec<usize> = (0..self.positions.len()).map(|i| self.leader(i)).collect();
        let welded: Vec<[usize; 3]> = self.triangles.iter().map(|t| t.map(|i| leaders[i])).collect();
        let normals = vertex_normals(&self.positions, &welded, |i| self.groups[i] == ROUND.0);
        leaders.iter().map(|leader| normals[*leader]).collect()
    }

    /// Returns the first vertex at the same position in the same group.
    fn leader(&self, i: usize) -> usize {
        (0..i)
            .find(|j| self.groups[*j] == self.groups[i] && self.positions[*j] == self.positions[i])
            .unwrap_or(i)
    }
}
