//! The light of an environment at some roughnesses, and at all by going between them.

use super::octahedron::{Octahedron, mix};
use crate::math::scalar;

/// The light at one roughness.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Level {
    /// Roughness², (0, 1].
    pub(super) alpha: f32,
    pub(super) map: Octahedron,
}

/// Levels from the smoothest to the roughest, which has roughness 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Levels(pub(super) Vec<Level>);

/// Where levels become dense, and how dense they are below and above. Going between two lobes of GGX that are a factor
/// of e^δ apart in α errs by up to 0.18 δ² in the mean square; steps above are 1.14.
const DENSE_FROM: f64 = 0.04;
const SPARSE: (u32, f64) = (6, 1.5);
const DENSE: u32 = 24;

/// The α of each level.
pub(super) fn alphas() -> Vec<f64> {
    let sparse = (1..=SPARSE.0).rev().map(|n| DENSE_FROM * scalar::pow(SPARSE.1, -f64::from(n)));
    let dense = (0..=DENSE).map(|n| scalar::pow(DENSE_FROM, 1.0 - f64::from(n) / f64::from(DENSE)));
    sparse.chain(dense).collect()
}

impl Levels {
    /// The light at `roughness`, [0, 1], at a [`place_of`] a direction, linear RGB and a number that means nothing.
    /// `mirror` tells the light itself there.
    ///
    /// Between levels light is linear in 1/α: of all functions of α that one errs least for a lone bright texel, since
    /// the second derivative of a lobe by ln α is, as far as it is like the first, its negative.
    ///
    /// [`place_of`]: super::octahedron::place_of
    #[inline]
    pub(super) fn at(&self, place: [f32; 2], roughness: f32, mirror: impl FnOnce() -> [f32; 4]) -> [f32; 4] {
        let alpha = roughness * roughness;
        let above = self.0.partition_point(|level| level.alpha <= alpha);
        let Some(above_level) = self.0.get(above) else { return self.roughest(place).unwrap_or_else(mirror) };
        let high = above_level.map.at(place);
        if above == 0 {
            let t = alpha / above_level.alpha;
            return if t > 0.0 { mix(mirror(), high, t) } else { mirror() };
        }
        let below = &self.0[above - 1];
        let t = (alpha - below.alpha) * above_level.alpha / ((above_level.alpha - below.alpha) * alpha);
        mix(below.map.at(place), high, t)
    }

    /// The light at roughness 1.
    #[inline]
    pub(super) fn roughest(&self, place: [f32; 2]) -> Option<[f32; 4]> {
        self.0.last().map(|level| level.map.at(place))
    }
}
