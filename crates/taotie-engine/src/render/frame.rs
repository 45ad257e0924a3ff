//! The finished image and its arbitrary output variables, and the tiles in which their samples are accumulated and
//! written in parallel.

use super::batch::{Batch, get3};
use super::camera::View;
use super::settings::RenderSettings;
use super::visibility::VisibleBatch;
use crate::error::Result;
use crate::image::Image;
use crate::math::Vec3;
use crate::pixel::{MaterialUniforms, PassedLight};
use crate::raster::{TILE_PIXELS, TILE_SIZE};
use crate::scene::{AlphaMode, Material};

/// A finished image.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Linear radiance, premultiplied by coverage, which is the fourth channel.
    pub color: Image,
    /// The surface data at the centre of each pixel, if requested.
    pub aovs: Option<Aovs>,
}

/// The surface data at the centre of each pixel. The fourth channel is 1 if a surface is visible.
#[derive(Debug, Clone)]
pub struct Aovs {
    /// Unit shading normals, in world space, components in [-1, 1].
    pub normals: Image,
    /// Distance along the viewing axis, in model units, in the first three channels.
    pub depth: Image,
    /// Base colour, linear RGB.
    pub albedo: Image,
    /// The first uv set in the first two channels, origin top left.
    pub uv: Image,
    /// The triangle's index over all instances, from 0, in the first channel, exact up to 2^24; its quotient and
    /// remainder by 2^16 in the others.
    pub triangle: Image,
    /// The point on the surface, world space.
    pub position: Image,
}

impl Aovs {
    /// The names on the command line with their images.
    pub fn named(&self) -> [(&'static str, &Image); 6] {
        [
            ("normals", &self.normals),
            ("depth", &self.depth),
            ("albedo", &self.albedo),
            ("uv", &self.uv),
            ("triangle", &self.triangle),
            ("position", &self.position),
        ]
    }

    /// The names on the command line.
    pub const NAMES: [&'static str; 6] = ["normals", "depth", "albedo", "uv", "triangle", "position"];
}

/// The memory to which a tile of a frame is written.
pub(super) struct FrameTile<'f> {
    color: TileRows<'f, [f32; 4]>,
    /// The output variables, in the order of [`Aovs::NAMES`]; none if not requested.
    aovs: Vec<TileRows<'f, [f32; 4]>>,
}

impl FrameTile<'_> {
    pub(super) fn write(&mut self, resolve: &Resolve) {
        self.color.write(&resolve.color);
        for (rows, plane) in self.aovs.iter_mut().zip(&resolve.aovs) {
            rows.write(plane);
        }
    }
}

impl Frame {
    pub(super) fn new(settings: &RenderSettings) -> Result<Self> {
        let black = || Image::new(settings.width, settings.height, [0.0; 4]);
        let aovs = match settings.aovs {
            true => Some(Aovs {
                normals: black()?,
                depth: black()?,
                albedo: black()?,
                uv: black()?,
                triangle: black()?,
                position: black()?,
            }),
            false => None,
        };
        Ok(Self { color: black()?, aovs })
    }

    /// Its tiles, row by row.
    pub(super) fn tiles(&mut self) -> Vec<FrameTile<'_>> {
        let width = self.color.width() as usize;
        let color = tiles_of(self.color.pixels_mut(), width);
        let mut tiles: Vec<FrameTile<'_>> =
            color.into_iter().map(|color| FrameTile { color, aovs: Vec::new() }).collect();
        if let Some(Aovs { normals, depth, albedo, uv, triangle, position }) = &mut self.aovs {
            for image in [normals, depth, albedo, uv, triangle, position] {
                for (tile, rows) in tiles.iter_mut().zip(tiles_of(image.pixels_mut(), width)) {
                    tile.aovs.push(rows);
                }
            }
        }
        tiles
    }
}

/// The rows of pixels of a tile in an image.
pub(super) struct TileRows<'p, T>(Vec<&'p mut [T]>);

/// Returns the tiles of an image of this width, row by row.
pub(super) fn tiles_of<T>(pixels: &mut [T], width: usize) -> Vec<TileRows<'_, T>> {
    let (side, across) = (TILE_SIZE as usize, width.div_ceil(TILE_SIZE as usize));
    let mut tiles = Vec::with_capacity(across * pixels.len().div_ceil(width.max(1) * side));
    for band in pixels.chunks_mut(width.max(1) * side) {
        let first = tiles.len();
        tiles.extend((0..across).map(|_| TileRows(Vec::with_capacity(side))));
        for row in band.chunks_mut(width.max(1)) {
            for (tile, part) in tiles[first..].iter_mut().zip(row.chunks_mut(side)) {
                tile.0.push(part);
            }
        }
    }
    tiles
}

impl<T: Copy> TileRows<'_, T> {
    /// Writes a tile whose rows are [`TILE_SIZE`] long, cropped to the available size.
    pub(super) fn write(&mut self, pixels: &[T]) {
        for (to, from) in self.0.iter_mut().zip(pixels.chunks_exact(TILE_SIZE as usize)) {
            to.copy_from_slice(&from[..to.len()]);
        }
    }
}

/// The pixels of a tile, row by row with [`TILE_SIZE`] pixels per row.
#[derive(Default)]
pub(super) struct Resolve {
    /// The colour, linear, premultiplied.
    pub color: Vec<[f32; 4]>,
    /// Normals, depth, albedo, uv, triangle, position; empty if not requested.
    aovs: [Vec<[f32; 4]>; 6],
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
    /// The radiance, linear RGB, premultiplied by the part of the pixel that is surface.
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
    pub(super) fn keep(&mut self, visible: VisibleBatch<'_>, material: &Material, batch: &Batch) {
        self.layers.extend(visible.pixels().enumerate().map(|(i, (pixel, span))| {
            let opacity = opacity(material.alpha, batch.material.alpha[i]);
            Shaded {
                pixel,
                triangle: span.triangle,
                depth: span.depth,
                radiance: get3(&batch.lit.radiance, i) * opacity,
                coverage: opacity * (1.0 - passed(material, batch, i)),
            }
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
                let source = [r, g, b, fragment.coverage];
                let behind = 1.0 - fragment.coverage;
                color = std::array::from_fn(|c| source[c] + color[c] * behind);
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
        material: &Material,
        batch: &Batch,
        view: &View,
    ) {
        let [normals, depth, albedo, uv, triangle, position] = &mut self.aovs;
        if normals.is_empty() {
            return;
        }
        for (i, (pixel, span)) in visible.pixels().enumerate() {
            let opacity = opacity(material.alpha, batch.material.alpha[i]);
            if opacity * (1.0 - passed(material, batch, i)) < 0.5 {
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
            let id = span.triangle;
            triangle[pixel] = [id as f32, (id >> 16) as f32, (id & 0xffff) as f32, 1.0];
            position[pixel] = with_one(get3(&batch.geometry.position, i));
        }
    }
}

fn clear(plane: &mut Vec<[f32; 4]>) {
    plane.clear();
    plane.resize(TILE_PIXELS, [0.0; 4]);
}

/// The part of a fragment that is surface.
fn opacity(mode: AlphaMode, alpha: f32) -> f32 {
    match mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        AlphaMode::Blend => alpha.clamp(0.0, 1.0),
    }
}

/// The share of light from behind that passes through the surface of entry `i`.
fn passed(material: &Material, batch: &Batch, i: usize) -> f32 {
    if !material.transmits() {
        return 0.0;
    }
    let values = &batch.material;
    let passed = PassedLight {
        transmission: values.transmission[i],
        metallic: values.metallic[i],
        base_color: get3(&batch.lit.albedo, i),
        f0: MaterialUniforms::new(material).dielectric_f0 * values.specular[i],
    };
    passed.share()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_belongs_to_the_tile_that_holds_it() {
        let (width, height) = (150, 70);
        let mut pixels = vec![0; width * height];
        let tiles = tiles_of(&mut pixels, width);
        assert_eq!(tiles.len(), 6);
        for (number, mut tile) in tiles.into_iter().enumerate() {
            tile.write(&[number + 1; 64 * 64]);
        }
        for (i, pixel) in pixels.iter().enumerate() {
            let (x, y) = (i % width, i / width);
            assert_eq!(*pixel, y / 64 * 3 + x / 64 + 1, "{x}, {y}");
        }
    }
}
