//! Accumulates the samples of a tile.

use super::batch::Batch;
use super::columns::get3;
use super::view::View;
use super::visible::VisibleBatch;
use crate::math::Vec3;
use crate::raster::TILE_PIXELS;
use crate::scene::AlphaMode;

/// The pixels of a tile, row by row with [`TILE_SIZE`] pixels per row.
///
/// [`TILE_SIZE`]: crate::raster::TILE_SIZE
#[derive(Default)]
pub(super) struct Resolve {
    /// The colour, linear, premultiplied.
    pub color: Vec<[f32; 4]>,
    /// Normals, depth, albedo, uv, triangle; empty if not requested.
    pub aovs: [Vec<[f32; 4]>; 5],
    /// The weight of a sample in its pixel.
    weight: f32,
    /// Overlapping fragments of a sample.
    layers: Vec<Shaded>,
}

/// A fragment with its colour.
#[derive(Debug, Clone, Copy)]
struct Shaded {
    pixel: u32,
    triangle: u32,
    /// Reversed depth.
    depth: f32,
    /// The radiance, linear RGB, not premultiplied.
    radiance: Vec3,
    /// The fraction of the background that is covered.
    coverage: f32,
}

impl Resolve {
    /// Clears the tile for `samples` samples per pixel.
    pub(super) fn begin(&mut self, samples: usize, aovs: bool) {
        self.weight = 1.0 / samples as f32;
        clear(&mut self.color);
        for plane in &mut self.aovs {
            if aovs {
                clear(plane);
            } else {
                plane.clear();
            }
        }
    }

    /// Adds fragments, each the only one in its pixel.
    pub(super) fn add_opaque(&mut self, visible: VisibleBatch<'_>, batch: &Batch) {
        let (weight, mut first) = (self.weight, 0);
        for span in visible.spans() {
            let [r, g, b] = batch.lit.radiance.each_ref().map(|column| &column[first..first + span.len()]);
            let sums = &mut self.color[span.start as usize..span.end as usize];
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum =
                    [sum[0] + r[i] * weight, sum[1] + g[i] * weight, sum[2] + b[i] * weight, sum[3] + weight];
            }
            first += span.len();
        }
    }

    /// Stores possibly overlapping fragments until [`Self::add_layers`].
    pub(super) fn keep(&mut self, visible: VisibleBatch<'_>, mode: AlphaMode, batch: &Batch) {
        self.layers.extend(visible.pixels().enumerate().map(|(i, (pixel, span))| Shaded {
            pixel,
            triangle: span.triangle,
            depth: span.depth,
            radiance: get3(&batch.lit.radiance, i),
            coverage: coverage(mode, batch.material.alpha[i]),
        }));
    }

    /// Composites the stored fragments of a sample, far ones first, and adds the result.
    pub(super) fn add_layers(&mut self) {
        // At equal depth, fragments drawn first are on top, as in the depth test.
        self.layers.sort_by(|a, b| {
            let order = |s: &Shaded| (s.pixel, s.depth.to_bits());
            order(a).cmp(&order(b)).then(b.triangle.cmp(&a.triangle))
        });
        for fragments in self.layers.chunk_by(|a, b| a.pixel == b.pixel) {
            let mut color = [0.0f32; 4];
            for fragment in fragments {
                let [r, g, b] = fragment.radiance.to_array();
                let source = [r, g, b, 1.0];
                let behind = 1.0 - fragment.coverage;
                color = std::array::from_fn(|c| source[c] * fragment.coverage + color[c] * behind);
            }
            let sum = &mut self.color[fragments[0].pixel as usize];
            for c in 0..4 {
                sum[c] += color[c] * self.weight;
            }
        }
        self.layers.clear();
    }

    /// Keeps the nearest fragment so far in the output variables, if it is at least half opaque.
    pub(super) fn note_aovs(
        &mut self,
        visible: VisibleBatch<'_>,
        mode: AlphaMode,
        batch: &Batch,
        view: &View,
    ) {
        let [normals, depth, albedo, uv, triangle] = &mut self.aovs;
        if normals.is_empty() {
            return;
        }
        for (i, (pixel, span)) in visible.pixels().enumerate() {
            if coverage(mode, batch.material.alpha[i]) < 0.5 {
                continue;
            }
            let pixel = pixel as usize;
            let distance = view.depth(get3(&batch.geometry.position, i));
            if depth[pixel][3] != 0.0 && depth[pixel][0] <= distance {
                continue;
            }
            let with_one = |v: Vec3| [v.x, v.y, v.z, 1.0];
            normals[pixel] = with_one(get3(&batch.frame.n, i));
            depth[pixel] = [distance, distance, distance, 1.0];
            albedo[pixel] = with_one(get3(&batch.lit.albedo, i));
            let [u, v] = batch.first_uv(i);
            uv[pixel] = [u, v, 0.0, 1.0];
            let id = span.triangle as f32;
            triangle[pixel] = [id, id, id, 1.0];
        }
    }
}

fn clear(plane: &mut Vec<[f32; 4]>) {
    plane.clear();
    plane.resize(TILE_PIXELS, [0.0; 4]);
}

/// The fraction of the background that a fragment hides.
fn coverage(mode: AlphaMode, alpha: f32) -> f32 {
    match mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        AlphaMode::Blend => alpha.clamp(0.0, 1.0),
    }
}
