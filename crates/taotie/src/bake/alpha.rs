//! Combines the alpha of several materials into one, and converts alpha from one mode to another.

use crate::scene::AlphaMode;

/// The cutoff of a material that replaces masks with different cutoffs.
const COMMON_CUTOFF: f32 = 0.5;

/// Returns the alpha mode of one material that shows all of these: blended if any is, else a mask with their common
/// cutoff, or 0.5 if they differ.
pub(super) fn common_mode(modes: impl Iterator<Item = AlphaMode>) -> AlphaMode {
    modes.fold(AlphaMode::Opaque, |common, mode| match (common, mode) {
        (AlphaMode::Blend, _) | (_, AlphaMode::Blend) => AlphaMode::Blend,
        (one, AlphaMode::Opaque) | (AlphaMode::Opaque, one) => one,
        (AlphaMode::Mask(a), AlphaMode::Mask(b)) if a == b => common,
        (AlphaMode::Mask(_), AlphaMode::Mask(_)) => AlphaMode::Mask(COMMON_CUTOFF),
    })
}

/// Returns the alpha that looks the same in another mode: for masks with another cutoff it is remapped piecewise
/// linearly so that contours stay in place; a mask shown as blended becomes 0 or 1.
pub(super) fn under_mode(alpha: f32, own: AlphaMode, shown: AlphaMode) -> f32 {
    match (own, shown) {
        (AlphaMode::Opaque, _) => 1.0,
        (AlphaMode::Blend, _) => alpha,
        (AlphaMode::Mask(own), AlphaMode::Mask(shown)) if own == shown => alpha,
        (AlphaMode::Mask(own), AlphaMode::Mask(_)) if alpha < own => COMMON_CUTOFF * alpha / own,
        (AlphaMode::Mask(own), AlphaMode::Mask(_)) if own < 1.0 => {
            COMMON_CUTOFF + (1.0 - COMMON_CUTOFF) * (alpha - own) / (1.0 - own)
        }
        (AlphaMode::Mask(own), _) => f32::from(u8::from(alpha >= own)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_material_shows_the_modes_of_all() {
        let common = |modes: &[AlphaMode]| common_mode(modes.iter().copied());
        let (opaque, blend, mask) = (AlphaMode::Opaque, AlphaMode::Blend, AlphaMode::Mask);
        assert_eq!(common(&[]), opaque);
        assert_eq!(common(&[opaque, mask(0.25), opaque]), mask(0.25));
        assert_eq!(common(&[mask(0.25), mask(0.25)]), mask(0.25));
        assert_eq!(common(&[mask(0.25), mask(0.75), mask(0.75)]), mask(0.5));
        assert_eq!(common(&[mask(0.25), blend, opaque]), blend);
    }

    #[test]
    fn contours_stay_where_they_are() {
        let mask = AlphaMode::Mask;
        for own in [0.0, 0.25, 0.5, 0.75, 1.0, 1.5] {
            for alpha in [0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0f32] {
                let moved = under_mode(alpha, mask(own), mask(0.5));
                assert_eq!(moved >= 0.5, alpha >= own, "{alpha} at {own} becomes {moved}");
                assert!((0.0..=1.0).contains(&moved));
                let there = under_mode(alpha, mask(own), AlphaMode::Blend);
                assert_eq!(there, f32::from(u8::from(alpha >= own)));
            }
        }
        assert_eq!(under_mode(0.3, mask(0.25), mask(0.25)), 0.3);
        assert_eq!(under_mode(0.3, AlphaMode::Blend, AlphaMode::Blend), 0.3);
        assert_eq!(under_mode(0.3, AlphaMode::Opaque, mask(0.5)), 1.0);
        assert_eq!(under_mode(0.3, AlphaMode::Blend, mask(0.5)), 0.3);
        let shown = [0.3, 0.7].map(|alpha| under_mode(alpha, mask(0.5), AlphaMode::Opaque));
        assert_eq!(shown, [0.0, 1.0], "absent texels contribute no colour");
    }
}
