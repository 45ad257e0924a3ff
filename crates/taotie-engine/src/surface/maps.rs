//! Normals read from maps, per pixel: from normal maps, and from heights by bump mapping.

use crate::math::{Lane, Vec3};

/// The smallest z of a tangent-space vector: half a step of a 16-bit channel.
const SMALLEST_Z: f64 = 1.0 / 65535.0;

/// The vector stored in a tangent-space normal map, not normalised.
///
/// x = (2r − 1) · scale, y = (2g − 1) · scale · green, z = 2b − 1, with `rgb` linear in [0, 1]. The centre of an
/// 8-bit channel is 127.5, between two codes, so the usual (128, 128, 255) is tilted by 0.32°. `scale` is glTF's
/// `normalTexture.scale`; `green` is +1 if green points up the image (OpenGL, glTF) and −1 if it points down
/// (DirectX). z at or below zero (blue ≤ 0.5) is not a valid tangent-space normal and is raised to 1/65535;
/// [`super::invalid_texels`] counts such texels, except those that lossy storage explains.
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

/// The surface gradient of a height: the tangent vector along which height increases fastest, per model unit.
///
/// ∇h = (∂h/∂u · (∂p/∂v × n) + ∂h/∂v · (n × ∂p/∂u)) / (n · (∂p/∂u × ∂p/∂v))
///
/// `n` unit; heights in model units; u and v are any two parameters: uvs, or screen coordinates. Zero if the
/// derivatives of position span no area.
/// Law: the gradient of a linear ramp tilts a plane exactly (`laws::maps::bump_of_a_ramp_is_the_tilted_plane`).
/// Source: Mikkelsen 2020, "Surface gradient–based bump mapping framework", JCGT 9(3), eq. 4.
#[inline(always)]
pub fn surface_gradient<L: Lane>(
    n: Vec3<L>,
    [dp_du, dp_dv]: [Vec3<L>; 2],
    [dh_du, dh_dv]: [L; 2],
) -> Vec3<L> {
    let across_v = dp_dv.cross(n);
    let across_u = n.cross(dp_du);
    let area = dp_du.dot(across_v);
    let gradient = across_v * dh_du + across_u * dh_dv;
    let zero = Vec3::splat(area.lit(0.0));
    Vec3::select(area.lit(0.0).lt(area.abs()), gradient / area, zero)
}

/// The unit normal of a surface raised by a height with this surface gradient: n − ∇h, normalised.
///
/// `n` unit and perpendicular to `gradient`; gradients of several heights may be summed first.
/// Source: Mikkelsen 2020, eq. 5.
#[inline(always)]
pub fn bump<L: Lane>(n: Vec3<L>, gradient: Vec3<L>) -> Vec3<L> {
    (n - gradient).normalize_or(n)
}

/// A point of a smooth surface beneath relief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefBase<L> {
    /// The interpolated normal, of any length but 0.
    pub n: Vec3<L>,
    /// ∂p/∂u and ∂p/∂v of the flat triangle.
    pub dp: [Vec3<L>; 2],
    /// ∂n/∂u and ∂n/∂v of the interpolated normal.
    pub dn: [Vec3<L>; 2],
}

/// A height at a point and its derivatives by u and v, in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relief<L> {
    /// h.
    pub height: L,
    /// ∂h/∂u.
    pub by_u: L,
    /// ∂h/∂v.
    pub by_v: L,
}

/// The unit normal of a surface displaced along its interpolated normal.
///
/// The surface is Q = P + h n with the unit normal n. Its derivatives are Q_u = P_u + h n_u + h_u n, and likewise for
/// v. P_u + h n_u and P_v + h n_v are made perpendicular to n, so that the facets of P do not show; with these, the
/// normal is n − ∇h ([`surface_gradient`]). They need be neither equal in length nor perpendicular. Unlike [`bump`],
/// which omits h n_u, it accounts for the stretching of raised relief on a round surface.
/// Source: Mikkelsen 2020, "Surface gradient–based bump mapping framework", JCGT 9(3), eq. 4 and 5.
#[inline(always)]
pub fn relief_normal<L: Lane>(base: ReliefBase<L>, relief: Relief<L>) -> Vec3<L> {
    let length = base.n.length();
    let n = base.n / length;
    let scale = relief.height / length;
    let dp = [0, 1].map(|k| {
        let p = base.dp[k] + base.dn[k] * scale;
        p - n * n.dot(p)
    });
    bump(n, surface_gradient(n, dp, [relief.by_u, relief.by_v]))
}

/// Bump mapping as printed in Table 2 of Guo and Wang 2025: n + s · (g / 255) · (1, 1, 0). *Not* normalised.
///
/// `bump_scale` s is the paper's "bump" (5 and 50); `g` is half the central grey difference of the height map in grey
/// levels, in [−127.5, 127.5], one number for both axes; the direction (1, 1, 0) is in object space. It is included
/// to reproduce the paper, not for use: the result depends on the object's orientation, and its length on the height.
/// Source: Guo and Wang 2025, Table 2, all ten rows (`maps::tests::follows_table_2`, `taotie compare --paper`).
#[inline(always)]
pub fn bump_printed<L: Lane>(n: Vec3<L>, bump_scale: L, g: L) -> Vec3<L> {
    let raise = bump_scale * (g / g.lit(255.0));
    Vec3::new(n.x + raise, n.y + raise, n.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Row = ([f64; 3], [f64; 3], [f64; 3], f64);

    /// N1, N2 (bump 5), N3 (bump 50) of two rows of the paper's Table 2, and the grey difference that explains both.
    /// `taotie compare --paper` has all rows, and finds the differences and the misprints.
    #[rustfmt::skip]
    const ROWS: [Row; 2] = [
        ([0.5341, -0.6375, 0.5543], [0.9459, -0.2257, 0.5543], [ 4.6518,  3.4800, 0.5543], 21.0),
        ([0.5287, -0.6393, 0.5559], [0.4405, -0.7275, 0.5559], [-0.3536, -1.5216, 0.5559], -4.5),
    ];

    #[test]
    fn follows_table_2() {
        for (n1, n2, n3, g) in ROWS {
            for (scale, printed) in [(5.0, n2), (50.0, n3)] {
                let ours = bump_printed(Vec3::from_array(n1), scale, g);
                let off = ours - Vec3::from_array(printed);
                // The table truncates N1 and the result after four decimals.
                let worst = off.to_array().iter().fold(0.0f64, |w, d| w.max(d.abs()));
                assert!(worst < 2e-4, "g {g}, bump {scale}: {ours:?} against {printed:?}");
            }
        }
    }

    #[test]
    fn no_area_means_no_bump() {
        let n = Vec3::new(0.0, 0.0, 1.0);
        let along = Vec3::new(1.0, 0.0, 0.0);
        assert_eq!(surface_gradient(n, [along; 2], [1.0; 2]), Vec3::splat(0.0));
        assert_eq!(bump(n, Vec3::splat(0.0)), n);
    }
}
