//! The low mesh rounded by its normals, without relief.

use super::curves::curves;
use super::patch::Patch;
use super::welds::Welds;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::Mesh;

/// The low mesh rounded, without relief.
pub(super) struct Rounded<'a> {
    mesh: &'a Mesh,
    /// A patch for each triangle.
    pub patches: Vec<Patch<'a>>,
}

/// Half the step, in weights, over which the rounded mesh is differentiated.
const STEP: f64 = 1e-4;

impl<'a> Rounded<'a> {
    /// Computes the curves of all edges first, since neighbours share them.
    pub fn new(mesh: &'a Mesh, welds: &'a Welds) -> Self {
        let all = curves(mesh, welds);
        let patch = |corners: &[u32; 3]| {
            let curve = |i: usize| all[&welds.edge(corners[i], corners[(i + 1) % 3])];
            Patch { mesh, welds, corners: *corners, curves: std::array::from_fn(curve) }
        };
        Self { mesh, patches: mesh.triangles().iter().map(patch).collect() }
    }

    /// Returns the weights of a triangle's corners at a uv, clamped to the triangle.
    pub fn weights(&self, triangle: usize, uv: Vec2<f64>) -> [f64; 3] {
        let [e, f, a] = self.edges(triangle);
        let g = uv - a;
        let det = e.x * f.y - e.y * f.x;
        let w = [(g.x * f.y - g.y * f.x) / det, (e.x * g.y - e.y * g.x) / det];
        let w = [1.0 - w[0] - w[1], w[0], w[1]].map(|w| w.max(0.0));
        let sum: f64 = w.iter().sum();
        w.map(|w| w / sum)
    }

    /// Returns the derivatives of the position by u and v at a point of a triangle.
    pub fn by_uv(&self, triangle: usize, w: [f64; 3]) -> [Vec3<f64>; 2] {
        let patch = &self.patches[triangle];
        let middle = patch.middle();
        let [e, f, _] = self.edges(triangle);
        let det = e.x * f.y - e.y * f.x;
        // Derivatives of the weights of the second and third corner by u, and by v.
        [[f.y / det, -e.y / det], [-f.x / det, e.x / det]].map(|[by_b, by_c]| {
            let size = by_b.abs().max(by_c.abs());
            let moved = |k: f64| {
                let (db, dc) = (by_b / size * k, by_c / size * k);
                patch.inside([w[0] - db - dc, w[1] + db, w[2] + dc], middle).position
            };
            (moved(STEP) - moved(-STEP)) * (size / (2.0 * STEP))
        })
    }

    /// Returns the edges of a triangle from its first corner, and that corner, in uvs.
    fn edges(&self, triangle: usize) -> [Vec2<f64>; 3] {
        let [a, b, c] = self.patches[triangle].corners.map(|i| {
            let uv = self.mesh.uvs()[0][i as usize];
            Vec2::new(f64::from(uv.x), f64::from(uv.y))
        });
        [b - a, c - a, a]
    }
}
