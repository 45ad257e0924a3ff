//! The finished picture and its arbitrary output variables.

use super::RenderSettings;
use crate::error::Result;
use crate::image::Image;
use crate::raster::{TILE_SIZE, Tile};
use rayon::prelude::*;

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Linear radiance, premultiplied by coverage, which is the fourth channel.
    pub color: Image,
    /// What was seen at the first sample of each pixel, where asked for.
    pub aovs: Option<Aovs>,
}

/// What was seen at the first sample of each pixel. The fourth channel is 1 where something was.
#[derive(Debug, Clone)]
pub struct Aovs {
    /// Unit shading normals, world space, components in [-1, 1].
    pub normals: Image,
    /// Distance along the axis of sight, model units, in the first three channels.
    pub depth: Image,
    /// Base colour, linear RGB.
    pub albedo: Image,
    /// The first uv set in the first two channels, origin top left.
    pub uv: Image,
    /// The triangle's number over all instances, from 0, in the first three channels; exact up to 2^24.
    pub triangle: Image,
}

impl Aovs {
    /// The names on the command line with their pictures.
    pub fn named(&self) -> [(&'static str, &Image); 5] {
        [
            ("normals", &self.normals),
            ("depth", &self.depth),
            ("albedo", &self.albedo),
            ("uv", &self.uv),
            ("triangle", &self.triangle),
        ]
    }

    /// The names on the command line.
    pub const NAMES: [&'static str; 5] = ["normals", "depth", "albedo", "uv", "triangle"];
}

/// The pixels of a tile, row by row with [`TILE_SIZE`] to a row.
pub(super) struct TilePicture {
    pub color: Vec<[f32; 4]>,
    /// Normals, depth, albedo, uv, triangle; empty where not asked for.
    pub aovs: [Vec<[f32; 4]>; 5],
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
            }),
            false => None,
        };
        Ok(Self { color: black()?, aovs })
    }

    /// Writes the pictures of tiles, which come in the order of their numbers.
    pub(super) fn store(&mut self, pictures: &[(Tile, TilePicture)]) {
        copy(&mut self.color, pictures, |picture| &picture.color);
        if let Some(aovs) = &mut self.aovs {
            let images =
                [&mut aovs.normals, &mut aovs.depth, &mut aovs.albedo, &mut aovs.uv, &mut aovs.triangle];
            for (plane, image) in images.into_iter().enumerate() {
                copy(image, pictures, |picture| &picture.aovs[plane]);
            }
        }
    }
}

/// Copies one plane of each tile, rows of pixels in parallel.
fn copy(
    image: &mut Image,
    pictures: &[(Tile, TilePicture)],
    plane: impl Fn(&TilePicture) -> &Vec<[f32; 4]> + Sync,
) {
    let width = image.width() as usize;
    let bands = image.pixels_mut().par_chunks_mut(width * TILE_SIZE as usize).enumerate();
    bands.for_each(|(band, pixels)| {
        let top = band as u32 * TILE_SIZE;
        let start = pictures.partition_point(|(tile, _)| tile.y < top);
        for (tile, picture) in pictures[start..].iter().take_while(|(tile, _)| tile.y == top) {
            let (x, across) = (tile.x as usize, tile.width as usize);
            let rows = plane(picture).chunks_exact(TILE_SIZE as usize);
            for (to, from) in pixels.chunks_exact_mut(width).zip(rows) {
                to[x..x + across].copy_from_slice(&from[..across]);
            }
        }
    });
}
