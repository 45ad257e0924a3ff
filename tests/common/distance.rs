//! Distances of points from a surface: exact, using a grid of cells rather than the library's own rays.
use std::collections::HashMap;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;

type Cell = [i64; 3];

/// The triangles of a mesh, sorted into cells of a grid.
pub struct Surface {
    corners: Vec<[Vec3<f64>; 3]>,
    cells: HashMap<Cell, Vec<u32>>,
    side: f64,
    /// The largest distance between two cells.
    reach: i64,
}

impl Surface {
    pub fn new(mesh: &Mesh) -> Self {
        let corners: Vec<_> =
            (0..mesh.triangles().len()).map(|t| mesh.corners(t).map(Vec3::to_f64)).collect();
        let side = mesh.diagonal() / (corners.len() as f64).sqrt().clamp(4.0, 200.0);
        let mut cells: HashMap<Cell, Vec<u32>> = HashMap::new();
        for (t, triangle) in corners.iter().enumerate() {
            let [low, high] = [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| {
                triangle[1..]
                    .iter()
                    .fold(triangle[0], |a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
            });
            let (low, high) = (cell(low, side), cell(high, side));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        cells.entry([x, y, z]).or_default().push(t as u32);
                    }
                }
            }
        }
        Self { corners, cells, side, reach: 1000 }
    }

    /// Returns the distance of a point from the nearest triangle.
    pub fn distance(&self, point: Vec3) -> f64 {
        let (point, mut best) = (point.to_f64(), f64::INFINITY);
        let [x, y, z] = cell(point, self.side);
        for shell in 0..self.reach {
            // All cells of this shell are at least this far away.
            if best <= (shell - 1).max(0) as f64 * self.side {
                break;
            }
            for dx in -shell..=shell {
                for dy in -shell..=shell {
                    let on_side = dx.abs() == shell || dy.abs() == shell;
                    let step = if on_side || shell == 0 { 1 } else { 2 * shell as usize };
                    for dz in (-shell..=shell).step_by(step) {
                        for t in self.cells.get(&[x + dx, y + dy, z + dz]).into_iter().flatten() {
                            best = best.min(to_triangle(point, self.corners[*t as usize]));
                        }
                    }
                }
            }
        }
        best
    }
}

/// Returns the mean and maximum distance of every `step`-th vertex of `from` to `to`, as fractions of the diagonal of
/// `from`.
pub fn deviation(from: &Mesh, to: &Mesh, step: usize) -> [f64; 2] {
    let (surface, diagonal) = (Surface::new(to), from.diagonal());
    let far: Vec<f64> =
        from.positions().iter().step_by(step.max(1)).map(|p| surface.distance(*p) / diagonal).collect();
    [far.iter().sum::<f64>() / far.len() as f64, far.iter().copied().fold(0.0, f64::max)]
}

fn cell(point: Vec3<f64>, side: f64) -> Cell {
    point.to_array().map(|v| (v / side).floor() as i64)
}

/// Returns the distance of a point from a triangle: from its plane if the foot is inside, otherwise from its nearest
/// edge.
fn to_triangle(p: Vec3<f64>, [a, b, c]: [Vec3<f64>; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |p: Vec3<f64>, q: Vec3<f64>, foot: Vec3<f64>| (q - p).cross(foot - p).dot(normal) >= 0.0;
    if normal.length() > 0.0 && inside(a, b, p) && inside(b, c, p) && inside(c, a, p) {
        return ((p - a).dot(normal) / normal.length()).abs();
    }
    to_edge(p, a, b).min(to_edge(p, b, c)).min(to_edge(p, c, a))
}

fn to_edge(p: Vec3<f64>, a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let d = b - a;
    let along = if d.dot(d) > 0.0 { ((p - a).dot(d) / d.dot(d)).clamp(0.0, 1.0) } else { 0.0 };
    (p - a - d * along).length()
}
