//! The light of an environment at several roughnesses, interpolated for those in between.

use super::bilinear::linear;
use super::octahedron::{Octahedron, octahedral_place};
use crate::math::{Lane, Mask, Number, Vec3, scalar};

/// The light at one roughness.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RoughnessLevel {
    /// Roughness², (0, 1].
    pub(super) alpha: f32,
    pub(super) map: Octahedron,
}

/// Levels from the smoothest to the roughest, which has roughness 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Levels(pub(super) Vec<RoughnessLevel>);

/// The α from which levels are dense; then their density below and above. Interpolating between two lobes of GGX
/// whose α differ by a factor of e^δ has an error of up to 0.18 δ² in the mean square; steps above are 1.14.
const DENSE_FROM: f64 = 0.04;
const SPARSE: (u32, f64) = (6, 1.5);
const DENSE: u32 = 24;

/// Levels per octave of α below and above: 1/log2 1.5 and 24/log2 25.
const SPARSE_TO_OCTAVE: f64 = 1.709_511_291_351_454_7;
const DENSE_TO_OCTAVE: f64 = 5.168_118_696_880_717;

/// The factor from one dense level's α to the next: 25^(1/24).
const DENSE_STEP: f64 = 1.143_529_836_082_920_2;

/// The α of each level.
pub(super) fn alphas() -> Vec<f64> {
    let sparse = (1..=SPARSE.0).rev().map(|n| DENSE_FROM * scalar::pow(SPARSE.1, -f64::from(n)));
    let dense = (0..=DENSE).map(|n| scalar::pow(DENSE_FROM, 1.0 - f64::from(n) / f64::from(DENSE)));
    sparse.chain(dense).collect()
}

/// The two levels around a roughness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelPosition<L> {
    /// The index of the lower level; −1 if all are rougher.
    pub below: L,
    /// The weight of the upper level in the mean.
    pub share: L,
}

/// The weight of the smoothest level, whose roughness² is `alpha`, relative to the unfiltered light, for a lower
/// `roughness`.
#[inline(always)]
pub fn share_of_smoothest<L: Lane>(roughness: L, alpha: L) -> L {
    roughness * roughness / alpha
}

impl<L: Lane> LevelPosition<L> {
    /// Finds the levels of a `roughness` in [0, 1].
    ///
    /// Between levels light is linear in 1/α: of all functions of α, this one has the smallest error for an isolated
    /// bright texel, since the second derivative of a lobe by ln α, as far as it resembles the first, is its
    /// negative.
    #[inline(always)]
    pub fn of(roughness: L) -> Self {
        let one = roughness.lit(1.0);
        let octaves = (roughness * roughness * one.lit(1.0 / DENSE_FROM)).max(one.lit(1e-9)).log2();
        let sparse = octaves.lt(one.lit(0.0));
        let to_octave = L::select(sparse, one.lit(SPARSE_TO_OCTAVE), one.lit(DENSE_TO_OCTAVE));
        let position = octaves * to_octave + one.lit(f64::from(SPARSE.0));
        let position = position.clamp(-1.0, f64::from(SPARSE.0 + DENSE));
        let below = position.floor();
        // 1/α decreases from one level to the next by `step`, of which `left` remains to the roughness.
        let step = L::select(sparse, one.lit(SPARSE.1), one.lit(DENSE_STEP));
        let left = ((one - (position - below)) / to_octave).exp2();
        Self { below, share: (step - left) / (step - one) }
    }
}

impl Levels {
    /// The light at `roughness`, [0, 1], in a direction. `mirror` returns the unfiltered light there.
    #[inline]
    pub(super) fn at<L: Number>(
        &self,
        direction: Vec3<L>,
        roughness: L,
        mirror: impl FnOnce() -> Vec3<L>,
    ) -> Vec3<L> {
        let (place, zero) = (octahedral_place(direction), roughness.lit(0.0));
        let LevelPosition { below, share } = LevelPosition::of(roughness);
        if zero.le(below).any() {
            let (below, above) = (self.numbered(below.index()), self.numbered(below.index() + 1));
            return linear(below.at(place), above.at(place), share);
        }
        let smoothest = &self.0[0];
        let share = share_of_smoothest(roughness, roughness.lit(f64::from(smoothest.alpha)));
        if zero.lt(share).any() { linear(mirror(), smoothest.map.at(place), share) } else { mirror() }
    }

    /// A level by its index; the roughest beyond the last.
    #[inline]
    pub(super) fn numbered(&self, number: usize) -> &Octahedron {
        &self.0[number.min(self.0.len() - 1)].map
    }

    /// The number of levels; at least one.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fractional index of the level of a roughness.
    fn position(roughness: f64) -> f64 {
        let between = LevelPosition::of(roughness);
        between.below + between.share
    }

    #[test]
    fn a_level_is_found_by_its_own_roughness() {
        for (number, alpha) in alphas().into_iter().enumerate() {
            assert!(
                (position(alpha.sqrt()) - number as f64).abs() < 1e-5,
                "{number}: {}",
                position(alpha.sqrt())
            );
        }
        assert_eq!((LevelPosition::of(0.0f32).below, LevelPosition::of(0.05f32).below), (-1.0, -1.0));
        let LevelPosition { below, share } = LevelPosition::of(1.0f32);
        assert!((below + share - 30.0).abs() < 1e-4);
        assert_eq!(LevelPosition::of(2.0f32).below, 30.0);
    }

    #[test]
    fn between_levels_the_share_is_linear_in_the_inverse_of_alpha() {
        for pair in alphas().windows(2) {
            let (below, above) = (1.0 / pair[0], 1.0 / pair[1]);
            for share in [0.1, 0.5, 0.8] {
                let alpha = 1.0 / (below + (above - below) * share);
                assert!((LevelPosition::of(alpha.sqrt()).share - share).abs() < 1e-5, "{pair:?} {share}");
            }
        }
    }
}
