//! The gutter between UV islands.

use super::check::{Check, CheckResult};
use super::distance::{NONE, narrowest_gap};
use super::schema::Gutter;
use super::uv_raster::UvRaster;
use super::words::{number, rounded};
use crate::bake::Coverage;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::parallel;
use crate::surface::uv_islands;

/// Texels of the raster per required gutter.
const TEXELS: f64 = 16.0;

/// The minimum number of raster texels per unit of uv, for small islands.
const LEAST_TEXELS: f64 = 1024.0;

/// Checks that UV islands of a mesh are at least the required distance apart, along the longer of the two axes.
/// Islands are triangles joined by corners with equal uvs.
///
/// The width is measured on a raster with 16 texels per required gutter, at least 1024 per unit of uv and at most
/// 4096 across, and rounded up to the next texel, so that no island fails by rounding. Overlapping islands have a
/// gutter of 0; those too small to cover the centre of a texel are ignored. If uvs span so much that the gutter is
/// narrower than a texel, the check is not tested, unless another mesh fails it.
///
/// # Errors
/// [`crate::Error::Limit`] for a mesh of 2³¹ triangles.
pub(super) fn result(meshes: &[&Mesh], gutter: Option<Gutter>) -> Result<CheckResult> {
    let check = Check::GutterWidth;
    let Some(gutter) = gutter else { return Ok(CheckResult::not_tested(check, "not required")) };
    let texels_per_uv = (TEXELS / gutter.width()).max(LEAST_TEXELS);
    let (mut narrowest, mut coarse) = (f64::INFINITY, None);
    for mesh in meshes {
        let Some(raster) = UvRaster::per_uv(mesh, texels_per_uv) else { continue };
        if raster.texel > gutter.width() * 1.0001 {
            coarse = Some(raster.texel);
        } else if let Some(width) = width(&raster, &uv_islands(mesh))? {
            narrowest = narrowest.min(width);
        }
    }
    Ok(match coarse {
        Some(texel) if is_wide_enough(narrowest, gutter) => {
            let (width, texel) = (number(gutter.width()), number(texel));
            let why = format!(
                "uvs span too much: the gutter of {width} is narrower than a raster texel of {texel}"
            );
            CheckResult::not_tested(check, why)
        }
        _ if narrowest == f64::INFINITY => CheckResult::tested(check, true, "no two UV islands"),
        _ => measured(narrowest, gutter),
    })
}

/// Compares the narrowest gutter, in uv, with the required one.
fn measured(width: f64, gutter: Gutter) -> CheckResult {
    let pixels = rounded(width * gutter.resolution, 1e3);
    let (least, resolution) = (number(gutter.pixels), number(gutter.resolution));
    let message = format!("{} px at {resolution} (at least {least})", number(pixels));
    let result = CheckResult::tested(Check::GutterWidth, is_wide_enough(width, gutter), message);
    CheckResult { value: Some(pixels), minimum: Some(gutter.pixels), ..result }
}

/// Returns true if a width, which is rounded up and so above the true one, is sufficient.
fn is_wide_enough(width: f64, gutter: Gutter) -> bool {
    width > gutter.width() * (1.0 + 1e-9)
}

/// Returns the narrowest gutter in uv, rounded up to the next texel; `None` if there are no two islands.
fn width(raster: &UvRaster<'_>, islands: &[u32]) -> Result<Option<f64>> {
    let mut order: Vec<u32> = (0..islands.len() as u32).collect();
    order.sort_by_key(|triangle| islands[*triangle as usize]);
    let lowest = raster.coverage(order.iter().copied())?;
    let (is_shared, width) = (lowest.shared() > 0, lowest.width() as usize);
    let labels = labels(lowest, |rank| islands[order[rank as usize] as usize]);
    if is_shared {
        // The lowest island won each texel; now the highest wins.
        order.reverse();
        let highest = raster.coverage(order.iter().copied())?;
        if self::labels(highest, |rank| islands[order[rank as usize] as usize]) != labels {
            return Ok(Some(0.0));
        }
    }
    let gap = narrowest_gap(labels, width);
    Ok(gap.map(|texels| f64::from(texels + 1) * raster.texel))
}

/// Returns the island of each texel, row by row; [`NONE`] if there is none.
fn labels(coverage: Coverage, island: impl Fn(u32) -> u32 + Sync) -> Vec<u32> {
    let (width, height) = (coverage.width() as usize, coverage.height() as usize);
    parallel::collect(width * height, |i| {
        coverage.triangle((i % width) as u32, (i / width) as u32).map_or(NONE, &island)
    })
}
