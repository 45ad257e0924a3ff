//! Computes facet normals and corner angles of many triangles at a time.
//!
//! The angles take nearly all the time of vertex normals. With a branch-free arc tangent, the compiler can keep
//! several triangles in one register; it gives the bits of `libm::atan2`, which handles arguments outside its range.

use crate::math::{Vec3, dispatch_eight, scalar};
use crate::mesh::Mesh;
use fearless_simd::Level;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The number of triangles computed together.
const WIDTH: usize = 8;

/// The contribution of a triangle to the normals of its corners.
#[derive(Clone, Copy)]
pub(super) struct Share {
    /// Its unit normal; zero if it has no area.
    pub normal: Vec3<f64>,
    /// The angle at each corner, in radians.
    pub angles: [f64; 3],
}

impl Share {
    /// The contribution of a triangle without area.
    pub const NONE: Self = Self { normal: Vec3::new(0.0, 0.0, 0.0), angles: [0.0; 3] };
}

/// The contributions of `out.len()` triangles starting at `first`, compiled for `level`.
pub(super) fn shares(level: Level, mesh: &Mesh, first: usize, out: &mut [Share]) {
    dispatch_eight!(level, _Pack, _token => any_level(mesh, first, out));
}

#[inline(always)]
fn any_level(mesh: &Mesh, first: usize, out: &mut [Share]) {
    for (i, group) in out.chunks_mut(WIDTH).enumerate() {
        let first = first + i * WIDTH;
        let mut corners = [[[0.0; WIDTH]; 3]; 3];
        for lane in 0..group.len() {
            for (corner, p) in corners.iter_mut().zip(mesh.corners(first + lane)) {
                let p = p.to_f64();
                (corner[0][lane], corner[1][lane], corner[2][lane]) = (p.x, p.y, p.z);
            }
        }
        let wide = Wide::of(&corners);
        for (lane, share) in group.iter_mut().enumerate() {
            let ([nx, ny, nz], [a, b, c]) = (&wide.normal, &wide.angles);
            share.normal = Vec3::new(nx[lane], ny[lane], nz[lane]);
            share.angles = [a[lane], b[lane], c[lane]];
            if !wide.tame[lane] {
                *share = any_share(mesh.corners(first + lane).map(Vec3::to_f64));
            }
        }
    }
}

/// The contribution of a triangle of any shape.
fn any_share([a, b, c]: [Vec3<f64>; 3]) -> Share {
    match unit((b - a).cross(c - a)) {
        Some(normal) => Share { normal, angles: corner_angles([a, b, c]) },
        None => Share::NONE,
    }
}

/// The unit vector; `None` if only rounding errors remain.
pub(super) fn unit(v: Vec3<f64>) -> Option<Vec3<f64>> {
    let length = v.length();
    (length > 1e-300 && length.is_finite()).then(|| v / length)
}

/// The angle at each corner of a triangle, in radians.
pub(super) fn corner_angles([a, b, c]: [Vec3<f64>; 3]) -> [f64; 3] {
    [(b - a, c - a), (c - b, a - b), (a - c, b - c)].map(|(a, b)| {
        let (y, x) = tangent(a, b);
        scalar::atan2(y, x)
    })
}

/// Numerator and denominator of the tangent of the angle between two vectors: Kahan's cross-product form, exact for
/// small angles, unlike the arc cosine.
#[inline(always)]
fn tangent(a: Vec3<f64>, b: Vec3<f64>) -> (f64, f64) {
    (a.cross(b).length(), a.dot(b))
}

/// The contributions of a batch of triangles, lane by lane.
struct Wide {
    normal: [[f64; WIDTH]; 3],
    angles: [[f64; WIDTH]; 3],
    /// `true` if the triangle is in the range of this form.
    tame: [bool; WIDTH],
}

impl Wide {
    /// Computes the contributions of triangles, given by corner, coordinate and lane.
    #[inline(always)]
    fn of(corners: &[[[f64; WIDTH]; 3]; 3]) -> Self {
        let mut wide = Self { normal: [[0.0; WIDTH]; 3], angles: [[0.0; WIDTH]; 3], tame: [false; WIDTH] };
        for lane in 0..WIDTH {
            let at =
                |corner: &[[f64; WIDTH]; 3]| Vec3::new(corner[0][lane], corner[1][lane], corner[2][lane]);
            let [a, b, c] = [at(&corners[0]), at(&corners[1]), at(&corners[2])];
            let area = (b - a).cross(c - a);
            let length = area.length();
            let normal = area / length;
            let (y0, x0) = tangent(b - a, c - a);
            let (y1, x1) = tangent(c - b, a - b);
            let (y2, x2) = tangent(a - c, b - c);
            wide.normal[0][lane] = normal.x;
            wide.normal[1][lane] = normal.y;
            wide.normal[2][lane] = normal.z;
            wide.angles[0][lane] = tame_atan2(y0, x0);
            wide.angles[1][lane] = tame_atan2(y1, x1);
            wide.angles[2][lane] = tame_atan2(y2, x2);
            wide.tame[lane] = is_tame(length, 0.0) & is_tame(y0, x0) & is_tame(y1, x1) & is_tame(y2, x2);
        }
        wide
    }
}

/// Returns true if [`tame_atan2`] is defined.
#[inline(always)]
fn is_tame(y: f64, x: f64) -> bool {
    const STEEPEST: f64 = 1.0 / (1u64 << 60) as f64;
    (y > 1e-280) & (y < 1e280) & (x < 1e280) & (x > -1e280) & ((x >= 0.0) | (-x > y * STEEPEST))
}

/// The bits of `libm::atan2(y, x)` if [`is_tame`], without a branch.
///
/// The arguments are reduced to |t| ≤ 7/16 around one of four angles, whose arc tangents are stored in two parts.
/// Source: `s_atan.c` and `e_atan2.c` of FreeBSD's msun (Sun Microsystems 1993), which `libm` follows.
#[inline(always)]
fn tame_atan2(y: f64, x: f64) -> f64 {
    const PI_LOW: f64 = 1.224_646_799_147_353_2e-16;
    let t = y / x.abs();
    let pick = |values: [f64; 5]| {
        let low = if t < 0.4375 { values[0] } else { values[1] };
        let middle = if t < 1.1875 { values[2] } else { values[3] };
        let upper = if t < 2.4375 { middle } else { values[4] };
        if t < 0.6875 { low } else { upper }
    };
    let above = pick([t, 2.0 * t - 1.0, t - 1.0, t - 1.5, -1.0]);
    let below = pick([1.0, 2.0 + t, t + 1.0, 1.0 + 1.5 * t, t]);
    let high = pick([0.0, ANGLE_HIGH[0], ANGLE_HIGH[1], ANGLE_HIGH[2], ANGLE_HIGH[3]]);
    let low = pick([0.0, ANGLE_LOW[0], ANGLE_LOW[1], ANGLE_LOW[2], ANGLE_LOW[3]]);
    let r = above / below;
    let z = r * r;
    let w = z * z;
    let odd = z * (ATAN[0] + w * (ATAN[2] + w * (ATAN[4] + w * (ATAN[6] + w * (ATAN[8] + w * ATAN[10])))));
    let even = w * (ATAN[1] + w * (ATAN[3] + w * (ATAN[5] + w * (ATAN[7] + w * ATAN[9]))));
    let angle = high - (r * (odd + even) - low - r);
    if x < 0.0 { PI - (angle - PI_LOW) } else { angle }
}

/// The arc tangents of ½, 1, 3/2 and ∞, and their rounding errors.
const ANGLE_HIGH: [f64; 4] = [0.463_647_609_000_806_1, FRAC_PI_4, 0.982_793_723_247_329, FRAC_PI_2];
const ANGLE_LOW: [f64; 4] = [
    2.269_877_745_296_168_7e-17,
    3.061_616_997_868_383e-17,
    1.390_331_103_123_099_8e-17,
    6.123_233_995_736_766e-17,
];

/// The polynomial of the arc tangent, from the third power upwards.
const ATAN: [f64; 11] = [
    3.333_333_333_333_293e-1,
    -1.999_999_999_987_648_3e-1,
    1.428_571_427_250_346_6e-1,
    -1.111_111_040_546_235_6e-1,
    9.090_887_133_436_507e-2,
    -7.691_876_205_044_83e-2,
    6.661_073_137_387_531e-2,
    -5.833_570_133_790_573_5e-2,
    4.976_877_994_615_932_4e-2,
    -3.653_157_274_421_691_6e-2,
    1.628_582_011_536_578_2e-2,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tame_form_has_the_bits_of_libm() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            seed >> 11
        };
        let mut seen = 0;
        let mut compare = |y: f64, x: f64| {
            if is_tame(y, x) {
                assert_eq!(tame_atan2(y, x).to_bits(), libm::atan2(y, x).to_bits(), "{y:e} {x:e}");
                seen += 1;
            }
        };
        for _ in 0..2_000_000 {
            let unit = |bits: u64| bits as f64 / (1u64 << 53) as f64;
            let (y, x) = (unit(random()), 2.0 * unit(random()) - 1.0);
            compare(y, x);
            compare(y, x * 1e-9);
            compare(y * 1e-9, x);
            compare(y, x * libm::exp2(-70.0 * y));
            compare(f64::from_bits(random() << 11).abs(), f64::from_bits(random() << 11));
        }
        for bound in [0.4375, 0.6875, 1.1875, 2.4375, 1.0, 0.5, 1.5, 2.0] {
            for step in -3..=3 {
                let y = f64::from_bits((f64::to_bits(bound) as i64 + step) as u64);
                [1.0, -1.0, 2.0, -2.0, 0.0, -0.0].into_iter().for_each(|x| compare(y, x));
            }
        }
        assert!(seen > 5_000_000, "{seen}");
    }
}
