//! An image by paths of light, tile by tile: starts the paths of a tile and sums their light.

use super::super::frame::Frame;
use super::super::prepare::Prepared;
use super::super::renderer::variables;
use super::super::settings::{RenderSettings, Shot};
use super::ReferenceSettings;
use super::tracer::Tracer;
use super::walk::{Path, PathScratch};
use crate::error::Result;
use crate::image::Image;
use crate::math::Vec3;
use crate::math::integration::{Sequence, hash};
use crate::parallel;
use crate::progress::Progress;

/// Renders an image by following paths of light. The same settings give the same bits with any number of threads.
///
/// Of the shot's settings, the number of samples and `specular_aa` are ignored, since many paths average subpixel
/// detail. Without shadows, lights shine through everything, as in the rasteriser; environment and surfaces always
/// cast shadows. [`Lighting::ambient`](super::super::Lighting::ambient) is reflected at every surface. Cameras see
/// single-sided surfaces from their front; light hits both sides of all. The frame's output variables are the
/// rasteriser's.
///
/// # Errors
/// [`crate::Error::Cancelled`]; [`crate::Error::Invalid`] or [`crate::Error::Limit`] for an invalid size, camera or
/// number of paths, [`crate::Error::Unsupported`] for a SIMD level that the CPU lacks.
pub fn reference(
    prepared: &Prepared,
    shot: &Shot<'_>,
    paths: &ReferenceSettings,
    progress: Progress<'_>,
) -> Result<Frame> {
    let ready = prepared.ready();
    let draws = ready.draws();
    let tracer = Tracer::new(ready, &draws, shot, paths)?;
    let mut frame = Frame::new(&RenderSettings { aovs: false, ..shot.settings.clone() })?;
    let tiles = tiles(shot.settings);
    // The number of paths between two reports does not affect pixels.
    let at_once = 8 * rayon::current_num_threads();
    let mut done = 0;
    for part in tiles.chunks(at_once) {
        let before = done as f64 / tiles.len() as f64;
        let go_on = || progress.at(before);
        for (tile, pixels) in part.iter().zip(parallel::tasks(part.len(), &|i| tracer.tile(&part[i], &go_on)))
        {
            pixels?.store(tile, &mut frame);
        }
        done += part.len();
        progress.at(done as f64 / tiles.len() as f64)?;
    }
    frame.aovs = variables(ready, shot)?;
    Ok(frame)
}

/// The side length of a tile in pixels.
const SIDE: u32 = 16;

/// The number of paths per pixel that are followed together.
const TOGETHER: u32 = 4;

/// A tile of the image, in pixels.
#[derive(Debug, Clone, Copy)]
struct ImageTile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

/// A tile's pixels, row by row.
struct TilePixels {
    color: Vec<[f32; 4]>,
}

/// The tiles of an image, row by row.
fn tiles(settings: &RenderSettings) -> Vec<ImageTile> {
    let (width, height) = (settings.width, settings.height);
    let rows = (0..height).step_by(SIDE as usize);
    rows.flat_map(|y| (0..width).step_by(SIDE as usize).map(move |x| (x, y)))
        .map(|(x, y)| ImageTile { x, y, width: SIDE.min(width - x), height: SIDE.min(height - y) })
        .collect()
}

impl Tracer<'_> {
    /// Follows all paths of a tile, until `go_on` returns an error: many paths per pixel may take minutes.
    fn tile(&self, tile: &ImageTile, go_on: &dyn Fn() -> Result<()>) -> Result<TilePixels> {
        let pixels = (tile.width * tile.height) as usize;
        let mut sums = vec![[0.0f64; 4]; pixels];
        let mut work = PathScratch::new(self.sources.len());
        let spp = self.reference.spp;
        for first in (0..spp).step_by(TOGETHER as usize) {
            go_on()?;
            let indices = first..(first + TOGETHER).min(spp);
            let mut paths: Vec<Path> = indices.flat_map(|index| self.begin(tile, index)).collect();
            self.walk(&mut paths, &mut work);
            for path in &paths {
                let sum = &mut sums[path.pixel as usize];
                let [r, g, b] = path.light.to_array();
                for (sum, value) in sum.iter_mut().zip([r, g, b, path.coverage]) {
                    *sum += f64::from(value);
                }
            }
        }
        let color = sums.iter().map(|sum| sum.map(|v| (v / f64::from(spp)) as f32)).collect();
        Ok(TilePixels { color })
    }

    /// Starts the path with index `index` of each pixel.
    fn begin(&self, tile: &ImageTile, index: u32) -> impl Iterator<Item = Path> {
        let ImageTile { x, y, width, height } = *tile;
        (0..width * height).map(move |pixel| {
            let (x, y) = (x + pixel % width, y + pixel / width);
            let seed = hash(hash(hash(self.reference.seed, 0), x), y);
            let sequence = Sequence::new(seed);
            let [dx, dy, ..] = sequence.four(index, 0);
            let ray = self.camera.through([f64::from(x) + f64::from(dx), f64::from(y) + f64::from(dy)]);
            Path {
                pixel,
                index,
                sequence,
                shadows: hash(seed, index),
                origin: ray.origin,
                direction: ray.direction,
                limit: ray.limit,
                pdf: 0.0,
                below: false,
                throughput: Vec3::splat(1.0),
                light: Vec3::default(),
                coverage: 0.0,
            }
        })
    }
}

impl TilePixels {
    /// Writes its pixels to the frame.
    fn store(&self, tile: &ImageTile, frame: &mut Frame) {
        copy(&mut frame.color, tile, &self.color);
    }
}

fn copy(image: &mut Image, tile: &ImageTile, pixels: &[[f32; 4]]) {
    let (across, width) = (image.width() as usize, tile.width as usize);
    for (row, pixels) in pixels.chunks(width).enumerate() {
        let start = (tile.y as usize + row) * across + tile.x as usize;
        image.pixels_mut()[start..start + width].copy_from_slice(pixels);
    }
}
