//! The uncertainty of a normal: a covariance on its tangent plane, and the radius in degrees that holds 68 %.
//!
//! Five sources add up. Each but the first is scaled by a factor that was calibrated on generated photographs
//! ([`FACTORS`]):
//!
//! 1. noise: the covariance of the weighted fit, σ² (Σ w l lᵀ)⁻¹;
//! 2. misfit: residuals of lights from one side err together, whether by a soft shadow, a highlight or light between
//!    parts of the object. How far each sector of lights pulls at the fit shows in which direction the normal may be off;
//! 3. indirect light: the normal may be off along the direction in which its removal turned it, the more the worse the
//!    relief explains the light in shadows;
//! 4. rejection: the same along the direction in which shadows and highlights had turned it, if misfit remains;
//! 5. light from surfaces out of sight, where the object is curved: as large as all its indirect light, if the relief
//!    does not explain shadows.
//!
//! On the tangent plane, sources 2 to 4 have directions: errors along them are several times those across.

use crate::symmetric::{Sym2, Sym3};
use taotie_engine::math::{Vec3, scalar};

/// Factors of the standard deviations from noise, misfit, indirect light, rejection and light from out of sight.
///
/// Noise has the factor of theory. The others minimise, over 22 sets of generated photographs of six models, the squared
/// differences between the fractions of errors within 1 and 2 σ along each axis and within the radius, and those of a
/// normal distribution; those within 2 σ count four times. They are then enlarged by 5 %, as errors have longer tails.
const FACTORS: [f64; 5] = [1.0, 2.8, 0.42, 0.36, 0.17];

/// The sources of the uncertainty of one pixel.
#[derive(Debug, Clone, Copy)]
pub struct Sources {
    /// Normal times albedo.
    pub b: Vec3<f64>,
    /// Covariance of the fit from noise.
    pub noise: Sym3,
    /// Covariance of the unit normal from the pull of sectors of lights, less what noise explains.
    pub sectors: Sym3,
    /// Mean outer product of the turns by which the removal of indirect light changed the unit normals nearby.
    pub turned: Sym3,
    /// The change of the unit normal by rejection, scaled to the geometric mean of itself and the relative misfit.
    pub rejected: Vec3<f64>,
    /// Variance of light from out of sight in each direction, square radians.
    pub unseen: f64,
}

impl Sources {
    /// Returns the covariance of the normal's two components on the tangent plane, square radians, in the basis of
    /// [`tangents`].
    pub fn covariance(&self) -> Sym2 {
        let squares = FACTORS.map(|factor| factor * factor);
        let length = self.b.length();
        let [t, u] = tangents(self.b / length);
        let entry = |a: Vec3<f64>, b: Vec3<f64>| {
            squares[0] * a.dot(self.noise.times(b)) / (length * length)
                + squares[1] * a.dot(self.sectors.times(b))
                + squares[2] * a.dot(self.turned.times(b))
                + squares[3] * a.dot(self.rejected) * b.dot(self.rejected)
        };
        let unseen = squares[4] * self.unseen;
        Sym2([entry(t, t) + unseen, entry(t, u), entry(u, u) + unseen])
    }
}

/// Returns the vector scaled to length 1; zero if it has no direction.
pub fn unit(b: Vec3<f64>) -> Vec3<f64> {
    b.normalize_or(Vec3::splat(0.0))
}

/// Returns two unit vectors perpendicular to a unit vector and each other.
pub fn tangents(n: Vec3<f64>) -> [Vec3<f64>; 2] {
    let t = n.any_perpendicular();
    [t, n.cross(t)]
}

/// The ratio of the 68 % radius to the larger standard deviation, by the ratio of the smaller to the larger.
#[derive(Debug, Clone)]
pub struct RadiusTable {
    radii: Vec<f64>,
}

/// The probability within the radius.
const WITHIN: f64 = 0.68;
/// Intervals of the table.
const INTERVALS: usize = 64;

impl RadiusTable {
    /// Computes the table.
    pub fn new() -> Self {
        let radius = |i: usize| {
            let ratio = i as f64 / INTERVALS as f64;
            let (mut low, mut high) = (0.9, 1.6);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if probability(middle, ratio) < WITHIN { low = middle } else { high = middle }
            }
            low
        };
        Self { radii: (0..=INTERVALS).map(radius).collect() }
    }

    /// Returns the radius around the estimate that holds 68 % of the probability, in the unit of the standard
    /// deviations, the larger first.
    pub fn radius(&self, [larger, smaller]: [f64; 2]) -> f64 {
        if larger <= 0.0 {
            return 0.0;
        }
        let at = (smaller / larger).clamp(0.0, 1.0) * INTERVALS as f64;
        let below = (at as usize).min(INTERVALS - 1);
        let part = at - below as f64;
        larger * (self.radii[below] * (1.0 - part) + self.radii[below + 1] * part)
    }
}

/// The probability that a normally distributed point with standard deviations 1 and `ratio` is within `radius`.
///
/// In polar coordinates the integral over the distance is closed; over the angle it is summed.
fn probability(radius: f64, ratio: f64) -> f64 {
    const ANGLES: usize = 400;
    let ratio = ratio.max(1e-3);
    let part = |i: usize| {
        // Angles of the ellipse itself: even steps also for a thin one.
        let angle = (i as f64 + 0.5) / ANGLES as f64 * std::f64::consts::FRAC_PI_2;
        let [x, y] = [scalar::cos(angle), ratio * scalar::sin(angle)];
        1.0 - scalar::exp(-0.5 * radius * radius / (x * x + y * y))
    };
    (0..ANGLES).map(part).sum::<f64>() / ANGLES as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_of_circles_and_lines_are_the_closed_forms() {
        let table = RadiusTable::new();
        let circle = (-2.0 * scalar::ln(1.0 - 0.68)).sqrt();
        assert!((table.radius([2.0, 2.0]) - 2.0 * circle).abs() < 1e-6);
        // 68 % of a normal distribution are within 0.99446 standard deviations.
        assert!((table.radius([3.0, 0.0]) - 3.0 * 0.994_46).abs() < 0.01, "{}", table.radius([1.0, 0.0]));
        assert_eq!(table.radius([0.0, 0.0]), 0.0);
    }

    #[test]
    fn radii_hold_68_percent_of_random_points() {
        let (mut state, table) = (7_u64, RadiusTable::new());
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        for ratio in [1.0, 0.7, 0.4, 0.1] {
            let radius = table.radius([1.0, ratio]);
            let count = 100_000;
            let inside = (0..count).filter(|_| {
                let (r, angle) = ((-2.0 * scalar::ln(unit())).sqrt(), std::f64::consts::TAU * unit());
                let [x, y] = [r * scalar::cos(angle), ratio * r * scalar::sin(angle)];
                x * x + y * y < radius * radius
            });
            let share = inside.count() as f64 / f64::from(count);
            assert!((share - 0.68).abs() < 0.006, "{ratio}: {share}");
        }
    }

    #[test]
    fn the_covariance_is_that_of_noise_on_the_tangent_plane() {
        let b = Vec3::new(0.0, 0.0, 0.5);
        let inverse = Sym3([0.25, 0.0, 0.0, 1.0, 0.0, 9.0]);
        let none = Sym3::default();
        let noise = inverse.scaled(1e-4);
        let rejected = Vec3::splat(0.0);
        let sources = Sources { b, noise, sectors: none, turned: none, rejected, unseen: 0.0 };
        let [larger, smaller] = sources.covariance().eigenvalues().map(f64::sqrt);
        assert!((larger / (FACTORS[0] * 0.02) - 1.0).abs() < 1e-12 && (smaller / larger - 0.5).abs() < 1e-12);
    }

    #[test]
    fn errors_are_expected_along_the_turn() {
        let mut turned = Sym3::default();
        turned.add(Vec3::new(0.0, 0.1, 0.0), 1.0);
        let none = Sym3::default();
        let b = Vec3::new(0.0, 0.0, 0.7);
        let rejected = Vec3::splat(0.0);
        let covariance =
            Sources { b, noise: none, sectors: none, turned, rejected, unseen: 0.0 }.covariance();
        let [t, u] = tangents(Vec3::new(0.0, 0.0, 1.0));
        let axis = covariance.main_axis();
        assert!((t * axis[0] + u * axis[1]).y.abs() > 0.999_999);
        assert!((covariance.eigenvalues()[0].sqrt() - FACTORS[2] * 0.1).abs() < 1e-12);
    }
}
