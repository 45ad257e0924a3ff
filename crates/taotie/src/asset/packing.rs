//! The packing of an asset into files.

use crate::error::Result;
use crate::io::{CodecSet, GltfFormat, TextureCodecs, VertexBits, XmpProperties};
use crate::scene::GreenChannel;
use std::path::PathBuf;

/// The packing of an asset into files. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Asset, Packing, Written};
/// use taotie::io::ImageCodec;
/// use taotie::{Progress, Result};
///
/// /// Writes a small file, for viewers that know the extensions of glTF.
/// fn write_small(asset: &Asset) -> Result<Written> {
///     let packing = Packing { images: ImageCodec::WebP.into(), meshopt: true, ..Packing::default() };
///     asset.write("small.glb", &packing, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Packing {
    /// The formats of textures; KTX2 needs maps whose sides are multiples of 4.
    pub images: TextureCodecs,
    /// Compresses geometry by meshoptimizer, but not that of a low-poly file that stays as it is.
    pub meshopt: bool,
    /// The set of codecs, which says by which extension geometry is compressed.
    pub codecs: CodecSet,
    /// The bits of compressed vertices. See [`GltfFormat::bits`].
    pub bits: VertexBits,
    /// A JSON file of XMP properties, such as `dc:title`, that the asset is to bear beside those of the scan. Where the
    /// scan has no copyright notice, `dc:rights` is the asset's.
    pub provenance: Option<PathBuf>,
    /// The direction of green in maps for other programs. `Down` (DirectX) writes the tangent-space normal map once more
    /// beside the asset, as `scan.normal.png`, and bent normals so; the asset's own points up, as glTF demands.
    pub green: GreenChannel,
}

impl Packing {
    /// Checks what can be known before a bake begins: that qualities are in their ranges and read, and that the properties
    /// of [`Packing::provenance`] can be read and used.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io), [`Error::Parse`](crate::Error::Parse) where the file is no JSON, and
    /// [`Error::Invalid`](crate::Error::Invalid) where a property has no known prefix, or a value of no form that
    /// programs read, and for a quality.
    pub fn check(&self) -> Result<()> {
        self.format().check()?;
        self.provenance.as_deref().map_or(Ok(()), |path| XmpProperties::read(path).map(drop))
    }

    /// Returns the packing with another format of the model's own file.
    pub(super) fn with_format(self, format: &GltfFormat) -> Self {
        let GltfFormat { images, meshopt, codecs, bits, quick_webp: _ } = *format;
        Self { images, meshopt, codecs, bits, ..self }
    }

    /// Returns the packing of the model's own file.
    pub(super) fn format(&self) -> GltfFormat {
        let Self { images, meshopt, codecs, bits, .. } = *self;
        GltfFormat { images, quick_webp: false, meshopt, codecs, bits }
    }
}
