//! Vertex normals that make a coarse mesh shade like the round surface it represents.

use taotie_engine::math::{Vec3, scalar};

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
pub(super) fn vertex_normals(
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
