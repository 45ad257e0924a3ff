//! The sphere on which materials are shown and measured.

use super::{Mesh, MeshData};
use crate::math::{Vec2, Vec3, scalar};
use std::f64::consts::{PI, TAU};

impl Mesh {
    /// A sphere around the origin, with normals and one uv set: u runs once around from +z over +x, v from the top
    /// down.
    ///
    /// `radius` above 0, in model units; `columns` at least 3 around, `rows` at least 2 from pole to pole: smaller
    /// values are raised to these. It has 2 · `columns` · (`rows` − 1) triangles.
    pub fn sphere(radius: f64, columns: usize, rows: usize) -> Self {
        let (columns, rows) = (columns.max(3), rows.max(2));
        let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
        for j in 0..=rows {
            for i in 0..=columns {
                let (u, v) = (i as f64 / columns as f64, j as f64 / rows as f64);
                let (theta, phi) = (PI * v, TAU * u);
                let ring = scalar::sin(theta);
                let n = Vec3::new(ring * scalar::sin(phi), scalar::cos(theta), ring * scalar::cos(phi));
                data.positions.push((n * radius).to_f32());
                data.normals.push(n.to_f32());
                data.uvs[0].push(Vec2::new(u as f32, v as f32));
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let at = |di: usize, dj: usize| ((j + dj) * (columns + 1) + i + di) as u32;
                let [a, b, c, d] = [at(0, 0), at(0, 1), at(1, 1), at(1, 0)];
                if j > 0 {
                    data.triangles.push([a, b, d]);
                }
                if j + 1 < rows {
                    data.triangles.push([d, b, c]);
                }
            }
        }
        Self { data: data.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_a_valid_mesh_that_faces_outwards() {
        let sphere = Mesh::sphere(2.0, 12, 7);
        assert_eq!(sphere.triangles().len(), 2 * 12 * 6);
        Mesh::new(sphere.clone().into_data()).unwrap();
        for triangle in sphere.triangles() {
            let [a, b, c] = triangle.map(|v| sphere.positions()[v as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }
}
