//! Small systems with a symmetric positive definite matrix.

/// Returns the inverse by Cholesky's decomposition; `None` if the matrix is not positive definite. Only the lower triangle is
/// read.
pub fn inverse<const N: usize>(matrix: &[[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut lower = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let rest: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let v = matrix[i][j] - rest;
            if i != j {
                lower[i][j] = v / lower[j][j];
            } else if v > 0.0 && v.is_finite() {
                lower[i][i] = v.sqrt();
            } else {
                return None;
            }
        }
    }
    let mut result = [[0.0; N]; N];
    for (column, result) in result.iter_mut().enumerate() {
        let mut x = [0.0; N];
        for i in 0..N {
            let rest: f64 = (0..i).map(|k| lower[i][k] * x[k]).sum();
            x[i] = (f64::from(u8::from(i == column)) - rest) / lower[i][i];
        }
        for i in (0..N).rev() {
            let rest: f64 = (i + 1..N).map(|k| lower[k][i] * x[k]).sum();
            x[i] = (x[i] - rest) / lower[i][i];
        }
        // The inverse is symmetric: its rows are its columns.
        *result = x;
    }
    Some(result)
}

/// Returns the square of a number.
#[inline]
pub fn squared(v: f64) -> f64 {
    v * v
}

/// Returns the product of a matrix with a vector.
pub fn times<const N: usize>(matrix: &[[f64; N]; N], v: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| (0..N).map(|j| matrix[i][j] * v[j]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_one() {
        let matrix = [[4.0, 1.0, 0.5], [1.0, 3.0, -0.2], [0.5, -0.2, 2.0]];
        let inverse = inverse(&matrix).unwrap();
        for (i, column) in inverse.iter().enumerate() {
            let product = times(&matrix, column);
            (0..3).for_each(|j| assert!((product[j] - f64::from(u8::from(i == j))).abs() < 1e-12));
        }
        assert_eq!(super::inverse(&[[1.0, 2.0], [2.0, 1.0]]), None);
        assert_eq!(super::inverse(&[[f64::NAN]]), None);
    }
}
