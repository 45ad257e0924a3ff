//! The light of an environment at some roughnesses, and at all by going between them.

use super::octahedron::{Octahedron, place_of};
use crate::math::{Vec3, scalar};

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
    /// The light at `roughness`, [0, 1], in a direction. `mirror` tells the light itself there.
    #[inline]
    pub(super) fn at(&self, direction: Vec3, roughness: f32, mirror: impl FnOnce() -> Vec3) -> Vec3 {
        let place = place_of(direction);
        if let Some((below, above, share)) = self.around(roughness) {
            return below.at(place) * (1.0 - share) + above.at(place) * share;
        }
        let Some(smoothest) = self.0.first() else { return mirror() };
        let share = roughness * roughness / smoothest.alpha;
        if share > 0.0 { mirror() * (1.0 - share) + smoothest.map.at(place) * share } else { mirror() }
    }

    /// The levels below and above `roughness`, and how much of the latter is in their mean; nothing below the smoothest.
    ///
    /// Between levels light is linear in 1/α: of all functions of α that one errs least for a lone bright texel, since
    /// the second derivative of a lobe by ln α is, as far as it is like the first, its negative.
    #[inline]
    pub(super) fn around(&self, roughness: f32) -> Option<(&Octahedron, &Octahedron, f32)> {
        let alpha = roughness * roughness;
        let above = self.0.partition_point(|level| level.alpha <= alpha);
        let below = self.0.get(above.checked_sub(1)?)?;
        Some(match self.0.get(above) {
            Some(above) => {
                let share = (alpha - below.alpha) * above.alpha / ((above.alpha - below.alpha) * alpha);
                (&below.map, &above.map, share)
            }
            None => (&below.map, &below.map, 0.0),
        })
    }
}
