//! The sphere unfolded to a square: an octahedron's upper faces in the middle, the lower ones folded out.

use super::bilinear::bilinear;
use super::texels::HalfTexels;
use crate::math::{Lane, Number, Vec3};
use crate::parallel;

/// An image of the sphere with a border, so that lookup between texels is seamless.
///
/// Source: Engelhardt and Dachsbacher 2008, "Octahedron Environment Maps".
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Octahedron {
    side: usize,
    /// `side` + 2 in a row, and as many rows.
    texels: HalfTexels,
}

/// The position in the unfolded square, [0, 1]², of a direction of any length.
///
/// Source: Engelhardt and Dachsbacher 2008, "Octahedron Environment Maps".
#[inline(always)]
pub fn octahedral_place<L: Lane>(direction: Vec3<L>) -> [L; 2] {
    let Vec3 { x, y, z } = direction;
    let (zero, half, one) = (x.lit(0.0), x.lit(0.5), x.lit(1.0));
    let scale = one / (x.abs() + y.abs() + z.abs());
    let (x, z) = (x * scale, z * scale);
    let (far_x, far_z) = (one - z.abs(), one - x.abs());
    let below = y.lt(zero);
    let folded_x = L::select(x.lt(zero), -far_x, far_x);
    let folded_z = L::select(z.lt(zero), -far_z, far_z);
    let (x, z) = (L::select(below, folded_x, x), L::select(below, folded_z, z));
    [x * half + half, z * half + half]
}

/// The unit direction at a position.
#[inline(always)]
pub(super) fn direction_of<L: Lane>([u, v]: [L; 2]) -> Vec3<L> {
    let (zero, one, two) = (u.lit(0.0), u.lit(1.0), u.lit(2.0));
    let (x, z) = (u * two - one, v * two - one);
    let y = one - x.abs() - z.abs();
    let (far_x, far_z) = (one - z.abs(), one - x.abs());
    let below = y.lt(zero);
    // Mirrored at the edge of the middle faces.
    let folded_x = L::select(x.lt(zero), -far_x, far_x);
    let folded_z = L::select(z.lt(zero), -far_z, far_z);
    Vec3::new(L::select(below, folded_x, x), y, L::select(below, folded_z, z)).normalize()
}

/// The coordinate of the centre of texel `i` of `side`.
pub(super) fn middle(side: usize, i: usize) -> f32 {
    (i as f32 + 0.5) / side as f32
}

impl Octahedron {
    /// Creates a map; `light` is called with the index of each row and writes the light in the directions of its
    /// texels.
    pub(super) fn new(side: usize, light: impl Fn(usize, &mut [[f32; 3]]) + Sync) -> Self {
        let mut colors = vec![[0.0; 3]; (side + 2) * (side + 2)];
        parallel::pieces(&mut colors[side + 2..(side + 2) * (side + 1)], side + 2, &|y, row| {
            light(y, &mut row[1..=side]);
        });
        for i in 0..side + 2 {
            for [x, y] in [[0, i], [side + 1, i], [i, 0], [i, side + 1]] {
                let [from_x, from_y] = inside([x, y], side);
                colors[y * (side + 2) + x] = colors[from_y * (side + 2) + from_x];
            }
        }
        Self { side, texels: HalfTexels::encode(&colors) }
    }

    /// Creates a map from stored texels, as many as a map of this side has with its border.
    pub(super) fn from_texels(side: usize, texels: HalfTexels) -> Self {
        Self { side, texels }
    }

    pub(super) fn side(&self) -> usize {
        self.side
    }

    pub(super) fn texels(&self) -> &HalfTexels {
        &self.texels
    }

    /// Bilinear interpolation of the four texels around a position, linear RGB.
    #[inline]
    pub(super) fn at<L: Number>(&self, [u, v]: [L; 2]) -> Vec3<L> {
        let side = u.lit(self.side as f64);
        let ((left, s), (top, t)) = (octahedral_taps(u, side), octahedral_taps(v, side));
        let start = top.index() * (self.side + 2) + left.index();
        let below = start + self.side + 2;
        let texel = |at| self.texels.get(at).map(|channel| u.lit(f64::from(channel)));
        bilinear([start, start + 1, below, below + 1].map(texel), [s, t])
    }
}

/// The first of the two texels around the coordinate `u` in a map of `side` texels, counted with the border, and the
/// fraction of the way to the next.
#[inline(always)]
pub fn octahedral_taps<L: Lane>(u: L, side: L) -> (L, L) {
    let x = u * side + u.lit(0.5);
    let first = x.floor();
    (first, x - first)
}

/// The inner texel with the same content as a border texel: each edge of the square is joined to itself, reversed.
fn inside([x, y]: [usize; 2], side: usize) -> [usize; 2] {
    let turned = |i: usize| side + 1 - i;
    let (x, y) = if x == 0 || x == side + 1 { (x.clamp(1, side), turned(y)) } else { (x, y) };
    if y == 0 || y == side + 1 { [turned(x), y.clamp(1, side)] } else { [x, y] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_directions_are_inverse() {
        for i in 0..400 {
            let place = [(i % 20) as f32 / 20.0 + 0.021, (i / 20) as f32 / 20.0 + 0.017];
            let [u, v]: [f32; 2] = octahedral_place(direction_of(place));
            assert!((u - place[0]).abs() < 1e-6 && (v - place[1]).abs() < 1e-6, "{place:?}: {u} {v}");
        }
        assert_eq!(octahedral_place(Vec3::new(0.0f32, 3.0, 0.0)), [0.5, 0.5]);
        assert_eq!(octahedral_place(Vec3::new(0.0f32, -1.0, 0.0)), [1.0, 1.0]);
    }

    /// A linear function of the direction is continuous everywhere.
    #[test]
    fn there_is_no_seam() {
        let direction = |i: usize| direction_of([middle(64, i % 64), middle(64, i / 64)]);
        let directions: Vec<Vec3> = (0..64 * 64).map(direction).collect();
        let map = Octahedron::new(64, |y, row| {
            for (color, d) in row.iter_mut().zip(&directions[y * 64..]) {
                *color = [d.x + 2.0, d.y + 2.0, d.z + 2.0];
            }
        });
        let mut random = 1u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for i in 0..2000 {
            let mut d = Vec3::new(next(), next(), next());
            match i % 4 {
                0 => d.x *= 1e-4,
                1 => d.z *= 1e-4,
                2 => d.y *= 1e-4,
                _ => {}
            }
            let d = d.normalize();
            let found = map.at(octahedral_place(d)) - Vec3::splat(2.0);
            assert!((found - d).length() < 0.03, "{d:?}: {found:?}");
        }
    }
}
