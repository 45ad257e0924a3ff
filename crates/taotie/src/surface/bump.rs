//! Normals from heights, per pixel.

use crate::math::{Lane, Vec3};

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
/// Source: Guo and Wang 2025, Table 2, all ten rows (`bump::tests::follows_table_2`, `taotie compare --paper`).
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
