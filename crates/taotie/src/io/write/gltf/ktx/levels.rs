//! Encodes the mip levels of a texture as blocks.

use super::block::{Block, Tile};
use super::rdo;
use crate::image::{Encoding, Texels, Texture};
use crate::math::Vec3;
use crate::math::srgb::srgb_from_linear;
use crate::parallel;

/// A mip level of a texture.
#[derive(Clone, Copy)]
pub(super) struct MipLevel<'a> {
    pub texture: &'a Texture,
    pub level: usize,
}

impl MipLevel<'_> {
    /// Returns the blocks, row by row. `rdo` is as in [`ImageCodec::Ktx2`](crate::io::ImageCodec).
    pub fn blocks(&self, rdo: u8) -> Vec<u8> {
        let count = self.across() * self.texture.level_size(self.level).1.div_ceil(4) as usize;
        let nearest = |i: usize| {
            let tile = self.tile(i);
            Block::nearest(&tile).bytes(&tile)
        };
        if rdo == 0 {
            return parallel::collect(count, nearest).into_flattened();
        }
        let run = |run: usize| {
            let tiles: Vec<Tile> =
                (run * rdo::RUN..((run + 1) * rdo::RUN).min(count)).map(|i| self.tile(i)).collect();
            rdo::blocks(&tiles, rdo)
        };
        parallel::tasks(count.div_ceil(rdo::RUN), &run).concat().into_flattened()
    }

    /// Returns the number of blocks per row.
    fn across(&self) -> usize {
        self.texture.level_size(self.level).0.div_ceil(4) as usize
    }

    /// Returns the texels of block `i`. Texels beyond the border repeat those at the border.
    fn tile(&self, i: usize) -> Tile {
        let (width, height) = self.texture.level_size(self.level);
        let (x0, y0) = (i % self.across() * 4, i / self.across() * 4);
        std::array::from_fn(|k| {
            self.texel((x0 + k % 4).min(width as usize - 1), (y0 + k / 4).min(height as usize - 1))
        })
    }

    /// Returns a texel as stored in 8 bits.
    fn texel(&self, x: usize, y: usize) -> [u8; 3] {
        if let (0, Texels::U8(texels)) = (self.level, self.texture.bitmap().texels()) {
            let [r, g, b, _] = texels[y * self.texture.width() as usize + x];
            return [r, g, b];
        }
        let [r, g, b, _] = self.texture.texel(self.level, x, y);
        let code = |v: f64| (v * 255.0 + 0.5) as u8;
        match self.texture.encoding() {
            Encoding::Srgb => [r, g, b].map(|v| code(srgb_from_linear(v.into()))),
            Encoding::Linear => [r, g, b].map(|v| code(v.into())),
            // Means of unit vectors are shorter than 1.
            Encoding::Normal => {
                let mean = Vec3::new(r, g, b).to_f64() * 2.0 - Vec3::splat(1.0);
                mean.normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_array().map(|v| code(v * 0.5 + 0.5))
            }
        }
    }
}
