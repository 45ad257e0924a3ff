//! Finds the triangles visible in one tile.

use super::scan::scan;
use super::sink::{InFront, Nearest};
use super::{Bins, Layer, TilePlane, TileSample};
use crate::error::Result;
use crate::math::{SimdLevel, dispatch_registers};

/// Fills `plane` with the nearest triangle of `bins` at a sample. At equal depth, the triangle drawn first wins.
///
/// # Errors
/// If the SIMD level is not available on this machine.
pub fn rasterize_opaque(
    bins: &Bins,
    at: TileSample<'_>,
    simd: SimdLevel,
    plane: &mut TilePlane,
) -> Result<()> {
    let level = simd.dispatch()?;
    plane.clear();
    if let (Some(ids), Some(depths)) = (plane.ids.first_chunk_mut(), plane.depths.first_chunk_mut()) {
        let mut sink = Nearest { ids, depths };
        dispatch_registers!(level, simd => scan(simd, bins, at, &mut sink));
    }
    Ok(())
}

/// Lists every triangle of `bins` in front of `opaque` at a sample, in drawing order.
///
/// # Errors
/// If the SIMD level is not available on this machine.
pub fn rasterize_layers(
    bins: &Bins,
    at: TileSample<'_>,
    simd: SimdLevel,
    opaque: &TilePlane,
) -> Result<Vec<Layer>> {
    let level = simd.dispatch()?;
    let mut layers = Vec::new();
    let mut sink = InFront { opaque: &opaque.depths, layers: &mut layers };
    dispatch_registers!(level, simd => scan(simd, bins, at, &mut sink));
    Ok(layers)
}
