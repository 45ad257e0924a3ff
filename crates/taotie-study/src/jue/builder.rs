//! Collects vertices and triangles and builds a mesh from them, with vertex normals that make a coarse mesh shade
//! like the round surface it represents.

use taotie_engine::math::{Vec2, Vec3, scalar};
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

/// The weight of the mean face normal relative to one edge.
const HOLD: f64 = 0.8;
/// The number of sweeps over all vertices; the last ones make no significant difference.
const SWEEPS: usize = 60;

/// Returns one normal for each vertex of a mesh without seams.
///
/// Where curvature changes, the angle-weighted mean of the faces around a vertex leans towards the more strongly
/// curved side. On a smooth curve, the normals at an edge's ends lean equally to both sides: (n_a + n_b) · d = 0 for
/// the edge's direction d, exactly so on a circle. So the sum of the squares of these products is minimised while
/// normals stay close to their means.
///
/// Vertices that are not `round` keep their means, since limbs with few sides have no such curve to follow.
fn vertex_normals(
    positions: &[Vec3<f64>],
    triangles: &[[usize; 3]],
    round: impl Fn(usize) -> bool,
) -> Vec<Vec3<f64>> {
    let means = means(positions, triangles);
    let edges = edges(positions, triangles);
    let mut normals = means.clone();
    for _ in 0..SWEEPS {
        for i in (0..means.len()).filter(|i| round(*i)) {
            normals[i] = settled(means[i], &edges[i], &normals);
        }
    }
    normals
}

/// Returns the directions of the edges at each vertex, with their other vertices.
fn edges(positions: &[Vec3<f64>], triangles: &[[usize; 3]]) -> Vec<Vec<(usize, Vec3<f64>)>> {
    let mut edges: Vec<Vec<(usize, Vec3<f64>)>> = vec![Vec::new(); positions.len()];
    for t in triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            for (from, to) in [(a, b), (b, a)] {
                if edges[from].iter().all(|(other, _)| *other != to) {
                    edges[from].push((to, (positions[to] - positions[from]).normalize()));
                }
            }
        }
    }
    edges
}

/// Returns the angle-weighted means of the face normals.
fn means(positions: &[Vec3<f64>], triangles: &[[usize; 3]]) -> Vec<Vec3<f64>> {
    let mut sums = vec![Vec3::splat(0.0); positions.len()];
    for triangle in triangles {
        let [p, q, r] = triangle.map(|i| positions[i]);
        let n = (q - p).cross(r - p).normalize();
        for (corner, angle) in triangle.iter().zip(corner_angles([p, q, r])) {
            sums[*corner] += n * angle;
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::new(0.0, 1.0, 0.0))).collect()
}

/// Returns the best normal of one vertex with the others fixed: (HOLD + Σ d dᵀ) n = HOLD · mean − Σ d (d · n_other).
fn settled(mean: Vec3<f64>, edges: &[(usize, Vec3<f64>)], normals: &[Vec3<f64>]) -> Vec3<f64> {
    let mut rows = [Vec3::new(HOLD, 0.0, 0.0), Vec3::new(0.0, HOLD, 0.0), Vec3::new(0.0, 0.0, HOLD)];
    let mut right = mean * HOLD;
    for (other, d) in edges {
        rows[0] += *d * d.x;
        rows[1] += *d * d.y;
        rows[2] += *d * d.z;
        right += *d * -d.dot(normals[*other]);
    }
    let [x, y, z] = rows;
    let solution = y.cross(z) * right.x + z.cross(x) * right.y + x.cross(y) * right.z;
    solution.normalize_or(mean)
}

/// Returns the angles of a triangle, radians.
fn corner_angles(corners: [Vec3<f64>; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (p, q, r) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
        scalar::acos((q - p).normalize().dot((r - p).normalize()).clamp(-1.0, 1.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A band around an ellipse with half axes 2 and 1 and unevenly spaced columns.
    #[test]
    fn normals_of_a_coarse_oval_come_closer_to_the_oval() {
        const COLUMNS: usize = 12;
        let angle = |i: usize| {
            let t = std::f64::consts::TAU * (i % COLUMNS) as f64 / COLUMNS as f64;
            t + 0.25 * scalar::sin(t)
        };
        let positions: Vec<_> = (0..2 * COLUMNS)
            .map(|i| Vec3::new(2.0 * scalar::cos(angle(i / 2)), -scalar::sin(angle(i / 2)), (i % 2) as f64))
            .collect();
        let triangles: Vec<[usize; 3]> = (0..COLUMNS)
            .map(|i| (2 * i, 2 * ((i + 1) % COLUMNS)))
            .flat_map(|(a, b)| [[a, a + 1, b + 1], [a, b + 1, b]])
            .collect();
        let error = |normals: &[Vec3<f64>]| -> f64 {
            let off = |(n, p): (&Vec3<f64>, &Vec3<f64>)| {
                n.cross(Vec3::new(p.x / 4.0, p.y, 0.0).normalize()).length()
            };
            normals.iter().zip(&positions).map(off).sum()
        };
        let (plain, ours) = (means(&positions, &triangles), vertex_normals(&positions, &triangles, |_| true));
        assert!(error(&ours) < error(&plain), "{} against {}", error(&ours), error(&plain));
    }
}
