//! The gutter between UV islands.

use super::check::{Check, CheckResult};
use super::distance::{NONE, narrowest_gap};
use super::schema::Gutter;
use super::uv_raster::UvRaster;
use super::words::{number, rounded};
use crate::bake::Coverage;
use crate::error::Result;
use crate::mesh::{DisjointSets, Mesh};
use crate::parallel;
use crate::surface::{Classes, bits};

/// Texels of the raster on the gutter that is asked for.
const TEXELS: f64 = 16.0;

/// Checks that UV islands of a mesh are at least so far apart, along the longer of the two axes. Islands are triangles
/// joined by corners with equal uvs.
///
/// The width is measured on a raster with 16 texels, or fewer where that would be more than 4096 across, on the gutter
/// asked for. It is rounded up to the next texel, so that no island fails by rounding. Islands over one another have a
/// gutter of 0; those too small to cover the centre of a texel are not seen.
///
/// # Errors
/// [`crate::Error::Limit`] for a mesh of 2³¹ triangles.
pub(super) fn result(meshes: &[&Mesh], gutter: Option<Gutter>) -> Result<CheckResult> {
    let check = Check::GutterWidth;
    let Some(gutter) = gutter else { return Ok(CheckResult::not_tested(check, "not required")) };
    let mut narrowest: Option<f64> = None;
    for mesh in meshes {
        let Some(raster) = UvRaster::per_uv(mesh, TEXELS / gutter.width()) else { continue };
        if raster.texel > gutter.width() * 1.0001 {
            let why = format!(
                "uvs span too much for a gutter of {}: texels of the raster are {} wide",
                number(gutter.width()),
                number(raster.texel)
            );
            return Ok(CheckResult::not_tested(check, why));
        }
        if let Some(width) = width(&raster, &islands(mesh))? {
            narrowest = Some(narrowest.map_or(width, |least| least.min(width)));
        }
    }
    let Some(width) = narrowest else {
        return Ok(CheckResult::tested(check, true, "no two UV islands"));
    };
    let pixels = rounded(width * gutter.resolution, 1e3);
    let (least, resolution) = (number(gutter.pixels), number(gutter.resolution));
    let message = format!("{} px at {resolution} (at least {least})", number(pixels));
    let passes = width > gutter.width() * (1.0 + 1e-9);
    let result = CheckResult::tested(check, passes, message);
    Ok(CheckResult { value: Some(pixels), minimum: Some(gutter.pixels), ..result })
}

/// Returns the island of each triangle, by a number that its triangles share.
fn islands(mesh: &Mesh) -> Vec<u32> {
    let uvs = &mesh.uvs()[0];
    let corners = Classes::by(uvs.len(), |i| bits([uvs[i].x, uvs[i].y]));
    let mut sets = DisjointSets::new(corners.firsts.len());
    for [a, b, c] in mesh.triangles().iter().map(|t| t.map(|i| corners.of[i as usize])) {
        sets.join(a, b);
        sets.join(b, c);
    }
    let lowest = sets.into_lowest();
    mesh.triangles().iter().map(|t| lowest[corners.of[t[0] as usize] as usize]).collect()
}

/// Returns the narrowest gutter in uv, rounded up to the next texel; `None` where there are no two islands.
fn width(raster: &UvRaster<'_>, islands: &[u32]) -> Result<Option<f64>> {
    let mut order: Vec<u32> = (0..islands.len() as u32).collect();
    order.sort_by_key(|triangle| islands[*triangle as usize]);
    let lowest = raster.coverage(order.iter().copied())?;
    let (is_shared, width) = (lowest.shared() > 0, lowest.width() as usize);
    let labels = labels(lowest, |rank| islands[order[rank as usize] as usize]);
    if is_shared {
        // The lowest island had each texel; now the highest has it.
        order.reverse();
        let highest = raster.coverage(order.iter().copied())?;
        if self::labels(highest, |rank| islands[order[rank as usize] as usize]) != labels {
            return Ok(Some(0.0));
        }
    }
    let gap = narrowest_gap(labels, width);
    Ok(gap.map(|texels| f64::from(texels + 1) * raster.texel))
}

/// Returns the island of each texel, row by row; [`NONE`] where there is none.
fn labels(coverage: Coverage, island: impl Fn(u32) -> u32 + Sync) -> Vec<u32> {
    let (width, height) = (coverage.width() as usize, coverage.height() as usize);
    parallel::collect(width * height, |i| {
        coverage.triangle((i % width) as u32, (i / width) as u32).map_or(NONE, &island)
    })
}
