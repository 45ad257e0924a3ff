//! The places where projection rays missed the scan, downscaled for viewing.

use crate::bake::{BakedMaps, TexelStatus};

/// The maximum number of texels along the longer side.
const SIDE: usize = 1024;

/// The status of a map's texels, the worst of each block, so that even a single miss is visible.
///
/// ```
/// use taotie::asset::Misses;
/// use taotie::bake::TexelStatus;
///
/// /// Returns the number of blocks for which nothing was found.
/// fn lost(misses: &Misses) -> usize {
///     misses.texels.iter().filter(|texel| **texel == TexelStatus::Lost).count()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Misses {
    /// Blocks across.
    pub width: usize,
    /// Blocks down.
    pub height: usize,
    /// Row by row from the top.
    pub texels: Vec<TexelStatus>,
}

impl Misses {
    /// Examines the map; `None` if no ray missed.
    pub(super) fn of(maps: &BakedMaps) -> Option<Self> {
        let [width, height] = maps.size().map(|side| side as usize);
        maps.texels.iter().find(|texel| matches!(texel, TexelStatus::Closest | TexelStatus::Lost))?;
        let step = width.max(height).div_ceil(SIDE);
        let (across, down) = (width / step, height / step);
        let worst = |i: usize| {
            let (x, y) = (i % across * step, i / across * step);
            let block = (y..y + step).flat_map(|y| maps.texels[y * width + x..][..step].iter());
            block.copied().max_by_key(|texel| *texel as u8).unwrap_or_default()
        };
        Some(Self { width: across, height: down, texels: (0..across * down).map(worst).collect() })
    }
}
