//! Where textures are read, and what their texels mean.

use crate::math::Lane;

/// The linear part of a texture's transform, by rows, applied to texture coordinates or to a change of them.
#[inline(always)]
pub fn turned_uv<L: Lane>([[a, b], [c, d]]: [[L; 2]; 2], [u, v]: [L; 2]) -> [L; 2] {
    [a * u + b * v, c * u + d * v]
}

/// The log2 of the texels of the finest level that a pixel covers, of the longer of its two steps: the changes of the
/// texture coordinates a pixel to the right and down, in a texture of `size` texels.
#[inline(always)]
pub fn log2_texels<L: Lane>(d_x: [L; 2], d_y: [L; 2], size: [L; 2]) -> L {
    let squared = |[du, dv]: [L; 2]| (du * size[0]).squared() + (dv * size[1]).squared();
    let texels = squared(d_x).max(squared(d_y)).clamp(1e-30, 1e30);
    texels.log2() * texels.lit(0.5)
}

/// The step in u, or v, from a point to its neighbour in the level in use, whose texels are `texels` of the finest
/// level wide; `size` is that level's.
#[inline(always)]
pub fn height_step<L: Lane>(texels: L, size: L) -> L {
    texels / size
}

/// The derivative of a height by u, or v, from those a [`height_step`] to each side.
#[inline(always)]
pub fn height_derivative<L: Lane>(after: L, before: L, step: L) -> L {
    (after - before) / (step * step.lit(2.0))
}

/// Occlusion as much as it counts: 1 + strength (o − 1); both in [0, 1].
#[inline(always)]
pub fn occluded<L: Lane>(occlusion: L, strength: L) -> L {
    let one = occlusion.lit(1.0);
    one + strength * (occlusion - one)
}

/// The cosine and sine of the angle of anisotropy from the tangent: the material's, turned by a texel's red and green,
/// each in [0, 1].
///
/// Source: KHR_materials_anisotropy.
#[inline(always)]
pub fn anisotropy_turn<L: Lane>([cos, sin]: [L; 2], [red, green]: [L; 2]) -> [L; 2] {
    let (one, two) = (red.lit(1.0), red.lit(2.0));
    let (x, y) = (two * red - one, two * green - one);
    [cos * x - sin * y, sin * x + cos * y]
}
