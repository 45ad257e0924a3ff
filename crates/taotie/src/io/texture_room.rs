//! Counts the memory for textures before they are made from images.

use super::reading::Reading;
use crate::image::{Bitmap, Encoding, Texels, Texture};

/// Makes a texture from an image whose texels and mip levels were counted when it was read; `None` if its additional
/// needs do not fit in memory.
pub(super) fn texture(reading: &Reading, bitmap: Bitmap, encoding: Encoding) -> Option<Texture> {
    count_first(reading, &bitmap, encoding).then(|| Texture::new(bitmap, encoding))
}

/// Makes a texture from an image combined from others, and counts all of it; `None` if it does not fit in memory.
pub(super) fn combined(reading: &Reading, bitmap: Bitmap, encoding: Encoding) -> Option<Texture> {
    count_copy(reading, &bitmap, encoding).then(|| Texture::new(bitmap, encoding))
}

/// Counts the needs of an image's first texture beyond those counted when it was read; returns `true` if they fit.
pub(super) fn count_first(reading: &Reading, bitmap: &Bitmap, encoding: Encoding) -> bool {
    // When it is read, its encoding is unknown.
    let counted = bytes(bitmap.texels(), Encoding::Linear);
    reading.take(bytes(bitmap.texels(), encoding) - counted)
}

/// Counts all of a texture of a copied image; returns `true` if it fits.
pub(super) fn count_copy(reading: &Reading, bitmap: &Bitmap, encoding: Encoding) -> bool {
    reading.take(bytes(bitmap.texels(), encoding))
}

/// Returns the peak number of bytes for texels and everything that a texture makes from them. Mip levels are a third
/// of the finest; those of 8-bit normals have 16 bits.
fn bytes(texels: &Texels, encoding: Encoding) -> u64 {
    let per_texel = match (texels, encoding) {
        (Texels::U8(_), _) => 4 + 3,
        // It is converted to float before it is freed.
        (Texels::U16(_), Encoding::Srgb) => 8 + 16,
        (Texels::U16(_), _) => 8 + 3,
        (Texels::F32(_), _) => 16 + 6,
    };
    texels.len() as u64 * per_texel
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Bytes, Limits};
    use std::path::Path;

    fn reading(memory: u64) -> Reading {
        Reading::new(Path::new("a.png"), &Limits { memory: Some(Bytes(memory)), ..Limits::default() })
    }

    #[test]
    fn deep_colours_become_float_and_that_counts() {
        let bitmap = Bitmap::new(8, 8, 3, Texels::U16(vec![[1, 2, 3, 4]; 64])).unwrap();
        // 11 of 24 bytes per texel were counted when the image was read.
        assert!(texture(&reading(13 * 64), bitmap.clone(), Encoding::Srgb).is_some());
        assert!(texture(&reading(13 * 64 - 1), bitmap.clone(), Encoding::Srgb).is_none());
        assert!(texture(&reading(1), bitmap.clone(), Encoding::Linear).is_some());
        assert!(combined(&reading(11 * 64 - 1), bitmap.clone(), Encoding::Normal).is_none());
        assert!(combined(&reading(11 * 64), bitmap, Encoding::Normal).is_some());
    }

    #[test]
    fn what_is_counted_holds_all_levels() {
        for texels in [
            Texels::U8(vec![[128, 128, 255, 255]; 4096]),
            Texels::U16(vec![[1, 2, 3, 4]; 4096]),
            Texels::F32(vec![[0.5; 4]; 4096]),
        ] {
            for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Normal] {
                let counted = bytes(&texels, encoding);
                let texture = Texture::new(Bitmap::new(64, 64, 4, texels.clone()).unwrap(), encoding);
                let held = texture.bytes();
                assert!(held <= counted && 2 * held > counted, "{encoding:?}: {held} of {counted}");
            }
        }
    }
}
