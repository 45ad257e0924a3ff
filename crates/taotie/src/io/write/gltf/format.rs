//! How a model is packed.

use super::codec::TextureCodecs;
use super::codec_set::CodecSet;
use crate::error::{Error, Result};

/// The options for writing a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GltfFormat {
    /// The formats of textures.
    pub images: TextureCodecs,
    /// `true` for a shorter search for repetitions in lossless WebP: it takes less than half the time, for about 3 % more bytes.
    pub quick_webp: bool,
    /// Packs meshes by meshoptimizer: positions, normals and tangents in the bits of [`GltfFormat::bits`]; uvs
    /// and colours in 16 bits where they lie in [0, 1]. Vertices and triangles are sorted anew. Programs that do not know
    /// the extension cannot read the file.
    pub meshopt: bool,
    /// The set of codecs, which says by which extension meshes are packed.
    pub codecs: CodecSet,
    /// The bits of packed vertices. For meshopt only.
    pub bits: VertexBits,
}

/// The bits of packed vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct VertexBits {
    /// Bits of each coordinate of a position, 8 to 16: 2^bits − 1 steps along the longest side of the box around all levels.
    pub positions: u8,
    /// Bits of each of the two octahedral coordinates of a normal, 6 to 12. 8 bits are within 0.95° and 0.24° on average, 12
    /// within 0.05°. Up to 8 a vertex takes half of the bytes before compression. Tangents have two bits less, at least 6: a
    /// normal map turns normals by a small part of what a tangent is off.
    pub normals: u8,
    /// Bits of each coordinate of a uv, 8 to 16: steps of 2^−bits of the texture, as floats under the exponential filter. With
    /// 16, uvs in [0, 1] are integers and others stay as they are.
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

    /// Checks that all numbers are in their ranges.
    ///
    /// # Errors
    /// [`Error::Invalid`], which names the number.
    pub fn check(self) -> Result<()> {
        let Self { positions, normals, uvs } = self;
        let numbers =
            [("positions", positions, [8, 16]), ("normals", normals, [6, 12]), ("uvs", uvs, [8, 16])];
        let wrong = numbers.into_iter().find(|(_, bits, [least, most])| !(*least..=*most).contains(bits));
        match wrong {
            Some((what, bits, [least, most])) => {
                Err(Error::invalid(format!("{what} of {bits} bits"), format!("give {least} to {most}")))
            }
            None => Ok(()),
        }
    }
}

impl GltfFormat {
    /// Checks that all numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`], which names the number.
    pub fn check(&self) -> Result<()> {
        self.images.check()?;
        self.bits.check()
    }
}
