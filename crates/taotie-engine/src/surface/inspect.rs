//! Inspects a texture's pixels: whether it is a normal map, which way green points, and invalid texels.

use crate::image::{Bitmap, Texels};
use crate::math::{Vec2, Vec3};
use crate::parallel;

/// The probable kind of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NormalMapKind {
    /// Unit vectors, nearly all with z > 0.
    Tangent,
    /// Unit vectors in all directions.
    Object,
    /// Not unit vectors.
    #[serde(rename = "none")]
    No,
}

/// The direction of a normal map's green channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GreenVerdict {
    /// +Y: OpenGL, glTF.
    Up,
    /// −Y: DirectX.
    Down,
    /// The map has too little relief, or evidence for both.
    Unclear,
}

/// The outcome of [`green_direction`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GreenGuess {
    /// The direction.
    pub verdict: GreenVerdict,
    /// The confidence, [0, 1]; 0 if unclear.
    pub confidence: f32,
}

/// Counts the texels that cannot be tangent-space normals: those with blue at or below 0.5. Vectors of about unit length
/// that are hardly below the surface do not count: lossy formats such as KTX2 turn some of those in the surface there.
pub fn invalid_texels(bitmap: &Bitmap) -> usize {
    let is_below = |i: usize| match bitmap.texels() {
        Texels::U8(texels) => texels[i][2] <= 127,
        Texels::U16(texels) => texels[i][2] <= 32_767,
        Texels::F32(texels) => texels[i][2] <= 0.5 || texels[i][2].is_nan(),
    };
    parallel::count(bitmap.texels().len(), |i| is_below(i) && !is_in_surface(vector(bitmap, i)))
}

/// Returns true for a vector of about unit length that is at most 7° below the surface.
fn is_in_surface(v: Vec3) -> bool {
    v.z > -0.12 && (v.length() - 1.0).abs() < NEARLY_UNIT
}

/// The deviation from unit length below which a vector counts as a normal.
const NEARLY_UNIT: f32 = 0.2;

/// Guesses from its pixels whether a texture is a normal map.
///
/// Nine in ten vectors must be within 0.2 of unit length and six in ten within 0.06; grey texels (padding) do not
/// count. It is a tangent-space map if 99 in 100 of the former have z > 0.
pub fn is_normal_map(bitmap: &Bitmap) -> NormalMapKind {
    let add = |sum: &mut Tally, i: usize| *sum = sum.plus(Tally::of(vector(bitmap, i)));
    let tallies = parallel::fold(bitmap.texels().len(), add);
    tallies.into_iter().fold(Tally::default(), Tally::plus).verdict()
}

/// The vector of texel `i`, of any length.
fn vector(bitmap: &Bitmap, i: usize) -> Vec3 {
    let [r, g, b, _] = bitmap.stored(i);
    Vec3::new(2.0 * r - 1.0, 2.0 * g - 1.0, 2.0 * b - 1.0)
}

/// Counts of texels: all that are not grey, those nearly and very nearly unit, and those of the nearly unit ones with
/// z > 0.
#[derive(Default, Clone, Copy)]
struct Tally {
    all: usize,
    near: usize,
    very_near: usize,
    upward: usize,
}

impl Tally {
    fn of(v: Vec3) -> Self {
        if v.x == v.y && v.y == v.z {
            return Self::default();
        }
        let off = (v.length() - 1.0).abs();
        Self {
            all: 1,
            near: usize::from(off < NEARLY_UNIT),
            very_near: usize::from(off < 0.06),
            upward: usize::from(off < NEARLY_UNIT && v.z > 0.0),
        }
    }

    fn plus(self, o: Self) -> Self {
        Self {
            all: self.all + o.all,
            near: self.near + o.near,
            very_near: self.very_near + o.very_near,
            upward: self.upward + o.upward,
        }
    }

    fn verdict(self) -> NormalMapKind {
        if self.all == 0 || self.near * 10 < self.all * 9 || self.very_near * 10 < self.all * 6 {
            NormalMapKind::No
        } else if self.upward * 100 >= self.near * 99 {
            NormalMapKind::Tangent
        } else {
            NormalMapKind::Object
        }
    }
}

/// Guesses from the curl of a tangent-space normal map which way its green channel points.
///
/// A map made from relief contains the slopes p = ∂h/∂x and q = ∂h/∂y of a height, so ∂p/∂y = ∂q/∂x. Between the two
/// possible signs of green, Σ (∂p/∂y − ∂q/∂x)² differs by four times Σ ∂p/∂y · ∂q/∂x, whose sign therefore decides.
/// It is summed over cells of 2×2 texels, without those at seams and holes, in blocks; if the blocks' sums had random
/// signs, a total of t standard deviations would have a probability of at most 1/t² (Chebyshev), which is the doubt.
pub fn green_direction(bitmap: &Bitmap) -> GreenGuess {
    const ENOUGH: f64 = 0.9;
    let votes = block_votes(bitmap);
    let total: f64 = votes.iter().sum();
    let variance: f64 = votes.iter().map(|vote| vote * vote).sum();
    let doubt = variance / (total * total);
    let confidence = if doubt < 1.0 { 1.0 - doubt } else { 0.0 };
    if confidence < ENOUGH {
        return GreenGuess { verdict: GreenVerdict::Unclear, confidence: 0.0 };
    }
    let verdict = if total > 0.0 { GreenVerdict::Up } else { GreenVerdict::Down };
    GreenGuess { verdict, confidence: confidence as f32 }
}

/// Σ ∂p/∂y · ∂q/∂x of each block, y pointing up the image: positive if green points up.
fn block_votes(bitmap: &Bitmap) -> Vec<f64> {
    const SIDE: usize = 32;
    let (w, h) = (bitmap.width() as usize - 1, bitmap.height() as usize - 1);
    let across = w.div_ceil(SIDE);
    let vote = |block: usize| -> f64 {
        let (x0, y0) = (block % across * SIDE, block / across * SIDE);
        let rows = y0..(y0 + SIDE).min(h);
        rows.flat_map(|y| (x0..(x0 + SIDE).min(w)).map(move |x| (x, y)))
            .filter_map(|(x, y)| cell_vote(bitmap, x, y))
            .sum()
    };
    parallel::collect(across * h.div_ceil(SIDE), vote)
}

/// ∂p/∂y · ∂q/∂x at the corner shared by four texels; `None` at a seam or hole.
fn cell_vote(bitmap: &Bitmap, x: usize, y: usize) -> Option<f64> {
    const SEAM: f32 = 0.5;
    let w = bitmap.width() as usize;
    let at = |x: usize, y: usize| slopes(vector(bitmap, y * w + x));
    let (a, b, c, d) = (at(x, y)?, at(x + 1, y)?, at(x, y + 1)?, at(x + 1, y + 1)?);
    let dp_dy = 0.5 * ((a.x + b.x) - (c.x + d.x));
    let dq_dx = 0.5 * ((b.y + d.y) - (a.y + c.y));
    let smooth = dp_dy.abs() < SEAM && dq_dx.abs() < SEAM;
    smooth.then(|| f64::from(dp_dy) * f64::from(dq_dx))
}

/// The slopes of the height with the normal `v`, if it is nearly unit and not steep.
fn slopes(v: Vec3) -> Option<Vec2> {
    let sound = (v.length() - 1.0).abs() < 0.2 && v.z > 0.2;
    sound.then(|| Vec2::new(-v.x / v.z, -v.y / v.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;

    fn picture(channels: u8, texel: impl Fn(f64, f64) -> [f64; 3]) -> Bitmap {
        let texels = (0..4096)
            .map(|i| {
                let [r, g, b] = texel(f64::from(i % 64) / 63.0, f64::from(i / 64) / 63.0);
                [r, g, b, 1.0].map(|v| (v * 255.0 + 0.5) as u8)
            })
            .collect();
        Bitmap::new(64, 64, channels, Texels::U8(texels)).unwrap()
    }

    fn encoded(x: f64, y: f64, z: f64) -> [f64; 3] {
        let length = (x * x + y * y + z * z).sqrt();
        [x, y, z].map(|v| v / length * 0.5 + 0.5)
    }

    #[test]
    fn tells_heights_from_both_kinds_of_normals() {
        let kind = |channels, texel: &dyn Fn(f64, f64) -> [f64; 3]| is_normal_map(&picture(channels, texel));
        assert_eq!(kind(3, &|u, v| [u * v; 3]), NormalMapKind::No);
        assert_eq!(kind(1, &|_, _| [0.5; 3]), NormalMapKind::No);
        assert_eq!(kind(3, &|u, v| [u, v, 0.2]), NormalMapKind::No);
        assert_eq!(kind(3, &|_, _| [0.0; 3]), NormalMapKind::No);
        assert_eq!(kind(3, &|_, _| [0.5, 0.5, 1.0]), NormalMapKind::Tangent);
        let waves = |u: f64, v: f64| encoded(scalar::sin(u * 40.0), scalar::cos(v * 30.0), 1.0);
        assert_eq!(kind(3, &waves), NormalMapKind::Tangent);
        assert_eq!(kind(3, &|u, v| if u < 0.7 { [0.0; 3] } else { waves(u, v) }), NormalMapKind::Tangent);
        let sphere = |u: f64, v: f64| {
            let (a, z) = (u * std::f64::consts::TAU, 2.0 * v - 1.0);
            let r = (1.0 - z * z).sqrt();
            encoded(r * scalar::cos(a), r * scalar::sin(a), z)
        };
        assert_eq!(kind(3, &sphere), NormalMapKind::Object);
    }
}
