//! Coefficients of a basis by least squares over the lights.

use super::basis::Basis;
use taotie_engine::math::Vec3;

/// Added to the diagonal of the normal equations, relative to the mean square of each term: terms that the lights
/// cannot distinguish, as with all lights at one height, stay small.
const RIDGE: f64 = 1e-4;

/// The linear map from a pixel's samples under all lights to the coefficients of a basis.
#[derive(Debug, Clone)]
pub struct Projection {
    /// For each light the factor of its sample in each coefficient; zeros if the light comes from behind.
    pub factors: Vec<Vec<f64>>,
    /// The mean product of two terms over the lights, row by row: errors of coefficients as errors of samples.
    pub gram: Vec<Vec<f64>>,
    /// The terms for each light; `None` if it comes from behind.
    rows: Vec<Option<Vec<f64>>>,
}

impl Projection {
    /// Computes the map for unit vectors towards the lights; those from behind are left out.
    pub fn new(basis: Basis, lights: &[Vec3<f64>]) -> Self {
        let terms = basis.terms();
        let rows: Vec<Option<Vec<f64>>> =
            lights.iter().map(|light| (light.z > 0.0).then(|| basis.weights(*light))).collect();
        let count = rows.iter().flatten().count().max(1) as f64;
        let mut gram = vec![vec![0.0; terms]; terms];
        for row in rows.iter().flatten() {
            for (a, sums) in gram.iter_mut().enumerate() {
                sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += row[a] * v / count);
            }
        }
        let factor = cholesky(&gram);
        let solved = |row: &Vec<f64>| solve(&factor, row).iter().map(|v| v / count).collect();
        let factors = rows.iter().map(|row| row.as_ref().map_or(vec![0.0; terms], solved)).collect();
        Self { factors, gram, rows }
    }

    /// Returns the largest value of a function with these coefficients at the lights.
    pub fn peak(&self, a: &[f64]) -> f64 {
        let value = |row: &Vec<f64>| row.iter().zip(a).fold(0.0, |sum, (term, a)| sum + term * a);
        self.rows.iter().flatten().map(value).fold(0.0, f64::max)
    }

    /// Returns the mean product of two functions with these coefficients over the lights.
    pub fn mean_product(&self, a: &[f64], b: &[f64]) -> f64 {
        let rows = self.gram.iter().zip(a);
        rows.fold(0.0, |sum, (row, a)| sum + a * row.iter().zip(b).fold(0.0, |sum, (g, b)| sum + g * b))
    }
}

/// Returns the lower triangle L with L Lᵀ = `matrix` + ridge.
fn cholesky(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let size = matrix.len();
    let mut lower = vec![vec![0.0; size]; size];
    for i in 0..size {
        for j in 0..=i {
            let known = (0..j).fold(0.0, |sum, k| sum + lower[i][k] * lower[j][k]);
            lower[i][j] = match i == j {
                true => (matrix[i][i] * (1.0 + RIDGE) + 1e-12 - known).max(1e-12).sqrt(),
                false => (matrix[i][j] - known) / lower[j][j],
            };
        }
    }
    lower
}

/// Solves L Lᵀ x = `right`.
fn solve(lower: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let size = right.len();
    let mut x = right.to_vec();
    for i in 0..size {
        let known = (0..i).fold(0.0, |sum, k| sum + lower[i][k] * x[k]);
        x[i] = (x[i] - known) / lower[i][i];
    }
    for i in (0..size).rev() {
        let known = (i + 1..size).fold(0.0, |sum, k| sum + lower[k][i] * x[k]);
        x[i] = (x[i] - known) / lower[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::scalar;

    fn lights(count: usize) -> Vec<Vec3<f64>> {
        let light = |k: usize| {
            let z = 0.3 + 0.65 * (k as f64 + 0.5) / count as f64;
            let (r, angle) = ((1.0 - z * z).sqrt(), k as f64 * 2.4);
            Vec3::new(r * scalar::cos(angle), r * scalar::sin(angle), z)
        };
        (0..count).map(light).collect()
    }

    #[test]
    fn functions_of_the_basis_are_found() {
        let lights = lights(40);
        for basis in [Basis::Ptm, Basis::Hsh(2), Basis::Hsh(3)] {
            let truth: Vec<f64> = (0..basis.terms()).map(|t| 0.5 - 0.1 * t as f64).collect();
            let value =
                |weights: &[f64], c: &[f64]| -> f64 { weights.iter().zip(c).map(|(w, c)| w * c).sum() };
            let projection = Projection::new(basis, &lights);
            let mut found = vec![0.0; basis.terms()];
            for (light, factors) in lights.iter().zip(&projection.factors) {
                let sample = value(&basis.weights(*light), &truth);
                found.iter_mut().zip(factors).for_each(|(sum, factor)| *sum += factor * sample);
            }
            for light in &lights {
                let weights = basis.weights(*light);
                let error = value(&weights, &found) - value(&weights, &truth);
                assert!(error.abs() < 0.01, "{basis:?}: {error}");
            }
            let square = projection.mean_product(&truth, &truth);
            let all = lights.iter().map(|light| value(&basis.weights(*light), &truth)).map(|v| v * v);
            assert!((square - all.sum::<f64>() / 40.0).abs() < 1e-9);
        }
    }

    #[test]
    fn lights_on_one_ring_give_finite_coefficients() {
        let ring: Vec<Vec3<f64>> = (0..12)
            .map(|k| 0.5 * f64::from(k))
            .map(|a| Vec3::new(0.6 * scalar::cos(a), 0.6 * scalar::sin(a), if a > 5.0 { -0.8 } else { 0.8 }))
            .collect();
        let projection = Projection::new(Basis::Hsh(3), &ring);
        assert!(projection.factors.iter().flatten().all(|v| v.is_finite() && v.abs() < 1e3));
        assert!(projection.factors[11].iter().all(|v| *v == 0.0));
    }
}
