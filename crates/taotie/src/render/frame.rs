//! The finished image and its arbitrary output variables.

use super::resolve::Resolve;
use super::settings::RenderSettings;
use super::tiles::{TileRows, tiles_of};
use crate::error::Result;
use crate::image::Image;

/// A finished image.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Linear radiance, premultiplied by coverage, which is the fourth channel.
    pub color: Image,
    /// The surface data at the first sample of each pixel, if requested.
    pub aovs: Option<Aovs>,
}

/// The surface data at the first sample of each pixel. The fourth channel is 1 if a surface is visible.
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
    /// The triangle's index over all instances, from 0, in the first three channels; exact up to 2^24.
    pub triangle: Image,
}

impl Aovs {
    /// The names on the command line with their images.
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
        if let Some(Aovs { normals, depth, albedo, uv, triangle }) = &mut self.aovs {
            for image in [normals, depth, albedo, uv, triangle] {
                for (tile, rows) in tiles.iter_mut().zip(tiles_of(image.pixels_mut(), width)) {
                    tile.aovs.push(rows);
                }
            }
        }
        tiles
    }
}
