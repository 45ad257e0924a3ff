//! The light of an environment at several roughnesses, each an image of the sphere unfolded to a square; interpolated
//! for roughnesses in between.

use super::texels::{HalfTexels, bilinear, linear};
use crate::math::{Lane, Mask, Number, Vec3, scalar};
use crate::parallel;

/// The light at one roughness.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RoughnessLevel {
    /// Roughness², (0, 1].
    pub(super) alpha: f32,
    pub(super) map: Octahedron,
}

/// Levels from the smoothest to the roughest, which has roughness 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Levels(pub(super) Vec<RoughnessLevel>);

/// The α from which levels are dense; then their density below and above. Interpolating between two lobes of GGX
/// whose α differ by a factor of e^δ has an error of up to 0.18 δ² in the mean square; steps above are 1.14.
const DENSE_FROM: f64 = 0.04;
const SPARSE: (u32, f64) = (6, 1.5);
const DENSE: u32 = 24;

/// Levels per octave of α below and above: 1/log2 1.5 and 24/log2 25.
const SPARSE_TO_OCTAVE: f64 = 1.709_511_291_351_454_7;
const DENSE_TO_OCTAVE: f64 = 5.168_118_696_880_717;

/// The factor from one dense level's α to the next: 25^(1/24).
const DENSE_STEP: f64 = 1.143_529_836_082_920_2;

/// The α of each level.
pub(super) fn alphas() -> Vec<f64> {
    let sparse = (1..=SPARSE.0).rev().map(|n| DENSE_FROM * scalar::pow(SPARSE.1, -f64::from(n)));
    let dense = (0..=DENSE).map(|n| scalar::pow(DENSE_FROM, 1.0 - f64::from(n) / f64::from(DENSE)));
    sparse.chain(dense).collect()
}

/// The two levels around a roughness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelPosition<L> {
    /// The index of the lower level; −1 if all are rougher.
    pub below: L,
    /// The weight of the upper level in the mean.
    pub share: L,
}

/// The weight of the smoothest level, whose roughness² is `alpha`, relative to the unfiltered light, for a lower
/// `roughness`.
#[inline(always)]
pub fn share_of_smoothest<L: Lane>(roughness: L, alpha: L) -> L {
    roughness * roughness / alpha
}

impl<L: Lane> LevelPosition<L> {
    /// Finds the levels of a `roughness` in [0, 1].
    ///
    /// Between levels light is linear in 1/α: of all functions of α, this one has the smallest error for an isolated
    /// bright texel, since the second derivative of a lobe by ln α, as far as it resembles the first, is its
    /// negative.
    #[inline(always)]
    pub fn of(roughness: L) -> Self {
        let one = roughness.lit(1.0);
        let octaves = (roughness * roughness * one.lit(1.0 / DENSE_FROM)).max(one.lit(1e-9)).log2();
        let sparse = octaves.lt(one.lit(0.0));
        let to_octave = L::select(sparse, one.lit(SPARSE_TO_OCTAVE), one.lit(DENSE_TO_OCTAVE));
        let position = octaves * to_octave + one.lit(f64::from(SPARSE.0));
        let position = position.clamp(-1.0, f64::from(SPARSE.0 + DENSE));
        let below = position.floor();
        // 1/α decreases from one level to the next by `step`, of which `left` remains to the roughness.
        let step = L::select(sparse, one.lit(SPARSE.1), one.lit(DENSE_STEP));
        let left = ((one - (position - below)) / to_octave).exp2();
        Self { below, share: (step - left) / (step - one) }
    }
}

impl Levels {
    /// The light at `roughness`, [0, 1], in a direction. `mirror` returns the unfiltered light there.
    #[inline]
    pub(super) fn at<L: Number>(
        &self,
        direction: Vec3<L>,
        roughness: L,
        mirror: impl FnOnce() -> Vec3<L>,
    ) -> Vec3<L> {
        let (place, zero) = (octahedral_place(direction), roughness.lit(0.0));
        let LevelPosition { below, share } = LevelPosition::of(roughness);
        if zero.le(below).any() {
            let (below, above) = (self.numbered(below.index()), self.numbered(below.index() + 1));
            return linear(below.at(place), above.at(place), share);
        }
        let smoothest = &self.0[0];
        let share = share_of_smoothest(roughness, roughness.lit(f64::from(smoothest.alpha)));
        if zero.lt(share).any() { linear(mirror(), smoothest.map.at(place), share) } else { mirror() }
    }

    /// A level by its index; the roughest beyond the last.
    #[inline]
    pub(super) fn numbered(&self, number: usize) -> &Octahedron {
        &self.0[number.min(self.0.len() - 1)].map
    }

    /// The number of levels; at least one.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }
}

/// An image of the sphere unfolded to a square: an octahedron's upper faces in the middle, the lower ones folded out.
/// It has a border, so that lookup between texels is seamless.
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

    /// The fractional index of the level of a roughness.
    fn position(roughness: f64) -> f64 {
        let between = LevelPosition::of(roughness);
        between.below + between.share
    }

    #[test]
    fn a_level_is_found_by_its_own_roughness() {
        for (number, alpha) in alphas().into_iter().enumerate() {
            assert!(
                (position(alpha.sqrt()) - number as f64).abs() < 1e-5,
                "{number}: {}",
                position(alpha.sqrt())
            );
        }
        assert_eq!((LevelPosition::of(0.0f32).below, LevelPosition::of(0.05f32).below), (-1.0, -1.0));
        let LevelPosition { below, share } = LevelPosition::of(1.0f32);
        assert!((below + share - 30.0).abs() < 1e-4);
        assert_eq!(LevelPosition::of(2.0f32).below, 30.0);
    }

    #[test]
    fn between_levels_the_share_is_linear_in_the_inverse_of_alpha() {
        for pair in alphas().windows(2) {
            let (below, above) = (1.0 / pair[0], 1.0 / pair[1]);
            for share in [0.1, 0.5, 0.8] {
                let alpha = 1.0 / (below + (above - below) * share);
                assert!((LevelPosition::of(alpha.sqrt()).share - share).abs() < 1e-5, "{pair:?} {share}");
            }
        }
    }

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
