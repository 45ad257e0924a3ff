//! Images: linear float images, stored texel arrays, mip chains and filtered lookup.
//!
//! An [`Image`] is the output of rendering and the input of comparisons, a [`Bitmap`] the content of a file. A
//! [`Texture`] is a bitmap that is looked up through a [`Sampler`].

mod bitmap;
mod codec;
mod filter;
mod lookup;
mod sampler;
mod texture;

pub use bitmap::{Bitmap, Encoding, Texels};
pub(crate) use lookup::{Lookup, LookupPoints};
pub use sampler::{MipFilter, Sampler, TexelFilter, Wrap};
pub use texture::Texture;

use crate::error::{Error, Result};

/// A linear RGBA image, row by row from the top. Colour is premultiplied if alpha means coverage.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 4]>,
}

impl Image {
    /// The largest width or height.
    pub const MAX_SIDE: u32 = 16_384;

    /// Creates an image with every pixel equal to `fill`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a side is zero, [`Error::Limit`] if one is above [`Image::MAX_SIDE`].
    pub fn new(width: u32, height: u32, fill: [f32; 4]) -> Result<Self> {
        Self::check_size(width, height)?;
        Ok(Self { width, height, pixels: vec![fill; width as usize * height as usize] })
    }

    /// Creates an image of these pixels, row by row from the top.
    ///
    /// # Errors
    /// As for [`Image::new`]; [`Error::Invalid`] if the number of pixels is not `width · height`.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<[f32; 4]>) -> Result<Self> {
        Self::check_size(width, height)?;
        if pixels.len() != width as usize * height as usize {
            return Err(Error::invalid("image", format!("{} pixels for {width}×{height}", pixels.len())));
        }
        Ok(Self { width, height, pixels })
    }

    /// Checks that an image of this size is allowed.
    ///
    /// # Errors
    /// As for [`Image::new`].
    pub fn check_size(width: u32, height: u32) -> Result<()> {
        if width == 0 || height == 0 {
            return Err(Error::invalid(
                format!("size {width}x{height}"),
                "both sides must be at least 1, such as 1024x1024",
            ));
        }
        if width > Self::MAX_SIDE || height > Self::MAX_SIDE {
            let why = format!("at most {0}x{0}", Self::MAX_SIDE);
            return Err(Error::limit(format!("an image of {width}x{height}"), why));
        }
        Ok(())
    }

    /// The width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// All pixels, mutably.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 4]] {
        &mut self.pixels
    }

    /// The pixel in column `x` of row `y`.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 4] {
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}
