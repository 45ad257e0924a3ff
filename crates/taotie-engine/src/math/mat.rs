//! Affine and projective transforms for set-up code, in double precision, for column vectors.

use super::{Vec3, scalar};
use std::ops::Mul;

/// A 4×4 matrix for column vectors; `a_from_b * b_from_c` maps c to a. `columns[j][i]` is row i of column j.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Mat4 {
    /// The columns.
    pub columns: [[f64; 4]; 4],
}

impl Default for Mat4 {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Mat4 {
    /// The identity.
    pub const IDENTITY: Self = Self {
        columns: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    };

    /// A translation by `offset`.
    pub fn translation(offset: Vec3<f64>) -> Self {
        let mut m = Self::IDENTITY;
        m.columns[3] = [offset.x, offset.y, offset.z, 1.0];
        m
    }

    /// A scale of each axis.
    pub fn scale(factors: Vec3<f64>) -> Self {
        let mut m = Self::IDENTITY;
        m.columns[0][0] = factors.x;
        m.columns[1][1] = factors.y;
        m.columns[2][2] = factors.z;
        m
    }

    /// A rotation by the unit quaternion (x, y, z, w).
    pub fn rotation([x, y, z, w]: [f64; 4]) -> Self {
        let mut m = Self::IDENTITY;
        m.columns[0] = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0];
        m.columns[1] = [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0];
        m.columns[2] = [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0];
        m
    }

    /// A rotation about the unit `axis` by `angle` radians, right-handed.
    pub fn rotation_about(axis: Vec3<f64>, angle: f64) -> Self {
        let (s, c) = (scalar::sin(angle / 2.0), scalar::cos(angle / 2.0));
        Self::rotation([axis.x * s, axis.y * s, axis.z * s, c])
    }

    /// A rigid transform from orthonormal axes and an origin.
    pub fn from_axes(x: Vec3<f64>, y: Vec3<f64>, z: Vec3<f64>, origin: Vec3<f64>) -> Self {
        Self {
            columns: [
                [x.x, x.y, x.z, 0.0],
                [y.x, y.y, y.z, 0.0],
                [z.x, z.y, z.z, 0.0],
                [origin.x, origin.y, origin.z, 1.0],
            ],
        }
    }

    /// Column `j` without its last entry.
    pub fn axis(&self, j: usize) -> Vec3<f64> {
        let [x, y, z, _] = self.columns[j];
        Vec3::new(x, y, z)
    }

    /// The image of a point in homogeneous coordinates.
    #[inline]
    pub fn transform_homogeneous(&self, p: Vec3<f64>) -> [f64; 4] {
        let [a, b, c, d] = &self.columns;
        std::array::from_fn(|i| a[i] * p.x + b[i] * p.y + c[i] * p.z + d[i])
    }

    /// The image of a point under an affine transform.
    #[inline]
    pub fn transform_point(&self, p: Vec3<f64>) -> Vec3<f64> {
        let [x, y, z, _] = self.transform_homogeneous(p);
        Vec3::new(x, y, z)
    }

    /// The image of a direction: no translation.
    #[inline]
    pub fn transform_vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        self.axis(0) * v.x + self.axis(1) * v.y + self.axis(2) * v.z
    }

    /// The determinant of the upper 3×3 part; negative if the transform mirrors.
    pub fn determinant3(&self) -> f64 {
        self.axis(0).dot(self.axis(1).cross(self.axis(2)))
    }

    /// The matrix that transforms normals: the cofactors of the upper 3×3 part, which is its inverse transpose times
    /// the determinant. It exists for singular transforms and keeps normals on their side under mirroring.
    pub fn normal_matrix(&self) -> Self {
        let (x, y, z) = (self.axis(0), self.axis(1), self.axis(2));
        let sign = if self.determinant3() < 0.0 { -1.0 } else { 1.0 };
        Self::from_axes(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign, Vec3::new(0.0, 0.0, 0.0))
    }

    /// The inverse of an affine transform, or `None` if the upper 3×3 part is singular.
    pub fn inverse_affine(&self) -> Option<Self> {
        let (x, y, z) = (self.axis(0), self.axis(1), self.axis(2));
        let det = self.determinant3();
        if det == 0.0 || !det.is_finite() {
            return None;
        }
        let rows = [y.cross(z) / det, z.cross(x) / det, x.cross(y) / det];
        let column = |j: usize| rows.map(|r| r.to_array()[j]);
        let mut inverse = Self::IDENTITY;
        for j in 0..3 {
            let [a, b, c] = column(j);
            inverse.columns[j] = [a, b, c, 0.0];
        }
        let t = inverse.transform_vector(self.axis(3));
        inverse.columns[3] = [-t.x, -t.y, -t.z, 1.0];
        Some(inverse)
    }

    /// Returns true if all entries are finite, neither infinite nor NaN.
    pub fn is_finite(&self) -> bool {
        self.columns.iter().flatten().all(|v| v.is_finite())
    }
}

impl Mul for Mat4 {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let columns = o.columns.map(|c| {
            std::array::from_fn(|i| {
                self.columns[0][i] * c[0]
                    + self.columns[1][i] * c[1]
                    + self.columns[2][i] * c[2]
                    + self.columns[3][i] * c[3]
            })
        });
        Self { columns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes() {
        let m = Mat4::translation(Vec3::new(1.0, -2.0, 3.0))
            * Mat4::rotation_about(Vec3::new(0.0, 0.6, 0.8), 0.7)
            * Mat4::scale(Vec3::new(2.0, -0.5, 3.0));
        let p = Vec3::new(0.3, 0.4, -0.9);
        let q = m.inverse_affine().unwrap().transform_point(m.transform_point(p));
        assert!((p - q).length() < 1e-12);
    }

    #[test]
    fn normals_stay_perpendicular_and_on_their_side() {
        let m = Mat4::scale(Vec3::new(1.0, 2.0, -4.0));
        let (t, n) = (Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, -1.0, 0.0));
        let n_world = m.normal_matrix().transform_vector(n);
        assert!(m.transform_vector(t).dot(n_world).abs() < 1e-12);
        assert!(n_world.x > 0.0);
    }
}
