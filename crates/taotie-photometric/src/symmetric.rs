//! Symmetric 3×3 and 2×2 matrices in double precision.

use taotie_engine::math::{Vec3, scalar};

/// A symmetric 3×3 matrix: xx, xy, xz, yy, yz, zz.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sym3(pub [f64; 6]);

impl Sym3 {
    /// Adds `weight` · v vᵀ.
    #[inline]
    pub fn add(&mut self, v: Vec3<f64>, weight: f64) {
        let [x, y, z] = [v.x * weight, v.y * weight, v.z * weight];
        let outer = [x * v.x, x * v.y, x * v.z, y * v.y, y * v.z, z * v.z];
        self.0.iter_mut().zip(outer).for_each(|(sum, v)| *sum += v);
    }

    /// Returns the matrix times a number.
    pub fn scaled(&self, factor: f64) -> Sym3 {
        Sym3(self.0.map(|v| v * factor))
    }

    /// Returns the sum of the diagonal.
    pub fn trace(&self) -> f64 {
        self.0[0] + self.0[3] + self.0[5]
    }

    /// Returns the inverse by cofactors; `None` if the matrix is singular to within rounding.
    pub fn inverse(&self) -> Option<Sym3> {
        let [a, b, c, d, e, f] = self.0;
        let cofactors =
            [d * f - e * e, c * e - b * f, b * e - c * d, a * f - c * c, b * c - a * e, a * d - b * b];
        let determinant = a * cofactors[0] + b * cofactors[1] + c * cofactors[2];
        let scale = a.abs().max(d.abs()).max(f.abs());
        let regular = determinant.abs() > 1e-10 * scale * scale * scale;
        regular.then(|| Sym3(cofactors.map(|v| v / determinant)))
    }

    /// Returns the product with a vector.
    #[inline]
    pub fn times(&self, v: Vec3<f64>) -> Vec3<f64> {
        let [a, b, c, d, e, f] = self.0;
        Vec3::new(a * v.x + b * v.y + c * v.z, b * v.x + d * v.y + e * v.z, c * v.x + e * v.y + f * v.z)
    }

    /// Returns the smallest eigenvalue, in closed form: Smith 1961, "Eigenvalues of a symmetric 3 × 3 matrix".
    pub fn least_eigenvalue(&self) -> f64 {
        let [a, b, c, d, e, f] = self.0;
        let mean = (a + d + f) / 3.0;
        let [a, d, f] = [a, d, f].map(|v| v - mean);
        let size = ((a * a + d * d + f * f + 2.0 * (b * b + c * c + e * e)) / 6.0).sqrt();
        if size == 0.0 {
            return mean;
        }
        let [a, b, c, d, e, f] = [a, b, c, d, e, f].map(|v| v / size);
        let determinant = a * (d * f - e * e) + b * (c * e - b * f) + c * (b * e - c * d);
        let angle = scalar::acos((0.5 * determinant).clamp(-1.0, 1.0)) / 3.0;
        mean + 2.0 * size * scalar::cos(angle + std::f64::consts::TAU / 3.0)
    }
}

/// A symmetric 2×2 matrix: xx, xy, yy.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sym2(pub [f64; 3]);

impl Sym2 {
    /// Returns the eigenvalues, the larger first; neither is below 0 for a covariance.
    pub fn eigenvalues(&self) -> [f64; 2] {
        let [a, b, c] = self.0;
        let (middle, half) = (0.5 * (a + c), 0.5 * (a - c));
        let radius = (half * half + b * b).sqrt();
        [middle + radius, (middle - radius).max(0.0)]
    }

    /// Returns the unit eigenvector of the larger eigenvalue.
    pub fn main_axis(&self) -> [f64; 2] {
        let [a, b, c] = self.0;
        let [largest, _] = self.eigenvalues();
        // Of the two rows that determine it, the longer one is exact.
        let (first, second) = ([b, largest - a], [largest - c, b]);
        let length = |v: [f64; 2]| (v[0] * v[0] + v[1] * v[1]).sqrt();
        let longer = if length(first) > length(second) { first } else { second };
        match length(longer) {
            0.0 => [1.0, 0.0],
            length => longer.map(|v| v / length),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes_the_product() {
        let mut matrix = Sym3::default();
        for v in [[1.0, 0.2, 0.5], [-0.3, 1.0, 0.4], [0.1, -0.6, 1.0], [0.5, 0.5, 0.5]] {
            matrix.add(Vec3::from_array(v), 0.7);
        }
        let v = Vec3::new(0.3, -1.2, 2.0);
        let back = matrix.inverse().unwrap().times(matrix.times(v));
        assert!((back - v).length() < 1e-12, "{back:?}");
        let mut flat = Sym3::default();
        flat.add(Vec3::new(1.0, 0.0, 1.0), 1.0);
        assert_eq!(flat.inverse(), None);
        assert!(flat.least_eigenvalue().abs() < 1e-7);
    }

    #[test]
    fn eigenvalues_are_those_of_the_diagonal() {
        let diagonal = Sym3([3.0, 0.0, 0.0, 0.5, 0.0, 2.0]);
        assert!((diagonal.least_eigenvalue() - 0.5).abs() < 1e-12);
        let turned = Sym2([2.0, 1.0, 2.0]);
        assert_eq!(turned.eigenvalues(), [3.0, 1.0]);
        let [x, y] = turned.main_axis();
        assert!((x - y).abs() < 1e-15 && (x * x + y * y - 1.0).abs() < 1e-15);
        assert_eq!(Sym2([0.0, 0.0, 4.0]).main_axis().map(f64::abs), [0.0, 1.0]);
    }
}
