//! Values that encode which triangle a texel belongs to.

/// Marks texels that belong to no triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Marks padding texels; the other bits are the triangle.
pub(super) const PADDING: u32 = 1 << 31;
