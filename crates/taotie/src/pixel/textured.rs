//! Texture coordinates, mip levels, and the meaning of texels.

use crate::math::Lane;

/// Applies the linear part of a texture's transform, given by rows, to texture coordinates or their derivatives.
#[inline(always)]
pub fn turned_uv<L: Lane>([[a, b], [c, d]]: [[L; 2]; 2], [u, v]: [L; 2]) -> [L; 2] {
    [a * u + b * v, c * u + d * v]
}

/// Returns log2 of the finest level's texels that a pixel covers along the longer of its two steps: the changes of the
/// texture coordinates one pixel to the right and down, in a texture of `size` texels.
#[inline(always)]
pub fn log2_texels<L: Lane>(d_x: [L; 2], d_y: [L; 2], size: [L; 2]) -> L {
    let squared = |[du, dv]: [L; 2]| (du * size[0]).squared() + (dv * size[1]).squared();
    let texels = squared(d_x).max(squared(d_y)).clamp(1e-30, 1e30);
    texels.log2() * texels.lit(0.5)
}

/// Returns the step in u or v to the neighbouring texel of the level in use, whose texels are `texels` texels of the
/// finest level wide; `size` is the finest level's size.
#[inline(always)]
pub fn height_step<L: Lane>(texels: L, size: L) -> L {
    texels / size
}

/// Returns the derivative of a height with respect to u or v, from the heights one [`height_step`] to each side.
#[inline(always)]
pub fn height_derivative<L: Lane>(after: L, before: L, step: L) -> L {
    (after - before) / (step * step.lit(2.0))
}

/// Returns the occlusion weighted by its strength: 1 + strength (o − 1); both in [0, 1].
#[inline(always)]
pub fn occluded<L: Lane>(occlusion: L, strength: L) -> L {
    let one = occlusion.lit(1.0);
    one + strength * (occlusion - one)
}

/// Returns the cosine and sine of the anisotropy's angle from the tangent: the material's angle, rotated by a texel's red
/// and green, each in [0, 1].
///
/// Source: KHR_materials_anisotropy.
#[inline(always)]
pub fn anisotropy_turn<L: Lane>([cos, sin]: [L; 2], [red, green]: [L; 2]) -> [L; 2] {
    let (one, two) = (red.lit(1.0), red.lit(2.0));
    let (x, y) = (two * red - one, two * green - one);
    [cos * x - sin * y, sin * x + cos * y]
}
