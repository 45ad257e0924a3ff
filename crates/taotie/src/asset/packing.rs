//! The packing of an asset into files.

use crate::error::Result;
use crate::io::{CodecSet, GltfFormat, TextureCodecs, VertexBits, XmpProperties};
use crate::scene::GreenChannel;
use std::path::PathBuf;

/// The packing of an asset into files. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Asset, Packing, WrittenAsset};
/// use taotie::io::ImageCodec;
/// use taotie::{Progress, Result};
///
/// /// Writes a small file, for viewers that support the glTF extensions.
/// fn write_small(asset: &Asset) -> Result<WrittenAsset> {
///     let packing = Packing { images: ImageCodec::WebP.into(), meshopt: true, ..Packing::default() };
///     asset.write("small.glb", &packing, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Packing {
    /// The formats of textures; KTX2 needs maps whose sides are multiples of 4.
    pub images: TextureCodecs,
    /// Compresses geometry with meshoptimizer, except for that of a low-poly file that is kept as is.
    pub meshopt: bool,
    /// The set of codecs, which determines the extension for compressed geometry.
    pub codecs: CodecSet,
    /// The bits of compressed vertices. See [`GltfFormat::bits`].
    pub bits: VertexBits,
    /// A JSON file of XMP properties, such as `dc:title`, to add to those of the scan. If the scan has no copyright
    /// notice, `dc:rights` becomes the asset's.
    pub provenance: Option<PathBuf>,
    /// The direction of green in maps for other programs. `Down` (DirectX) writes the tangent-space normal map a
    /// second time next to the asset, as `scan.normal.png`, and bent normals likewise; the asset's own has green up,
    /// as glTF requires.
    pub green: GreenChannel,
}

impl Packing {
    /// Checks what can be known before a bake: that qualities are in range and used, and that the properties of
    /// [`Packing::provenance`] can be read and used.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io); [`Error::Parse`](crate::Error::Parse) if the file is not valid JSON; and
    /// [`Error::Invalid`](crate::Error::Invalid) if a property has an unknown prefix or a value of an unsupported
    /// form, and for an invalid quality.
    pub fn check(&self) -> Result<()> {
        self.format().check()?;
        self.provenance.as_deref().map_or(Ok(()), |path| XmpProperties::read(path).map(drop))
    }

    /// Returns the packing with a different format for the model file.
    pub(super) fn with_format(self, format: &GltfFormat) -> Self {
        let GltfFormat { images, meshopt, codecs, bits, quick_webp: _ } = *format;
        Self { images, meshopt, codecs, bits, ..self }
    }

    /// Returns the format of the model file.
    pub(super) fn format(&self) -> GltfFormat {
        let Self { images, meshopt, codecs, bits, .. } = *self;
        GltfFormat { images, quick_webp: false, meshopt, codecs, bits }
    }
}
