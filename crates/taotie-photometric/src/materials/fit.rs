//! The pixel program fitted to the samples of one texel: Gauss-Newton with Levenberg's damping.

use super::linear::{inverse, squared, times};
use super::model::Texel;
use super::reflection::{BOUNDS, Reflection, VARIABLES, Values};
use super::sight::Incident;
use crate::uncertainty::tangents;
use taotie_engine::math::{Lane, Vec3};

/// The standard deviation of a sample relative to itself, before the residuals show it.
const RELATIVE: f64 = 0.05;
/// That of the normal in each direction, radians: its own, and the part of its change to the next texel, over which a sample is
/// averaged.
const TILT: [f64; 2] = [0.01, 0.3];
/// The most steps.
const STEPS: usize = 12;
/// The relative change of the cost below which steps end.
const ENOUGH: f64 = 1e-3;
/// Deviations from which a sample has no weight.
const CUT: f64 = 4.0;
/// The cost of a start relative to that of the best, beyond which it is not refined.
const HOPELESS: f64 = 3.0;
/// Values of roughness that are tried first.
const STARTS: [f64; 4] = [0.15, 0.3, 0.5, 0.8];

/// A sample with its geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Directions and light.
    pub incident: Incident,
    /// Linear RGB.
    pub color: [f64; 3],
    /// The standard deviation of its difference from the model.
    pub deviation: f64,
}

impl Observation {
    /// Makes a sample; `floor` is the deviation of a black one.
    pub fn new(incident: Incident, color: [f64; 3], floor: f64) -> Self {
        Self { incident, color, deviation: RELATIVE * color.iter().sum::<f64>() / 3.0 + floor }
    }

    /// Adds what an error of the normal changes, of a texel with these variables.
    pub fn with_tilt(self, reflection: &Reflection, texel: &Texel, values: &Values) -> Self {
        let Texel { normal, bend, .. } = *texel;
        let tilt = (TILT[0] * TILT[0] + TILT[1] * TILT[1] * bend * bend).sqrt();
        let grey = |normal: Vec3<f64>| {
            reflection.radiance(values, normal, &self.incident).to_array().iter().sum::<f64>() / 3.0
        };
        let squares = tangents(normal).map(|tangent| {
            let [more, less] = [1.0, -1.0].map(|sign| grey((normal + tangent * (sign * tilt)).normalize()));
            squared(0.5 * (more - less))
        });
        let square = self.deviation * self.deviation + squares.iter().sum::<f64>();
        Self { deviation: square.sqrt(), ..self }
    }
}

/// A normal distribution that a variable is expected to have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation, above 0.
    pub deviation: f64,
}

/// A texel and what is known of it.
pub struct TexelFit<'a> {
    /// The properties that are not fitted.
    pub reflection: &'a Reflection,
    /// Unit normal.
    pub normal: Vec3<f64>,
    /// Its samples.
    pub observations: &'a [Observation],
    /// Standard deviation of the residuals, relative to that of samples; infinite if none is rejected.
    pub scale: f64,
    /// The expected roughness and metallic, with their spread.
    pub expected: [Option<Expected>; VARIABLES],
}

/// The result of a fit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fitted {
    /// The variables.
    pub values: Values,
    /// Their covariance.
    pub covariance: [[f64; VARIABLES]; VARIABLES],
    /// Sum of the bounded squares.
    pub cost: f64,
    /// Sum of the weighted squares of residuals, relative to the deviations of samples.
    pub squares: f64,
    /// Numbers with weight.
    pub weight: f64,
}

/// The normal equations.
struct Sums {
    matrix: [[f64; VARIABLES]; VARIABLES],
    pull: [f64; VARIABLES],
    cost: f64,
    squares: f64,
    weight: f64,
}

impl TexelFit<'_> {
    /// Returns the best fit from several starts. `metallic` lists its values at the start.
    pub fn searched(&self, metallic: &[f64]) -> Fitted {
        let starts = metallic.iter().filter_map(|metallic| {
            let starts = STARTS.iter().map(|roughness| self.start(*roughness, *metallic));
            starts.map(|start| (self.cost(&start), start)).min_by(|a, b| a.0.total_cmp(&b.0))
        });
        let starts: Vec<(f64, Values)> = starts.collect();
        let least = starts.iter().fold(f64::INFINITY, |least, (cost, _)| cost.min(least));
        let near = starts.iter().filter(|(cost, _)| *cost <= HOPELESS * least);
        let fits = near.map(|(_, start)| self.refined(*start));
        fits.min_by(|a, b| a.cost.total_cmp(&b.cost)).unwrap_or_default()
    }

    /// Returns the variables with these and the base colour that fits them best, roughly.
    fn start(&self, roughness: f64, metallic: f64) -> Values {
        const GREY: f64 = 0.5;
        let values = [GREY, GREY, GREY, roughness, metallic];
        let (mut products, mut squares) = ([0.0; 3], [0.0; 3]);
        for observation in self.observations {
            let model = self.reflection.radiance(&values, self.normal, &observation.incident).to_array();
            let precision = 1.0 / squared(observation.deviation);
            for c in 0..3 {
                products[c] += precision * model[c] * observation.color[c];
                squares[c] += precision * model[c] * model[c];
            }
        }
        let color = |c: usize| GREY * products[c] / squares[c].max(f64::MIN_POSITIVE);
        clamped([color(0), color(1), color(2), roughness, metallic])
    }

    /// Returns the weight and the bounded square of a residual whose mean square over the channels is `square`.
    fn robust(&self, square: f64) -> [f64; 2] {
        let bound = CUT * self.scale;
        if bound.is_infinite() {
            // Cauchy's: weights of far samples decrease, but never vanish.
            return [1.0 / (1.0 + square), 3.0 * Lane::ln(1.0 + square)];
        }
        let inside = (1.0 - square / (bound * bound)).max(0.0);
        let most = bound * bound / squared(self.scale);
        [inside * inside / squared(self.scale), most * (1.0 - inside * inside * inside)]
    }

    /// Returns the sum of the bounded squares of residuals, and of those from what is expected.
    pub fn cost(&self, values: &Values) -> f64 {
        let of_samples: f64 = self
            .observations
            .iter()
            .map(|observation| {
                let model = self.reflection.radiance(values, self.normal, &observation.incident).to_array();
                let deviation = observation.deviation;
                let square: f64 =
                    (0..3).map(|c| squared((observation.color[c] - model[c]) / deviation)).sum();
                self.robust(square / 3.0)[1]
            })
            .sum();
        of_samples + self.expectation(values)
    }

    fn expectation(&self, values: &Values) -> f64 {
        let square = |(value, expected): (&f64, &Option<Expected>)| {
            expected.map_or(0.0, |Expected { mean, deviation }| squared((value - mean) / deviation))
        };
        values.iter().zip(&self.expected).map(square).sum()
    }

    fn sums(&self, values: &Values) -> Sums {
        let mut sums = Sums {
            matrix: [[0.0; VARIABLES]; VARIABLES],
            pull: [0.0; VARIABLES],
            cost: self.expectation(values),
            squares: 0.0,
            weight: 0.0,
        };
        for observation in self.observations {
            let model = self.reflection.derived(values, self.normal, &observation.incident).to_array();
            let deviation = observation.deviation;
            let residuals: [f64; 3] =
                std::array::from_fn(|c| (observation.color[c] - model[c].value) / deviation);
            let square = residuals.iter().map(|r| r * r).sum::<f64>() / 3.0;
            let [weight, cost] = self.robust(square);
            sums.cost += cost;
            let share = weight * if self.scale.is_finite() { squared(self.scale) } else { 1.0 };
            sums.squares += 3.0 * share * square;
            sums.weight += 3.0 * share;
            for (residual, model) in residuals.iter().zip(&model) {
                let slope = model.partials.map(|v| v / deviation);
                for i in 0..VARIABLES {
                    sums.pull[i] += weight * slope[i] * residual;
                    (0..=i).for_each(|j| sums.matrix[i][j] += weight * slope[i] * slope[j]);
                }
            }
        }
        for (i, expected) in self.expected.iter().enumerate() {
            if let Some(Expected { mean, deviation }) = expected {
                sums.matrix[i][i] += 1.0 / squared(*deviation);
                sums.pull[i] += (mean - values[i]) / squared(*deviation);
            }
        }
        sums
    }

    /// Returns the fit that steps from a start lead to.
    pub fn refined(&self, start: Values) -> Fitted {
        let mut values = clamped(start);
        let mut sums = self.sums(&values);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let mut damped = free(&sums, &values);
            (0..VARIABLES).for_each(|i| damped[i][i] *= 1.0 + damping);
            let Some(inverse) = inverse(&damped) else { break };
            let step = times(&inverse, &pull(&sums, &values));
            let next = clamped(std::array::from_fn(|i| values[i] + step[i]));
            let found = self.sums(&next);
            if found.cost <= sums.cost {
                let gain = sums.cost - found.cost;
                (values, sums) = (next, found);
                damping = (0.2 * damping).max(1e-9);
                if gain <= ENOUGH * sums.cost {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e6 {
                    break;
                }
            }
        }
        let covariance = inverse(&regular(&sums.matrix)).unwrap_or_default();
        Fitted { values, covariance, cost: sums.cost, squares: sums.squares, weight: sums.weight }
    }
}

/// The width of a uniform distribution over [0, 1], as a standard deviation: no variable is less certain.
const UNKNOWN: f64 = 0.288_675_134_594_812_9;

/// Returns the matrix with the certainty that all variables are in [0, 1].
fn regular(matrix: &[[f64; VARIABLES]; VARIABLES]) -> [[f64; VARIABLES]; VARIABLES] {
    let mut matrix = *matrix;
    (0..VARIABLES).for_each(|i| matrix[i][i] += 1.0 / squared(UNKNOWN));
    matrix
}

/// Returns true if a variable is at a bound and would leave it.
fn is_held(sums: &Sums, values: &Values, i: usize) -> bool {
    (values[i] <= BOUNDS[0][i] && sums.pull[i] < 0.0) || (values[i] >= BOUNDS[1][i] && sums.pull[i] > 0.0)
}

/// Returns the matrix in which held variables are not connected to others.
fn free(sums: &Sums, values: &Values) -> [[f64; VARIABLES]; VARIABLES] {
    let is_held: [bool; VARIABLES] = std::array::from_fn(|i| is_held(sums, values, i));
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match i == j {
            true => sums.matrix[i][i] + 1e-9,
            false if is_held[i] || is_held[j] => 0.0,
            false => sums.matrix[i][j],
        })
    })
}

fn pull(sums: &Sums, values: &Values) -> [f64; VARIABLES] {
    std::array::from_fn(|i| if is_held(sums, values, i) { 0.0 } else { sums.pull[i] })
}

fn clamped(values: Values) -> Values {
    std::array::from_fn(|i| values[i].clamp(BOUNDS[0][i], BOUNDS[1][i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::materials::reflection::{METALLIC, ROUGHNESS};
    use taotie_engine::math::scalar;
    use taotie_engine::scene::Material;
    use taotie_engine::shade::SubPixelVariance;

    /// Returns directions around the normal.
    fn incident(k: usize) -> Incident {
        let direction = |k: f64| {
            let angle = 2.4 * k;
            let tilt = 0.15 + 0.9 * (0.37 * k).fract();
            Vec3::new(scalar::cos(angle) * tilt, scalar::sin(angle) * tilt, 1.0).normalize()
        };
        let variance = SubPixelVariance { curvature: 0.0, normal_variance: 0.0 };
        let (v, l) = (direction(k as f64), direction(0.7 * k as f64 + 3.0));
        Incident { v, l, irradiance: Vec3::splat(3.0), variance }
    }

    #[test]
    fn metals_and_dielectrics_are_recognised_and_measured() {
        let reflection = Reflection::new(&Material::default());
        let normal = Vec3::new(0.0, 0.0, 1.0);
        for truth in [[0.7, 0.5, 0.3, 0.4, 1.0], [0.3, 0.2, 0.1, 0.3, 0.0], [0.5, 0.5, 0.4, 0.7, 0.6]] {
            let observations: Vec<Observation> = (0..24)
                .map(|k| {
                    let incident = incident(k);
                    let color = reflection.radiance(&truth, normal, &incident).to_array();
                    // One sample is wrong.
                    Observation::new(incident, if k == 3 { [2.0; 3] } else { color }, 1e-3)
                })
                .collect();
            let fit = |scale: f64| TexelFit {
                reflection: &reflection,
                normal,
                observations: &observations,
                scale,
                expected: [None; VARIABLES],
            };
            let start = fit(f64::INFINITY).searched(&[0.0, 1.0]);
            let found = fit(0.1).refined(start.values);
            for i in 0..VARIABLES {
                assert!((found.values[i] - truth[i]).abs() < 0.01, "{truth:?}: {found:?}");
            }
            assert!(found.covariance[ROUGHNESS][ROUGHNESS].sqrt() < 0.02);
            assert!(found.covariance[METALLIC][METALLIC] > 0.0);
        }
    }
}
