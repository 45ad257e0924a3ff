//! How a model is packed.

use crate::error::{Error, Result};
use std::fmt;

/// The packing of textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum GltfImages {
    /// PNG, as precise as the bitmap; every program reads it.
    #[default]
    Png,
    /// WebP (EXT_texture_webp), smaller, and lossless unless [`GltfFormat::webp_quality`] is given; 16 bits are rounded
    /// to 8. Programs that do not know the extension cannot read the file.
    WebP,
    /// KTX2 of UASTC blocks with mip levels (KHR_texture_basisu), each under Zstandard: less than a byte a texel in the
    /// file, a byte on graphics cards, and lossy; 16 bits are rounded to 8, and sides must be multiples of 4. Images with
    /// alpha that is read are PNG. Programs that do not know the extension cannot read the file.
    Ktx2,
}

impl fmt::Display for GltfImages {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png => "PNG",
            Self::WebP => "WebP",
            Self::Ktx2 => "KTX2",
        })
    }
}

/// A lossy format of images and its quality, 1 to 100.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Lossy {
    /// WebP, smaller; its hues have half of the texels, and alpha loses nothing.
    WebP(u8),
    /// JPEG 4:4:4, nearer in high qualities; it holds no alpha.
    Jpeg(u8),
}

impl Lossy {
    /// Returns the quality.
    pub fn quality(self) -> u8 {
        match self {
            Self::WebP(quality) | Self::Jpeg(quality) => quality,
        }
    }
}

impl fmt::Display for Lossy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WebP(quality) => write!(f, "WebP {quality}"),
            Self::Jpeg(quality) => write!(f, "JPEG {quality}"),
        }
    }
}

/// The options for writing a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GltfFormat {
    /// The packing of textures.
    pub images: GltfImages,
    /// The quality, 1 to 100, of base colour and emission as lossy WebP; `None` loses nothing. Alpha always is
    /// lossless. For WebP only.
    pub webp_quality: Option<u8>,
    /// What the normal map may lose. For WebP only.
    pub normals: Option<Lossy>,
    /// What roughness, metallic and occlusion may lose, whose channels blur together. For WebP only.
    pub numbers: Option<Lossy>,
    /// `true` where the search for repetitions in lossless WebP is shorter: it takes less than half the time, and the file
    /// about 3 % more bytes. For WebP only.
    pub quick_webp: bool,
    /// The rate–distortion optimisation of UASTC, 1 to 64: blocks repeat what earlier ones hold where Zstandard then saves
    /// enough. The mean square error of a block rises by its square at most, of 255². Normals are left out. For KTX2 only.
    pub uastc_rdo: Option<u8>,
    /// The quality, 1 to 100, of the base colour as JPEG, which is lossy and which every program reads; `None` packs it
    /// as `images` says. Normals and other numbers are JPEG if `normals` and `numbers` say so.
    pub jpeg: Option<u8>,
    /// Packs meshes by EXT_meshopt_compression: positions, normals and tangents in the bits of [`GltfFormat::bits`]; uvs
    /// and colours in 16 bits where they lie in [0, 1]. Vertices and triangles are sorted anew. Programs that do not know
    /// the extension cannot read the file.
    pub meshopt: bool,
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
    /// Checks that each number is in its range and that the packing of textures reads it.
    ///
    /// # Errors
    /// [`Error::Invalid`], which names the number.
    pub fn check(&self) -> Result<()> {
        let numbers = [
            Number { what: "a JPEG quality", given: self.jpeg, most: 100, of: None },
            Number {
                what: "a WebP quality",
                given: self.webp_quality,
                most: 100,
                of: Some(GltfImages::WebP),
            },
            Number {
                what: "a quality of normals",
                given: self.normals.map(Lossy::quality),
                most: 100,
                of: Some(GltfImages::WebP),
            },
            Number {
                what: "a quality of numbers",
                given: self.numbers.map(Lossy::quality),
                most: 100,
                of: Some(GltfImages::WebP),
            },
            Number { what: "an RDO of UASTC", given: self.uastc_rdo, most: 64, of: Some(GltfImages::Ktx2) },
        ];
        numbers.iter().try_for_each(|number| number.check(self.images))?;
        self.bits.check()
    }
}

/// A number of a format.
struct Number {
    what: &'static str,
    given: Option<u8>,
    /// The largest; 1 is the least.
    most: u8,
    /// The packing that reads it, where not all do.
    of: Option<GltfImages>,
}

impl Number {
    fn check(&self, images: GltfImages) -> Result<()> {
        let Some(given) = self.given else { return Ok(()) };
        let what = format!("{} of {given}", self.what);
        if !(1..=self.most).contains(&given) {
            return Err(Error::invalid(what, format!("give 1 to {}", self.most)));
        }
        match self.of {
            Some(of) if of != images => {
                Err(Error::invalid(what, format!("textures are {images}; choose {of}, or leave it out")))
            }
            _ => Ok(()),
        }
    }
}
