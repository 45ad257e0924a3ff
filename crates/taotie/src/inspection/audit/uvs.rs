//! Checks of uvs: their range, their orientation, triangles that overlap, and the gutter between UV islands; and the
//! raster that just fits the uvs of a mesh, on which overlaps and gutters are found.

use super::check::{Check, CheckResult, counted, number, rounded};
use super::schema::{Gutter, UvSchema};
use taotie_engine::bake::{Coverage, TexelGrid};
use taotie_engine::error::Result;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::parallel;
use taotie_engine::scene::Scene;
use taotie_engine::surface::uv_islands;

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

/// The longest side of a raster.
pub(super) const MOST_SIDE: u32 = 4096;

/// The uvs of uv set 0, translated and scaled to fill a raster, without wrapping.
struct UvRaster<'a> {
    mesh: &'a Mesh,
    /// In [0, 1].
    uvs: Vec<Vec2>,
    size: [u32; 2],
    /// The side of a texel in the mesh's own uvs.
    texel: f64,
}

impl<'a> UvRaster<'a> {
    /// Makes a raster with texels of `1 / texels_per_uv` or less, at most [`MOST_SIDE`] of them across; `None` if no
    /// triangle has uvs that span an area.
    fn per_uv(mesh: &'a Mesh, texels_per_uv: f64) -> Option<Self> {
        Self::new(mesh, |longest| longest * texels_per_uv)
    }

    /// Makes a raster whose longer side has this many texels, at most [`MOST_SIDE`]; `None` as for [`Self::per_uv`].
    fn across(mesh: &'a Mesh, texels: f64) -> Option<Self> {
        Self::new(mesh, |_| texels)
    }

    /// Makes a raster whose longer side has the number of texels that `texels` returns for its length in uv.
    fn new(mesh: &'a Mesh, texels: impl Fn(f64) -> f64) -> Option<Self> {
        let uvs = mesh.uvs().first()?;
        let [low, high] = extent(mesh, uvs);
        let extent = [high[0] - low[0], high[1] - low[1]];
        let longest = extent[0].max(extent[1]);
        let has_area = extent.iter().all(|side| side.is_finite() && *side > 0.0);
        if !has_area {
            return None;
        }
        let side = texels(longest).ceil().clamp(1.0, f64::from(MOST_SIDE));
        let texel = longest / side;
        let size = extent.map(|side| (side / texel).ceil().clamp(1.0, f64::from(MOST_SIDE)) as u32);
        let scale = size.map(|side| 1.0 / (texel * f64::from(side)));
        let fit = |v: f32, axis: usize| ((f64::from(v) - low[axis]) * scale[axis]) as f32;
        let uvs = parallel::collect(uvs.len(), |i| Vec2::new(fit(uvs[i].x, 0), fit(uvs[i].y, 1)));
        Some(Self { mesh, uvs, size, texel })
    }

    /// Lays out the triangles in this order; if several cover a texel, the first has it.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Limit`] for a mesh of 2³¹ triangles.
    fn coverage(&self, order: impl Iterator<Item = u32>) -> Result<Coverage> {
        let triangles = order.map(|triangle| self.mesh.triangles()[triangle as usize]).collect();
        let positions = vec![Vec3::splat(0.0); self.uvs.len()];
        let data = MeshData { positions, uvs: vec![self.uvs.clone()], triangles, ..MeshData::default() };
        let [width, height] = self.size;
        Coverage::new(&Mesh::new(data)?, &TexelGrid { width, height, uv_set: 0, padding: 0 })
    }
}

/// Returns the minimum and maximum finite u and v of the triangles' corners.
fn extent(mesh: &Mesh, uvs: &[Vec2]) -> [[f64; 2]; 2] {
    let triangles = mesh.triangles();
    let parts = parallel::fold(triangles.len(), |sum: &mut Extent, triangle| {
        for corner in triangles[triangle] {
            let uv = uvs[corner as usize];
            sum.take([uv.x, uv.y]);
        }
    });
    let mut all = Extent::default();
    for Extent { low, high } in parts {
        all.take(low);
        all.take(high);
    }
    [all.low, all.high].map(|corner| corner.map(f64::from))
}

/// The minimum and maximum finite u and v.
struct Extent {
    low: [f32; 2],
    high: [f32; 2],
}

impl Default for Extent {
    fn default() -> Self {
        Self { low: [f32::INFINITY; 2], high: [f32::NEG_INFINITY; 2] }
    }
}

impl Extent {
    fn take(&mut self, uv: [f32; 2]) {
        for axis in (0..2).filter(|axis| uv[*axis].is_finite()) {
            self.low[axis] = self.low[axis].min(uv[axis]);
            self.high[axis] = self.high[axis].max(uv[axis]);
        }
    }
}

/// The label of an empty texel.
const NONE: u32 = u32::MAX;

/// Returns the minimum number of empty texels between two regions of different labels, counted in king's moves on a
/// chessboard; 0 if they touch, `None` if there are no two.
///
/// Every texel gets the label of the region nearest to it by two sweeps (Rosenfeld and Pfaltz 1968), which are exact
/// for this distance. On a shortest path between two regions some step joins texels of different labels, and their
/// distances add up to the number of texels on it.
fn narrowest_gap(labels: Vec<u32>, width: usize) -> Option<u32> {
    let texel = |label: u32| u64::from(label) + if label == NONE { FAR } else { 0 };
    let mut texels: Vec<u64> = labels.into_iter().map(texel).collect();
    sweep(&mut texels, width);
    texels.reverse();
    sweep(&mut texels, width);
    let mut gap = FAR;
    for start in (0..texels.len()).step_by(width) {
        for column in 0..width {
            let here = texels[start + column];
            each_behind(&texels, Place { start, column, width }, |near| {
                // Labels are in the lower halves.
                if near as u32 != here as u32 {
                    gap = gap.min((near & !LABEL).saturating_add(here & !LABEL));
                }
            });
        }
    }
    (gap < FAR).then_some((gap / STEP) as u32)
}

/// The region nearest to a texel is encoded as a number: the steps to it in the upper half, its label in the lower,
/// so that the nearer of two is the smaller number. This is one step.
const STEP: u64 = 1 << 32;

/// The label of a texel.
const LABEL: u64 = STEP - 1;

/// The steps of a texel without a region: more than any path has, and no sum of two overflows.
const FAR: u64 = 1 << 62;

/// Propagates the nearest regions from the first texel to the last.
fn sweep(texels: &mut [u64], width: usize) {
    for start in (0..texels.len()).step_by(width) {
        for column in 0..width {
            let mut nearest = texels[start + column];
            each_behind(texels, Place { start, column, width }, |near| nearest = nearest.min(near + STEP));
            texels[start + column] = nearest;
        }
    }
}

/// The position of a texel.
#[derive(Clone, Copy)]
struct Place {
    /// The first texel of its row.
    start: usize,
    column: usize,
    width: usize,
}

/// Calls `give` with the neighbours of a texel that precede it: to the left, and the three above.
#[inline(always)]
fn each_behind(texels: &[u64], place: Place, mut give: impl FnMut(u64)) {
    let Place { start, column, width } = place;
    if column > 0 {
        give(texels[start + column - 1]);
    }
    if start > 0 {
        let above = start - width + column;
        give(texels[above]);
        if column > 0 {
            give(texels[above - 1]);
        }
        if column + 1 < width {
            give(texels[above + 1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(rows: &[&str]) -> Option<u32> {
        let texels = rows.iter().flat_map(|row| row.chars());
        narrowest_gap(texels.map(|c| c.to_digit(10).unwrap_or(NONE)).collect(), rows[0].len())
    }

    #[test]
    fn gaps_are_counted_in_empty_texels() {
        assert_eq!(gap(&["1..2"]), Some(2));
        assert_eq!(gap(&["12"]), Some(0));
        assert_eq!(gap(&["1..1", "...."]), None);
        assert_eq!(gap(&["....", "...."]), None);
        assert_eq!(gap(&["1...", "....", "....", "...2"]), Some(2), "along a diagonal");
        assert_eq!(gap(&["...1", "....", "2..."]), Some(2));
        assert_eq!(gap(&["1.....", "......", "2....3"]), Some(1), "the nearest pair");
        assert_eq!(gap(&["1....1", "......", "..2..."]), Some(1));
    }

    /// Compares with the distances of all pairs, on rasters of scattered texels.
    #[test]
    fn gaps_are_those_of_all_pairs() {
        let mut state = 7u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        for round in 0..200 {
            let (width, height) = (1 + random(12) as usize, 1 + random(12) as usize);
            let rarity = 2 + random(12);
            let label = |_| if random(rarity) == 0 { random(3) } else { NONE };
            let labels: Vec<u32> = (0..width * height).map(label).collect();
            let place = |i: usize| ((i % width) as i64, (i / width) as i64);
            let labelled = || labels.iter().enumerate().filter(|(_, label)| **label != NONE);
            let labelled = || labelled().map(|(i, label)| (place(i), *label));
            let pairs = labelled().flat_map(|one| labelled().map(move |other| (one, other)));
            let apart = pairs.filter(|((_, a), (_, b))| a != b);
            let gaps = apart.map(|(((x, y), _), ((u, v), _))| (x - u).abs().max((y - v).abs()) as u32 - 1);
            let expected = gaps.min();
            assert_eq!(narrowest_gap(labels.clone(), width), expected, "round {round}");
        }
    }
}
