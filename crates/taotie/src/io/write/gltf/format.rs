//! How a model is packed.

/// The packing of textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum GltfImages {
    /// PNG, as precise as the bitmap; every program reads it.
    #[default]
    Png,
    /// Lossless WebP (EXT_texture_webp), smaller; 16 bits are rounded to 8. Programs that do not know the extension
    /// cannot read the file.
    WebP,
    /// KTX2 of UASTC blocks with mip levels (KHR_texture_basisu): a byte a texel in the file and, packed, on graphics
    /// cards, and lossy; 16 bits are rounded to 8, and sides must be multiples of 4. Images with alpha that is read are
    /// PNG. Programs that do not know the extension cannot read the file.
    Ktx2,
}

impl GltfImages {
    pub(super) fn file_extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::WebP => "webp",
            Self::Ktx2 => "ktx2",
        }
    }

    pub(super) fn mime_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::WebP => "image/webp",
            Self::Ktx2 => "image/ktx2",
        }
    }

    /// The extension that a texture needs to show such an image.
    pub(super) fn extension(self) -> Option<&'static str> {
        match self {
            Self::Png => None,
            Self::WebP => Some("EXT_texture_webp"),
            Self::Ktx2 => Some("KHR_texture_basisu"),
        }
    }
}

/// The options for writing a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GltfFormat {
    /// The packing of textures.
    pub images: GltfImages,
    /// The quality, 1 to 100, of the base colour as JPEG, which is lossy and which every program reads; `None` packs it
    /// as `images` says. All other textures are numbers, and never JPEG.
    pub jpeg: Option<u8>,
    /// Packs meshes by EXT_meshopt_compression: positions in 16 bits, 65535 steps along the longest side of the box
    /// around all levels; normals and tangents in 2 × 12 bits, within 0.05°; uvs and colours in 16 bits where they lie
    /// in [0, 1]. Vertices and triangles are sorted anew. Programs that do not know the extension cannot read the file.
    pub meshopt: bool,
}
