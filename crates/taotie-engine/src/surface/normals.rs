//! Normals from geometry only: of a triangle, and of the vertices it shares.
//!
//! The angles at corners, which weight facets, take nearly all the time of vertex normals. They are computed for many
//! triangles at a time: with a branch-free arc tangent, the compiler can keep several triangles in one register; it
//! gives the bits of `libm::atan2`, which handles arguments outside its range.

use super::weld::{self, Classes};
use crate::error::Result;
use crate::math::{SimdLevel, Vec3, dispatch_eight, scalar};
use crate::mesh::Mesh;
use crate::parallel;
use fearless_simd::Level;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::Range;

/// The normal of a vertex that is not part of any triangle with an area.
pub(super) const FALLBACK: Vec3 = Vec3::new(0.0, 0.0, 1.0);

/// The unit normal of a triangle on the side from which its corners run counter-clockwise; `None` without an area.
pub fn facet_normal(corners: [Vec3; 3]) -> Option<Vec3> {
    unit(doubled_area(corners.map(Vec3::to_f64))).map(Vec3::to_f32)
}

/// Returns one unit normal per position: the facet normals around it, each weighted by the triangle's angle there.
///
/// Bit-identical positions count as one vertex, so a surface that is cut for its uvs stays smooth. Triangles without
/// area are skipped. If the sum cancels, the vertex takes the normal of its first triangle; if it has none, (0, 0,
/// 1).
///
/// Law: independent of how a flat polygon is split into triangles (`laws::surface::normals_ignore_the_triangulation`).
/// Source: Thürmer and Wüthrich 1998, "Computing vertex normals from polygonal facets".
pub fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    vertex_normals_at(SimdLevel::fastest(), mesh)
}

/// [`vertex_normals`], computed at a SIMD level.
fn vertex_normals_at(level: Level, mesh: &Mesh) -> Vec<Vec3> {
    let places = weld::by_position(mesh.positions());
    let sums = angle_weighted_sums(level, mesh, &places);
    let cancelled = parallel::count(sums.len(), |i| unit(sums[i]).is_none());
    let firsts = if cancelled > 0 { first_facets(mesh) } else { Vec::new() };
    let normal_of = |i: usize| match unit(sums[places.of[i] as usize]) {
        Some(normal) => normal.to_f32(),
        None => firsts[i].unwrap_or(FALLBACK),
    };
    parallel::collect(places.of.len(), normal_of)
}

/// Returns the mesh with [`vertex_normals`] if it has none. Tangents without normals are meaningless and are dropped.
///
/// # Errors
/// None for a validated mesh.
pub fn with_normals(mesh: &Mesh) -> Result<Cow<'_, Mesh>> {
    with_normals_at(SimdLevel::fastest(), mesh)
}

/// [`with_normals`], computed at a SIMD level.
pub(crate) fn with_normals_at(level: Level, mesh: &Mesh) -> Result<Cow<'_, Mesh>> {
    if !mesh.normals().is_empty() {
        return Ok(Cow::Borrowed(mesh));
    }
    let mut data = mesh.clone().into_data();
    data.normals = vertex_normals_at(level, mesh);
    data.tangents = Vec::new();
    Ok(Cow::Owned(Mesh::new(data)?))
}

/// Sums in triangle order, whatever the number of threads: while one block is summed, the next is computed.
fn angle_weighted_sums(level: Level, mesh: &Mesh, places: &Classes) -> Vec<Vec3<f64>> {
    const BLOCK: usize = 1 << 15;
    let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
    let add = |block: usize, shares: &[Share], sums: &mut [Vec3<f64>]| {
        for (triangle, share) in mesh.triangles()[block * BLOCK..].iter().zip(shares) {
            for (vertex, angle) in triangle.iter().zip(share.angles) {
                sums[places.of[*vertex as usize] as usize] += share.normal * angle;
            }
        }
    };
    let blocks = mesh.triangles().len().div_ceil(BLOCK);
    let (mut ready, mut next) = (Vec::new(), Vec::new());
    for block in 0..=blocks {
        let range = block * BLOCK..mesh.triangles().len().min((block + 1) * BLOCK);
        rayon::join(
            || compute_shares(level, mesh, range, &mut next),
            || add(block.saturating_sub(1), &ready, &mut sums),
        );
        std::mem::swap(&mut ready, &mut next);
    }
    sums
}

/// Replaces the content of `shares` by the contributions of some triangles.
fn compute_shares(level: Level, mesh: &Mesh, triangles: Range<usize>, shares: &mut Vec<Share>) {
    const PART: usize = 1 << 10;
    shares.resize(triangles.len(), Share::NONE);
    parallel::pieces(shares, PART, &|i, part| shares_at(level, mesh, triangles.start + i * PART, part));
}

/// The normal of the first triangle with an area at each vertex.
fn first_facets(mesh: &Mesh) -> Vec<Option<Vec3>> {
    let mut firsts = vec![None; mesh.positions().len()];
    for (i, triangle) in mesh.triangles().iter().enumerate() {
        for vertex in triangle {
            let first: &mut Option<Vec3> = &mut firsts[*vertex as usize];
            if first.is_none() {
                *first = facet_normal(mesh.corners(i));
            }
        }
    }
    firsts
}

fn doubled_area([a, b, c]: [Vec3<f64>; 3]) -> Vec3<f64> {
    (b - a).cross(c - a)
}

/// For each vertex, sums the vectors of all vertices at its position, each distinct one counted once, so that cuts in
/// a surface do not matter.
pub(crate) fn mean_by_position(mesh: &Mesh, vectors: &[Vec3]) -> Vec<Vec3> {
    let places = weld::by_position(mesh.positions());
    let kinds = places.split_by(|v| weld::bits(vectors[v].to_array()));
    let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
    for first in &kinds.firsts {
        sums[places.of[*first as usize] as usize] += vectors[*first as usize];
    }
    places.of.iter().map(|place| sums[*place as usize]).collect()
}

/// Gives all vertices at one position the largest of their values.
pub(crate) fn shared_by_position(mesh: &Mesh, values: &mut [f32]) {
    let places = weld::by_position(mesh.positions());
    let mut largest = vec![f32::NEG_INFINITY; places.firsts.len()];
    for (place, value) in places.of.iter().zip(&*values) {
        let most = &mut largest[*place as usize];
        *most = most.max(*value);
    }
    for (place, value) in places.of.iter().zip(values) {
        *value = largest[*place as usize];
    }
}

/// The number of triangles computed together.
const WIDTH: usize = 8;

/// The contribution of a triangle to the normals of its corners.
#[derive(Clone, Copy)]
struct Share {
    /// Its unit normal; zero if it has no area.
    normal: Vec3<f64>,
    /// The angle at each corner, in radians.
    angles: [f64; 3],
}

impl Share {
    /// The contribution of a triangle without area.
    const NONE: Self = Self { normal: Vec3::new(0.0, 0.0, 0.0), angles: [0.0; 3] };
}

/// The contributions of `out.len()` triangles starting at `first`, compiled for `level`.
fn shares_at(level: Level, mesh: &Mesh, first: usize, out: &mut [Share]) {
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
    [(b - a, c - a), (c - b, a - b), (a - c, b - c)].map(|(a, b)| angle(a, b))
}

/// The angle between two vectors, in radians.
pub(super) fn angle(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let (y, x) = tangent(a, b);
    scalar::atan2(y, x)
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
    use crate::mesh::MeshData;

    /// Blocks, threads and lanes change nothing: the sums are those of one plain loop, to the last bit.
    #[test]
    fn sums_are_those_of_a_plain_loop() {
        let mut data: MeshData = Mesh::sphere(1.0, 300, 200).into_data();
        data.triangles.iter_mut().step_by(1000).for_each(|t| t[1] = t[0]);
        data.positions.iter_mut().skip(500).step_by(7000).for_each(|p| *p = *p * 1e-30);
        let mesh = Mesh::new(data).unwrap();
        assert!(mesh.triangles().len() > 100_000);
        let places = weld::by_position(mesh.positions());
        let mut sums = vec![Vec3::splat(0.0); places.firsts.len()];
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            let corners = mesh.corners(i).map(Vec3::to_f64);
            let Some(normal) = unit(doubled_area(corners)) else { continue };
            for (vertex, angle) in triangle.iter().zip(corner_angles(corners)) {
                sums[places.of[*vertex as usize] as usize] += normal * angle;
            }
        }
        let bits =
            |sums: &[Vec3<f64>]| sums.iter().flat_map(|s| s.to_array().map(f64::to_bits)).collect::<Vec<_>>();
        for simd in SimdLevel::available() {
            let ours = angle_weighted_sums(simd.dispatch().unwrap(), &mesh, &places);
            assert!(bits(&ours) == bits(&sums), "{simd:?}");
        }
    }

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
