//! The packing of an asset into files.

use crate::io::GltfImages;
use std::path::PathBuf;

/// The packing of an asset into files. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Asset, Packing, Written};
/// use taotie::io::GltfImages;
/// use taotie::{Progress, Result};
///
/// /// Writes a small file, for viewers that know the extensions of glTF.
/// fn write_small(asset: &Asset) -> Result<Written> {
///     let packing = Packing { images: GltfImages::WebP, meshopt: true, ..Packing::default() };
///     asset.write("small.glb", &packing, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Packing {
    /// The packing of textures; KTX2 needs maps whose sides are multiples of 4.
    pub images: GltfImages,
    /// The quality of the base colour as JPEG, 1 to 100; `None` packs it as `images` says.
    pub jpeg: Option<u8>,
    /// Compresses geometry (EXT_meshopt_compression).
    pub meshopt: bool,
    /// A JSON file of XMP properties, such as `dc:title`, that the asset is to bear beside those of the scan.
    pub provenance: Option<PathBuf>,
}
