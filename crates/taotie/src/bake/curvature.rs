//! The curvature of a surface.

use crate::math::Vec3;
use crate::mesh::Mesh;

/// Returns the mean curvature at each vertex, in 1 / model units: above 0 if the surface bulges, 1/r on a sphere of
/// radius r.
///
/// Each edge measures how its ends' normals diverge over its length, (n_j − n_i)·(p_j − p_i) / |p_j − p_i|²; a vertex
/// gets the mean over the edges of its triangles.
/// Source: Rusinkiewicz 2004, "Estimating curvatures and their derivatives on triangle meshes", eq. 4, along edges.
pub(super) fn mean_curvatures(mesh: &Mesh) -> Vec<f32> {
    let mut sums = vec![(0.0f32, 0u32); mesh.positions().len()];
    let bend = |i: u32, k: u32| {
        let [a, b] = [i, k].map(|v| mesh.positions()[v as usize]);
        let [m, n] = [i, k].map(|v| mesh.normals()[v as usize]);
        let edge: Vec3 = b - a;
        let squared = edge.dot(edge);
        (squared > 0.0).then(|| (n - m).dot(edge) / squared)
    };
    for [a, b, c] in mesh.triangles() {
        for [i, k] in [[*a, *b], [*b, *c], [*c, *a]] {
            for (v, bend) in [i, k].into_iter().zip(bend(i, k).into_iter().cycle()) {
                let (sum, count) = &mut sums[v as usize];
                *sum += bend;
                *count += 1;
            }
        }
    }
    sums.into_iter().map(|(sum, count)| if count == 0 { 0.0 } else { sum / count as f32 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

    #[test]
    fn a_sphere_bends_by_one_over_its_radius_and_inside_out_by_as_much_less() {
        let sphere = Mesh::sphere(1.0, 64, 32);
        let radius = 2.5;
        let scaled = |sign: f32| {
            let data = sphere.clone().into_data();
            Mesh::new(MeshData {
                positions: data.positions.iter().map(|p| *p * radius).collect(),
                normals: data.normals.iter().map(|n| *n * sign).collect(),
                tangents: Vec::new(),
                ..data
            })
            .unwrap()
        };
        for sign in [1.0, -1.0] {
            let sphere = scaled(sign);
            let curvatures = mean_curvatures(&sphere);
            for v in sphere.triangles().as_flattened() {
                let curvature = curvatures[*v as usize];
                assert!((curvature * radius * sign - 1.0).abs() < 1e-3, "{curvature}");
            }
        }
    }
}
