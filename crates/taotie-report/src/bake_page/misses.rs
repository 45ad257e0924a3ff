//! Draws the map of missed rays.

use crate::sheet::{GROUND, Sheet};
use taotie::asset::Misses;
use taotie_engine::bake::TexelStatus;

/// Draws texels whose rays missed the scan: amber if the closest point was used, red if there was no hit.
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
