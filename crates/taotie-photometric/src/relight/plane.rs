//! One coefficient of all pixels in 8 bits.

use taotie_engine::parallel;

/// A coefficient of all pixels: code / 255 · scale + bias.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// The value of code 255 less that of code 0.
    pub scale: f64,
    /// The value of code 0.
    pub bias: f64,
    /// A code for each pixel.
    pub codes: Vec<u8>,
}

/// The fraction of values that are clamped at each end: highlights at few pixels would cost all others their precision.
const CLAMPED: f64 = 1e-4;

/// Values from which ranges are found.
const SAMPLED: usize = 1 << 20;

impl Plane {
    /// Stores values in [0, 1].
    pub fn of_colors(values: &[f32]) -> Self {
        Self { scale: 1.0, bias: 0.0, codes: codes(values, 1.0, 0.0) }
    }

    /// Stores the values of several channels with the same scale and bias. 0 is stored exactly, as in polynomial texture
    /// maps, whose bias is a code.
    pub fn quantised(channels: &[&Vec<f32>]) -> Vec<Self> {
        let all: usize = channels.iter().map(|values| values.len()).sum();
        let step = all.div_ceil(SAMPLED).max(1);
        let mut sorted: Vec<f32> =
            channels.iter().flat_map(|values| values.iter().copied().step_by(step)).collect();
        sorted.sort_unstable_by(f32::total_cmp);
        let at = |fraction: f64| {
            let last = sorted.len().saturating_sub(1);
            sorted.get((fraction * last as f64 + 0.5) as usize).map_or(0.0, |v| f64::from(*v))
        };
        let (low, high) = (at(CLAMPED).min(0.0), at(1.0 - CLAMPED).max(0.0));
        // Scale and bias as the files hold them: a float, and a code.
        let zero = (-low / (high - low).max(1e-9) * 255.0).round();
        let scale = match zero {
            ..128.0 => high / (255.0 - zero) * 255.0,
            _ => -low / zero * 255.0,
        };
        let scale = f64::from(scale.max(1e-9) as f32);
        let bias = -zero / 255.0 * scale;
        channels.iter().map(|values| Self { scale, bias, codes: codes(values, scale, bias) }).collect()
    }

    /// Returns the value of each code times a factor.
    pub fn table(&self, factor: f64) -> [f32; 256] {
        std::array::from_fn(|code| (factor * (code as f64 / 255.0 * self.scale + self.bias)) as f32)
    }
}

/// Returns the nearest code of each value.
fn codes(values: &[f32], scale: f64, bias: f64) -> Vec<u8> {
    // Casting saturates.
    parallel::collect(values.len(), |i| ((f64::from(values[i]) - bias) / scale * 255.0 + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_stored_to_half_a_step_and_zero_exactly() {
        for (from, to) in [(-0.7_f32, 1.3), (0.2, 0.9), (-2.0, -0.5), (0.0, 0.0)] {
            let values: Vec<f32> = (0..=100).map(|i| from + (to - from) * i as f32 / 100.0).collect();
            let zeros = vec![0.0; 3];
            let planes = Plane::quantised(&[&values, &zeros]);
            let [first, zero] = planes.as_slice() else { panic!("two planes") };
            let table = first.table(1.0);
            let step = (table[255] - table[0]) / 255.0;
            for (value, code) in values.iter().zip(&first.codes) {
                assert!(
                    (table[usize::from(*code)] - value).abs() <= 0.52 * step,
                    "{value} of {from} to {to}"
                );
            }
            assert!(zero.codes.iter().all(|code| table[usize::from(*code)].abs() < 1e-6));
            let bias = -first.bias / first.scale * 255.0;
            assert!((bias - bias.round()).abs() < 1e-9 && (0.0..=255.0).contains(&bias), "{bias}");
        }
    }
}
