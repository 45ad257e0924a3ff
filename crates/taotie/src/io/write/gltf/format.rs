//! The options for packing a model.

use super::codec::TextureCodecs;
use super::codec_set::CodecSet;
use crate::error::{Error, Result};

/// The options for writing a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GltfFormat {
    /// The formats of textures.
    pub images: TextureCodecs,
    /// `true` for a shorter search for repetitions in lossless WebP: less than half the time, for about 3 % more
    /// bytes.
    pub quick_webp: bool,
    /// Packs meshes with meshoptimizer: positions, normals and tangents with the bits of [`GltfFormat::bits`]; uvs
    /// and colours with 16 bits if they are in [0, 1]. Vertices and triangles are reordered. Programs without the
    /// extension cannot read the file.
    pub meshopt: bool,
    /// The codec set, which determines the extension for packing meshes.
    pub codecs: CodecSet,
    /// The bits of packed vertices. Only for meshopt.
    pub bits: VertexBits,
}

/// The bits of packed vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct VertexBits {
    /// Bits per position coordinate, 8 to 16: 2^bits − 1 steps along the longest side of the bounding box of all
    /// levels.
    pub positions: u8,
    /// Bits per octahedral coordinate of a normal, 6 to 12. 8 bits are accurate to 0.95°, 0.24° on average, 12 bits
    /// to 0.05°. Up to 8, a vertex takes half as many bytes before compression. Tangents have two bits fewer, at
    /// least 6: a normal map turns normals by only a small part of a tangent's error.
    pub normals: u8,
    /// Bits per uv coordinate, 8 to 16: steps of 2^−bits of the texture, as floats with the exponential filter. With
    /// 16, uvs in [0, 1] are integers and others are unchanged.
    pub uvs: u8,
}

impl Default for VertexBits {
    fn default() -> Self {
        Self { positions: 16, normals: 12, uvs: 16 }
    }
}

impl VertexBits {
    /// Returns the bits of tangents.
    pub(super) fn tangents(self) -> u8 {
        (self.normals - 2).max(6)
    }

    /// Checks that all numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the number.
    pub fn check(self) -> Result<()> {
        let Self { positions, normals, uvs } = self;
        let numbers =
            [("positions", positions, [8, 16]), ("normals", normals, [6, 12]), ("uvs", uvs, [8, 16])];
        let wrong = numbers.into_iter().find(|(_, bits, [least, most])| !(*least..=*most).contains(bits));
        match wrong {
            Some((what, bits, [least, most])) => {
                Err(Error::invalid(format!("{what} with {bits} bits"), format!("use {least} to {most}")))
            }
            None => Ok(()),
        }
    }
}

impl GltfFormat {
    /// Checks that all numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the number.
    pub fn check(&self) -> Result<()> {
        self.images.check()?;
        self.bits.check()
    }
}
