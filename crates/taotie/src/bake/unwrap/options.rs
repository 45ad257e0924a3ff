//! Unwrapping options.

/// The map for which a mesh is unwrapped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnwrapOptions {
    /// Texels along a side of the square map, 1 to [`crate::image::Image::MAX_SIDE`].
    pub size: u32,
    /// Texels between UV islands, and between them and the map's border.
    pub padding: u32,
}

impl Default for UnwrapOptions {
    fn default() -> Self {
        Self { size: 2048, padding: 4 }
    }
}
