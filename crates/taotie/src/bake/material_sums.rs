//! The mean material of the samples of a texel.

use super::appearance::MaterialSample;
use crate::math::Vec3;

/// The minimum weight of a colour, far below one code of alpha: fully transparent places still have a colour, which
/// has no effect next to any other.
const LEAST_WEIGHT: f32 = 1e-6;

/// Sums over the samples of a texel that have a correspondence. Colours are weighted by alpha, so that no colour of
/// transparent places bleeds in.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MaterialSums {
    count: u32,
    color: Vec3,
    weight: f32,
    /// Except for colour, sums are of differences from the first sample: constant values stay bit-identical.
    first: Option<MaterialSample>,
    rest: Rest,
}

/// Sums of differences from the first sample.
#[derive(Debug, Clone, Copy, Default)]
struct Rest {
    alpha: f32,
    metallic: f32,
    roughness: f32,
    occlusion: f32,
    emission: Vec3,
}

impl MaterialSums {
    /// Adds a sample.
    pub fn add(&mut self, sample: MaterialSample) {
        let first = *self.first.get_or_insert(sample);
        let weight = sample.alpha.max(LEAST_WEIGHT);
        self.count += 1;
        self.color += sample.color * weight;
        self.weight += weight;
        self.rest.alpha += sample.alpha - first.alpha;
        self.rest.metallic += sample.metallic - first.metallic;
        self.rest.roughness += sample.roughness - first.roughness;
        self.rest.occlusion += sample.occlusion - first.occlusion;
        self.rest.emission += sample.emission - first.emission;
    }

    /// Returns the mean; `None` without a sample.
    pub fn mean(&self) -> Option<MaterialSample> {
        let (first, rest) = (self.first?, self.rest);
        let share = 1.0 / self.count as f32;
        Some(MaterialSample {
            color: self.color * (1.0 / self.weight),
            alpha: first.alpha + rest.alpha * share,
            metallic: first.metallic + rest.metallic * share,
            roughness: first.roughness + rest.roughness * share,
            occlusion: first.occlusion + rest.occlusion * share,
            emission: first.emission + rest.emission * share,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(value: f32, alpha: f32) -> MaterialSample {
        MaterialSample {
            color: Vec3::splat(value),
            alpha,
            metallic: value,
            roughness: value,
            occlusion: value,
            emission: Vec3::splat(value),
        }
    }

    #[test]
    fn what_is_the_same_everywhere_stays_so_to_the_bit() {
        for count in 1..70 {
            let mut sums = MaterialSums::default();
            (0..count).for_each(|_| sums.add(sample(0.1, 0.7)));
            let mean = sums.mean().unwrap();
            let rest = MaterialSample { color: mean.color, ..sample(0.1, 0.7) };
            assert_eq!(mean, rest);
            assert!((mean.color.x - 0.1).abs() < 1e-6);
        }
    }

    #[test]
    fn colours_count_by_their_alpha() {
        let mut sums = MaterialSums::default();
        assert!(sums.mean().is_none());
        sums.add(sample(1.0, 0.75));
        sums.add(sample(0.0, 0.25));
        let mean = sums.mean().unwrap();
        assert_eq!((mean.color.x, mean.alpha, mean.metallic), (0.75, 0.5, 0.5));
        let mut faint = MaterialSums::default();
        faint.add(sample(1.0, 1.0 / 255.0));
        faint.add(sample(0.0, 0.0));
        assert!(faint.mean().unwrap().color.x > 0.999);
        let mut hidden = MaterialSums::default();
        hidden.add(sample(0.3, 0.0));
        assert!((hidden.mean().unwrap().color.x - 0.3).abs() < 1e-6);
    }
}
