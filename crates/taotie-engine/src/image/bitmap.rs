//! Texels as stored in a file, and the meaning of their numbers.

use crate::error::{Error, Result};
use std::sync::Arc;

/// RGBA texels in one of the stored precisions, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// 8-bit unsigned, 255 is one.
    U8(Vec<[u8; 4]>),
    /// 16-bit unsigned, 65535 is one.
    U16(Vec<[u16; 4]>),
    /// Float, unbounded.
    F32(Vec<[f32; 4]>),
}

impl Texels {
    /// The number of texels.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(t) => t.len(),
            Self::U16(t) => t.len(),
            Self::F32(t) => t.len(),
        }
    }

    /// Returns true if there are no texels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the memory that they occupy in bytes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::U8(t) => size_of_val(t.as_slice()) as u64,
            Self::U16(t) => size_of_val(t.as_slice()) as u64,
            Self::F32(t) => size_of_val(t.as_slice()) as u64,
        }
    }
}

/// A decoded image file: texels in stored precision and encoding, origin top left. Bitmaps with the same texels are
/// equal, regardless of their files.
#[derive(Debug, Clone)]
pub struct Bitmap {
    width: u32,
    height: u32,
    channels: u8,
    texels: Texels,
    file: Option<Arc<[u8]>>,
}

impl PartialEq for Bitmap {
    fn eq(&self, other: &Self) -> bool {
        let shape = |of: &Self| (of.width, of.height, of.channels);
        shape(self) == shape(other) && self.texels == other.texels
    }
}

impl Bitmap {
    /// The largest width or height.
    pub const MAX_SIDE: u32 = 32_768;

    /// Checks the size. `channels` is the number of channels in the file: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a side is zero or the number of texels is not `width · height`, [`Error::Limit`] if a
    /// side is above [`Bitmap::MAX_SIDE`].
    pub fn new(width: u32, height: u32, channels: u8, texels: Texels) -> Result<Self> {
        if width == 0 || height == 0 {
            return Err(Error::invalid(
                "image",
                format!("its size is {width}×{height}; both sides must be above 0"),
            ));
        }
        if width > Self::MAX_SIDE || height > Self::MAX_SIDE {
            let why = format!("at most {0}×{0}; scale it down", Self::MAX_SIDE);
            return Err(Error::limit(format!("an image of {width}×{height}"), why));
        }
        if texels.len() != width as usize * height as usize {
            return Err(Error::invalid("image", format!("{} texels for {width}×{height}", texels.len())));
        }
        Ok(Self { width, height, channels, texels, file: None })
    }

    /// Keeps the compressed file that the bitmap was decoded from, so that it can be stored without another loss.
    #[must_use]
    pub fn with_file(self, file: Arc<[u8]>) -> Self {
        Self { file: Some(file), ..self }
    }

    /// The compressed file that decodes to these texels, if the reader kept it.
    pub fn file(&self) -> Option<&[u8]> {
        self.file.as_deref()
    }

    /// The width in texels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The height in texels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The number of channels in the file, 1 to 4.
    pub fn channels(&self) -> u8 {
        self.channels
    }

    /// The texels as stored.
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// Converts the bitmap to its texels.
    pub fn into_texels(self) -> Texels {
        self.texels
    }

    /// The channels of texel `i` as stored, 1 being the maximum of an integer type; nothing is decoded.
    #[inline]
    pub fn stored(&self, i: usize) -> [f32; 4] {
        match &self.texels {
            Texels::U8(t) => t[i].map(|v| f32::from(v) / 255.0),
            Texels::U16(t) => t[i].map(|v| f32::from(v) / 65535.0),
            Texels::F32(t) => t[i],
        }
    }

    /// Returns true if some texel is not opaque: if the file contained alpha, and it is below one anywhere.
    pub fn has_alpha(&self) -> bool {
        matches!(self.channels, 2 | 4) && (0..self.texels.len()).any(|i| self.stored(i)[3] < 1.0)
    }

    /// Bits per channel: 8, 16 or 32.
    pub fn bits(&self) -> u8 {
        match self.texels {
            Texels::U8(_) => 8,
            Texels::U16(_) => 16,
            Texels::F32(_) => 32,
        }
    }
}

/// The meaning of stored numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colour encoded by the sRGB transfer function; alpha is linear.
    Srgb,
    /// Linear numbers: roughness, heights.
    Linear,
    /// Unit vectors, (n + 1)/2. Coarser levels contain the mean of the unit vectors below, which is shorter the more
    /// they diverge, and in the fourth channel their variance 1 − |mean|²; the finest level has none.
    Normal,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_counts_where_the_file_held_it() {
        let has = |channels: u8, alpha: u8| {
            let texels = Texels::U8(vec![[0, 0, 0, 255], [0, 0, 0, alpha]]);
            Bitmap::new(2, 1, channels, texels).unwrap().has_alpha()
        };
        assert_eq!([1, 2, 3, 4].map(|channels| has(channels, 254)), [false, true, false, true]);
        assert_eq!([2, 4].map(|channels| has(channels, 255)), [false; 2]);
    }
}
