//! Normals read from textures, per pixel.

use crate::math::{Lane, Vec3};

/// The smallest z of a tangent-space vector: half a step of a 16-bit channel.
const SMALLEST_Z: f64 = 1.0 / 65535.0;

/// The vector stored in a tangent-space normal map, not normalised.
///
/// x = (2r − 1) · scale, y = (2g − 1) · scale · green, z = 2b − 1, with `rgb` linear in [0, 1]. The centre of an
/// 8-bit channel is 127.5, between two codes, so the usual (128, 128, 255) is tilted by 0.32°. `scale` is glTF's
/// `normalTexture.scale`; `green` is +1 if green points up the image (OpenGL, glTF) and −1 if it points down
/// (DirectX). z at or below zero (blue ≤ 0.5) is not a valid tangent-space normal and is raised to 1/65535;
/// [`super::invalid_texels`] counts such texels.
///
/// The length is kept: after a filtered lookup has averaged diverging normals, it is below one.
#[inline(always)]
pub fn decode_normal<L: Lane>(rgb: Vec3<L>, scale: L, green: L) -> Vec3<L> {
    let v = decode_object_normal(rgb);
    Vec3::new(v.x * scale, v.y * scale * green, v.z.max(v.z.lit(SMALLEST_Z)))
}

/// The vector stored in an object-space normal map, not normalised: 2c − 1 of each channel, any direction.
#[inline(always)]
pub fn decode_object_normal<L: Lane>(rgb: Vec3<L>) -> Vec3<L> {
    let (two, one) = (rgb.x.lit(2.0), rgb.x.lit(1.0));
    Vec3::new(rgb.x * two - one, rgb.y * two - one, rgb.z * two - one)
}

/// The linear colour in [0, 1] that stores the unit vector `n`, green up: (n + 1) / 2.
///
/// Law: decoding it returns `n` within the quantum of the channel (`laws::maps::decode_undoes_encode`).
#[inline(always)]
pub fn encode_normal<L: Lane>(n: Vec3<L>) -> Vec3<L> {
    let half = n.x.lit(0.5);
    Vec3::new(n.x * half + half, n.y * half + half, n.z * half + half)
}

/// The unit normal for the tangent-space vector `map`: x t + y b + z n with b = handedness · cross(n, t).
///
/// `n` and `t` are interpolated between vertices and *not* normalised, as MikkTSpace requires: bakers invert exactly
/// this. Returns `n` itself if the sum is zero.
///
/// Laws: (0, 0, 1) gives `n`; a tilted map is a tilted frame (`laws::maps`).
/// Source: Mikkelsen 2008, "Simulation of wrinkled surfaces revisited"; glTF 2.0 §3.7.2.1.
#[inline(always)]
pub fn tangent_normal<L: Lane>(n: Vec3<L>, t: Vec3<L>, handedness: L, map: Vec3<L>) -> Vec3<L> {
    let b = n.cross(t) * handedness;
    (t * map.x + b * map.y + n * map.z).normalize_or(n)
}

/// The unit tangent-space vector that [`tangent_normal`] maps to the direction `v`: its coordinates in the frame (t,
/// b, n) with b = handedness · cross(n, t), normalised.
///
/// The interpolated frame, neither unit nor orthogonal, is inverted exactly (Cramer's rule); the error of its
/// transpose would be as large as the frame's deviation from orthonormal. (0, 0, 1) if the frame spans no volume.
///
/// Law: `tangent_normal` returns the direction of `v` (`laws::maps::tangent_space_has_a_true_inverse`).
#[inline(always)]
pub fn tangent_space_normal<L: Lane>(n: Vec3<L>, t: Vec3<L>, handedness: L, v: Vec3<L>) -> Vec3<L> {
    let b = n.cross(t) * handedness;
    let det = t.dot(b.cross(n));
    let (zero, one) = (det.lit(0.0), det.lit(1.0));
    let up = Vec3::new(zero, zero, one);
    let coordinates = Vec3::new(v.dot(b.cross(n)), v.dot(n.cross(t)), v.dot(t.cross(b))) * (one / det);
    Vec3::select(zero.lt(det.abs()), coordinates, up).normalize_or(up)
}

/// The unit world normal for the object-space vector `map`, transformed by the columns of the normal matrix.
///
/// The map's vector itself if the matrix makes it zero.
#[inline(always)]
pub fn object_normal<L: Lane>(map: Vec3<L>, normal_matrix: [Vec3<L>; 3]) -> Vec3<L> {
    let [x, y, z] = normal_matrix;
    (x * map.x + y * map.y + z * map.z).normalize_or(map)
}

/// The z ≥ 0 of a unit vector from the other two components, for two-channel maps: √(1 − x² − y²), zero outside the
/// unit disc.
#[inline(always)]
pub fn rebuild_z<L: Lane>(x: L, y: L) -> L {
    let squared = x.lit(1.0) - x * x - y * y;
    squared.max(x.lit(0.0)).sqrt()
}
