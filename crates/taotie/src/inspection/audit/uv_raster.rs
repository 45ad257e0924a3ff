//! The uvs of a mesh on a raster that just fits them, and the distance between labelled regions of a raster.

use taotie_engine::bake::{Coverage, TexelGrid};
use taotie_engine::error::Result;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::parallel;

/// The longest side of a raster.
pub(super) const MOST_SIDE: u32 = 4096;

/// The uvs of uv set 0, translated and scaled to fill a raster, without wrapping.
pub(super) struct UvRaster<'a> {
    mesh: &'a Mesh,
    /// In [0, 1].
    uvs: Vec<Vec2>,
    size: [u32; 2],
    /// The side of a texel in the mesh's own uvs.
    pub texel: f64,
}

impl<'a> UvRaster<'a> {
    /// Makes a raster with texels of `1 / texels_per_uv` or less, at most [`MOST_SIDE`] of them across; `None` if no
    /// triangle has uvs that span an area.
    pub fn per_uv(mesh: &'a Mesh, texels_per_uv: f64) -> Option<Self> {
        Self::new(mesh, |longest| longest * texels_per_uv)
    }

    /// Makes a raster whose longer side has this many texels, at most [`MOST_SIDE`]; `None` as for [`Self::per_uv`].
    pub fn across(mesh: &'a Mesh, texels: f64) -> Option<Self> {
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
    pub fn coverage(&self, order: impl Iterator<Item = u32>) -> Result<Coverage> {
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
pub(super) const NONE: u32 = u32::MAX;

/// Returns the minimum number of empty texels between two regions of different labels, counted in king's moves on a
/// chessboard; 0 if they touch, `None` if there are no two.
///
/// Every texel gets the label of the region nearest to it by two sweeps (Rosenfeld and Pfaltz 1968), which are exact
/// for this distance. On a shortest path between two regions some step joins texels of different labels, and their
/// distances add up to the number of texels on it.
pub(super) fn narrowest_gap(labels: Vec<u32>, width: usize) -> Option<u32> {
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
