//! How an asset is packed into files.

use crate::io::GltfImages;
use std::path::PathBuf;

/// How an asset is packed into files. Built by `Default` and struct update.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Packing {
    /// How textures are packed; KTX2 needs maps whose sides are multiples of 4.
    pub images: GltfImages,
    /// Compresses geometry (EXT_meshopt_compression).
    pub meshopt: bool,
    /// A JSON file of XMP properties, such as `dc:title`, that the asset is to bear beside those of the scan.
    pub provenance: Option<PathBuf>,
}
