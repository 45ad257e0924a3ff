//! The map of missed rays as a picture.

use crate::sheet::{GROUND, Sheet};
use taotie::asset::Misses;
use taotie::bake::TexelStatus;

/// Draws texels whose rays missed the scan: amber where the closest point was used, red where there was no hit.
pub fn misses(misses: &Misses) -> Sheet {
    const COVERED: [u8; 3] = [70, 90, 80];
    const CLOSEST: [u8; 3] = [240, 170, 40];
    const LOST: [u8; 3] = [230, 50, 40];
    let color = |texel: &TexelStatus| match texel {
        TexelStatus::Free => GROUND,
        TexelStatus::Met => COVERED,
        TexelStatus::Closest => CLOSEST,
        TexelStatus::Lost => LOST,
    };
    let pixels = misses.texels.iter().map(color).collect();
    Sheet { width: misses.width, height: misses.height, pixels }
}
