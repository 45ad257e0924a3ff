//! Functions of the light's direction whose sums approximate how a pixel's brightness changes with the light.

use taotie_engine::math::{Vec3, scalar};

/// Functions of the light's direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// The six terms of a polynomial texture map: 1, x, y, x², xy, y² (Malzbender, Gelb and Wolters 2001, equation 2).
    Ptm,
    /// Hemispherical harmonics up to a degree of 1, 2 or 3, thus 4, 9 or 16 terms (Gautron et al. 2004): real spherical
    /// harmonics with 2z − 1 instead of z, orthonormal on the hemisphere. Within a degree, cosines precede sines.
    Hsh(u8),
}

impl Basis {
    /// Returns the hemispherical harmonics with a number of terms; `None` unless it is 4, 9 or 16.
    pub fn hsh(terms: usize) -> Option<Self> {
        [(4, 1), (9, 2), (16, 3)]
            .iter()
            .find(|(count, _)| *count == terms)
            .map(|(_, degree)| Self::Hsh(*degree))
    }

    /// The number of terms.
    pub fn terms(self) -> usize {
        match self {
            Self::Ptm => 6,
            Self::Hsh(degree) => (usize::from(degree) + 1) * (usize::from(degree) + 1),
        }
    }

    /// Returns the value of each term for the unit vector towards a light. Lights below the horizon count as on it.
    pub fn weights(self, light: Vec3<f64>) -> Vec<f64> {
        match self {
            Self::Ptm => {
                let Vec3 { x, y, .. } = light;
                vec![1.0, x, y, x * x, x * y, y * y]
            }
            Self::Hsh(degree) => harmonics(light)[..(usize::from(degree) + 1).pow(2)].to_vec(),
        }
    }
}

/// Returns all 16 hemispherical harmonics.
fn harmonics(light: Vec3<f64>) -> [f64; 16] {
    use std::f64::consts::PI;
    let c = light.z.clamp(0.0, 1.0);
    // cos² − cos, and the sine of the shifted angle, halved.
    let (q, s) = (c * c - c, (c - c * c).sqrt());
    let (u, angle) = (2.0 * c - 1.0, scalar::atan2(light.y, light.x));
    let [cos, sin] =
        [scalar::cos as fn(f64) -> f64, scalar::sin].map(|f| [1.0, 2.0, 3.0].map(|m| f(m * angle)));
    let root = |v: f64| (v / PI).sqrt();
    let cubic = 5.0 * q + 1.0;
    [
        root(0.5),
        root(6.0) * s * cos[0],
        root(1.5) * u,
        root(6.0) * s * sin[0],
        root(30.0) * q * cos[1],
        root(30.0) * s * u * cos[0],
        root(2.5) * (1.0 + 6.0 * q),
        root(30.0) * s * u * sin[0],
        root(30.0) * q * sin[1],
        2.0 * root(35.0) * s * s * s * cos[2],
        root(210.0) * u * q * cos[1],
        2.0 * root(21.0) * s * cubic * cos[0],
        root(3.5) * u * (1.0 + 10.0 * q),
        2.0 * root(21.0) * s * cubic * sin[0],
        root(210.0) * u * q * sin[1],
        2.0 * root(35.0) * s * s * s * sin[2],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_are_orthonormal_on_the_hemisphere() {
        // Midpoints in z, by which solid angle is uniform, and in the azimuth.
        const ROWS: usize = 4000;
        const COLUMNS: usize = 16;
        let mut products = [[0.0; 16]; 16];
        let area = std::f64::consts::TAU / (ROWS * COLUMNS) as f64;
        for i in 0..ROWS * COLUMNS {
            let z = ((i / COLUMNS) as f64 + 0.5) / ROWS as f64;
            let angle = std::f64::consts::TAU * ((i % COLUMNS) as f64 + 0.3) / COLUMNS as f64;
            let r = (1.0 - z * z).sqrt();
            let h = harmonics(Vec3::new(r * scalar::cos(angle), r * scalar::sin(angle), z));
            for (a, row) in products.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(b, sum)| *sum += h[a] * h[b] * area);
            }
        }
        for (a, row) in products.iter().enumerate() {
            for (b, product) in row.iter().enumerate() {
                let expected = f64::from(u8::from(a == b));
                assert!((product - expected).abs() < 1e-4, "{a}, {b}: {product}");
            }
        }
    }

    #[test]
    fn terms_are_counted_and_finite() {
        for basis in [Basis::Ptm, Basis::Hsh(1), Basis::Hsh(2), Basis::Hsh(3)] {
            for light in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.6, -0.8]] {
                let weights = basis.weights(Vec3::from_array(light));
                assert_eq!(weights.len(), basis.terms());
                assert!(weights.iter().all(|v| v.is_finite()));
            }
        }
        assert_eq!((Basis::hsh(9), Basis::hsh(10)), (Some(Basis::Hsh(2)), None));
    }
}
