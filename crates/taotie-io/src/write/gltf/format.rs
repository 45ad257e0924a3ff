//! The options for writing a model: the codecs that it may require, and the bits of packed vertices.

use super::codec::{CodecKind, TextureCodecs};
use taotie_engine::error::{Error, Result};
use taotie_engine::names::Named;

/// The options for writing a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GltfFormat {
    /// The formats of textures.
    pub images: TextureCodecs,
    /// `true` for the model within a page: lossless WebP takes less than half the time, for about 3 % more bytes; and
    /// opaque colours and normals of a scene that are unchanged since they were read from JPEG or WebP are stored as
    /// those files, without metadata. Other numbers, such as roughness, are stored without another loss.
    pub for_page: bool,
    /// Packs meshes with meshoptimizer: positions, normals and tangents with the bits of [`GltfFormat::bits`]; uvs
    /// and colours with 16 bits if they are in [0, 1]. Vertices and triangles are reordered. Programs without the
    /// extension cannot read the file.
    pub meshopt: bool,
    /// The codec set, which determines the extension for packing meshes.
    pub codecs: CodecSet,
    /// The bits of packed vertices. Only for meshopt.
    pub bits: VertexBits,
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

/// The bits of packed vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
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

/// The codecs that an asset may require.
///
/// ```
/// use taotie_engine::names::Named;
/// use taotie_io::{CodecKind, CodecSet};
///
/// assert!(CodecSet::WebLatest.images().contains(&CodecKind::Avif));
/// assert_eq!(CodecSet::from_name("portable")?, CodecSet::default());
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CodecSet {
    /// Supported by most programs: PNG, JPEG and WebP; EXT_meshopt_compression.
    #[default]
    Portable,
    /// Supported by the newest web viewers: AVIF as well; KHR_meshopt_compression, whose vertices take fewer bytes.
    /// EXT_texture_avif is not ratified, and KHR_meshopt_compression is a release candidate.
    WebLatest,
}

impl Named for CodecSet {
    const WHAT: &'static str = "set of codecs";
    const NAMES: &'static [(&'static str, Self)] =
        &[("portable", Self::Portable), ("web-latest", Self::WebLatest)];
}

impl CodecSet {
    /// Returns the image formats of the set.
    pub fn images(self) -> &'static [CodecKind] {
        match self {
            Self::Portable => &[CodecKind::Png, CodecKind::Jpeg, CodecKind::WebP],
            Self::WebLatest => &[CodecKind::Png, CodecKind::Jpeg, CodecKind::WebP, CodecKind::Avif],
        }
    }

    /// Returns the geometry compression extension.
    pub(super) fn meshopt(self) -> &'static str {
        match self {
            Self::Portable => "EXT_meshopt_compression",
            Self::WebLatest => "KHR_meshopt_compression",
        }
    }

    /// Returns the version of meshoptimizer's vertex codec that this extension allows.
    pub(super) fn vertex_version(self) -> i32 {
        match self {
            Self::Portable => 0,
            Self::WebLatest => 1,
        }
    }
}
