//! Pictures of maps for people to look at.

use taotie::asset::Misses;
use taotie::bake::TexelStatus;
use taotie_report::sheet::{GROUND, Sheet};

/// Where rays missed: amber took the closest point, red found nothing.
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
