//! The textures of a material: their images and uses.

use crate::image::{Bitmap, Encoding};

/// A texture's image.
#[derive(Debug, Clone, Copy)]
pub enum GltfImage<'a> {
    /// 8-bit or 16-bit texels; alpha is written if the material reads it.
    Bitmap(&'a Bitmap),
    /// An existing file next to the model, by its relative path with `/`.
    File(&'a str),
}

impl<'a> From<&'a Bitmap> for GltfImage<'a> {
    fn from(bitmap: &'a Bitmap) -> Self {
        Self::Bitmap(bitmap)
    }
}

impl GltfImage<'_> {
    /// Returns `true` if both are the same image, so that it only has to be written once.
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
