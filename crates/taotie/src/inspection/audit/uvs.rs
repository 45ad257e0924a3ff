//! Checks of uvs: their range, their orientation, triangles that overlap, and the gutter between UV islands.

use super::check::{Check, CheckResult, counted, number, rounded};
use super::schema::{Gutter, UvSchema};
use super::uv_raster::{MOST_SIDE, NONE, UvRaster, narrowest_gap};
use taotie_engine::bake::Coverage;
use taotie_engine::error::Result;
use taotie_engine::mesh::Mesh;
use taotie_engine::parallel;
use taotie_engine::scene::Scene;
use taotie_engine::surface::uv_islands;

/// The extent of uvs and the triangles that are mirrored.
struct Uvs {
    least: [f32; 2],
    greatest: [f32; 2],
    inverted: usize,
}

impl Default for Uvs {
    fn default() -> Self {
        Self { least: [f32::INFINITY; 2], greatest: [f32::NEG_INFINITY; 2], inverted: 0 }
    }
}

/// Checks uv set 0 of all meshes.
///
/// # Errors
/// As [`overlap`] and [`gutter`].
pub(super) fn results(scene: &Scene, schema: &UvSchema) -> Result<Vec<CheckResult>> {
    let is_mapped = |mesh: &&Mesh| !mesh.uvs().is_empty() && !mesh.triangles().is_empty();
    let meshes: Vec<&Mesh> = scene.meshes().iter().filter(is_mapped).collect();
    let checks = [Check::UvRange, Check::InvertedUvs, Check::OverlappingUvs, Check::GutterWidth];
    if meshes.is_empty() {
        return Ok(checks.map(|check| CheckResult::not_tested(check, "no uvs")).into());
    }
    let mut uvs = Uvs::default();
    meshes.iter().for_each(|mesh| uvs.add(&Uvs::of(mesh)));
    Ok(vec![
        uvs.range(schema.require_range_zero_to_one),
        uvs.inverted(schema.require_not_inverted),
        overlap(&meshes, schema.require_not_overlapping)?,
        gutter(&meshes, schema.gutter_width.widest())?,
    ])
}

impl Uvs {
    fn of(mesh: &Mesh) -> Self {
        let uvs = &mesh.uvs()[0];
        let parts = parallel::fold(mesh.triangles().len(), |sum: &mut Self, triangle| {
            let corners = mesh.triangles()[triangle].map(|i| [uvs[i as usize].x, uvs[i as usize].y]);
            corners.iter().for_each(|uv| sum.take(*uv));
            let [a, b, c] = corners.map(|uv| uv.map(f64::from));
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            // Rows count from the top of the image, so counter-clockwise triangles have a negative area there.
            sum.inverted += usize::from(area > 0.0);
        });
        let mut all = Self::default();
        parts.iter().for_each(|part| all.add(part));
        all
    }

    fn take(&mut self, uv: [f32; 2]) {
        for (axis, v) in uv.into_iter().enumerate() {
            self.least[axis] = self.least[axis].min(v);
            self.greatest[axis] = self.greatest[axis].max(v);
        }
    }

    fn add(&mut self, other: &Self) {
        self.take(other.least);
        self.take(other.greatest);
        self.inverted += other.inverted;
    }

    fn range(&self, required: bool) -> CheckResult {
        let ([u0, v0], [u1, v1]) = (self.least, self.greatest);
        let message = format!("u {u0} to {u1}, v {v0} to {v1} (0 to 1)");
        let is_within = self.least.iter().all(|v| *v >= 0.0) && self.greatest.iter().all(|v| *v <= 1.0);
        match required {
            true => CheckResult::tested(Check::UvRange, is_within, message),
            false => CheckResult::not_tested(Check::UvRange, message),
        }
    }

    fn inverted(&self, required: bool) -> CheckResult {
        let message = format!("{} mirrored in uv (at most 0)", counted(self.inverted, "triangle"));
        match required {
            true => CheckResult::of_faults(Check::InvertedUvs, self.inverted, message),
            false => CheckResult::not_tested(Check::InvertedUvs, message),
        }
    }
}

/// Raster texels per triangle, on average over the uvs' box.
const TEXELS_PER_TRIANGLE: f64 = 9.0;

/// The minimum length of a raster's longer side.
const LEAST_SIDE: f64 = 1024.0;

/// Checks that no two triangles of a mesh overlap in uv: no two cover the centre of the same texel. Edges are exact,
/// so that neighbours never overlap. Different meshes may overlap.
///
/// # Errors
/// [`taotie_engine::Error::Limit`] for a mesh of 2³¹ triangles.
fn overlap(meshes: &[&Mesh], required: bool) -> Result<CheckResult> {
    if !required {
        return Ok(CheckResult::not_tested(Check::OverlappingUvs, "not required"));
    }
    let (mut shared, mut covered) = (0, 0);
    for mesh in meshes {
        let count = mesh.triangles().len();
        let side = (count as f64 * TEXELS_PER_TRIANGLE).sqrt().clamp(LEAST_SIDE, f64::from(MOST_SIDE));
        let Some(raster) = UvRaster::across(mesh, side) else { continue };
        let coverage = raster.coverage(0..count as u32)?;
        shared += coverage.shared();
        covered += coverage.covered();
    }
    let covered = number(covered as f64);
    let message =
        format!("{} of {covered} covered by more than one triangle (at most 0)", counted(shared, "texel"));
    Ok(CheckResult::of_faults(Check::OverlappingUvs, shared, message))
}

/// Texels of the raster per required gutter.
const TEXELS_PER_GUTTER: f64 = 16.0;

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
/// [`taotie_engine::Error::Limit`] for a mesh of 2³¹ triangles.
fn gutter(meshes: &[&Mesh], gutter: Option<Gutter>) -> Result<CheckResult> {
    let check = Check::GutterWidth;
    let Some(gutter) = gutter else { return Ok(CheckResult::not_tested(check, "not required")) };
    let texels_per_uv = (TEXELS_PER_GUTTER / gutter.width()).max(LEAST_TEXELS);
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
