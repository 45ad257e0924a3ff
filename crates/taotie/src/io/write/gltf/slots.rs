//! The textures that a material may show: their images and their uses.

use crate::image::{Bitmap, Encoding};

/// A texture's image.
#[derive(Debug, Clone, Copy)]
pub enum GltfImage<'a> {
    /// Texels of 8 or 16 bits; alpha is written where the material reads it.
    Bitmap(&'a Bitmap),
    /// A file that lies beside the model already, by its relative path with `/`.
    File(&'a str),
}

impl<'a> From<&'a Bitmap> for GltfImage<'a> {
    fn from(bitmap: &'a Bitmap) -> Self {
        Self::Bitmap(bitmap)
    }
}

impl GltfImage<'_> {
    /// Says whether both are one and the same, so that it needs to be written once only.
    pub(super) fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bitmap(a), Self::Bitmap(b)) => std::ptr::eq(*a, *b),
            (Self::File(a), Self::File(b)) => a == b,
            _ => false,
        }
    }
}

/// The slots of a material that have textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    MetallicRoughness,
    Occlusion,
    Normal,
    Emissive,
}

impl Slot {
    pub fn encoding(self) -> Encoding {
        match self {
            Self::BaseColor | Self::Emissive => Encoding::Srgb,
            Self::Normal => Encoding::Normal,
            Self::MetallicRoughness | Self::Occlusion => Encoding::Linear,
        }
    }
}
