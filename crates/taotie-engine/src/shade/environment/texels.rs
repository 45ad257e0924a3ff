//! Texels of light in half floats, and the interpolation between them: an environment's image and its levels are
//! large, and read far more often than computed.

use crate::math::{Lane, SimdLevel, Vec3, dispatch_registers};
use crate::parallel;
use half::f16;
use half::slice::{HalfBitsSliceExt, HalfFloatSliceExt};

/// The largest stored radiance; the sun's disc has 1.6e9 in cd/m², and no image contains all of it.
pub(super) const MAX_RADIANCE: f32 = 1e9;

/// Texels of three half floats, all times one power of two, which brings the brightest near the end of the range.
///
/// A texel is within 2⁻¹¹ of its true value, and black if that is below 2⁻²⁹ of the brightest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HalfTexels {
    exponent: i32,
    texels: Vec<[u16; 3]>,
    decode: f32,
}

impl HalfTexels {
    /// Encodes linear RGB in [0, [`MAX_RADIANCE`]]; a fourth channel is ignored.
    pub(super) fn encode<const N: usize>(colors: &[[f32; N]]) -> Self {
        let level = SimdLevel::fastest();
        let piece = |i: usize| &colors[i * PIECE..colors.len().min((i + 1) * PIECE)];
        let brightest = parallel::tasks(
            colors.len().div_ceil(PIECE),
            &|i| dispatch_registers!(level, _simd => brightest(piece(i))),
        );
        let exponent = exponent_of(brightest.into_iter().fold(0.0, brighter)) - 15;
        let scale = power_of_two(-exponent);
        let mut texels = vec![[0; 3]; colors.len()];
        parallel::pieces(&mut texels, PIECE, &|i, texels| {
            halves(piece(i), scale, texels);
        });
        Self::new(exponent, texels)
    }

    fn new(exponent: i32, texels: Vec<[u16; 3]>) -> Self {
        Self { exponent, texels, decode: power_of_two(exponent + 112) as f32 }
    }

    /// Creates an empty buffer with the capacity `room`, for the value of [`Self::exponent`]; `None` if that is
    /// invalid.
    pub(super) fn with_exponent(exponent: i32, room: usize) -> Option<Self> {
        let exponents = exponent_of(0.0) - 15..=exponent_of(MAX_RADIANCE) - 15;
        exponents.contains(&exponent).then(|| Self::new(exponent, Vec::with_capacity(room)))
    }

    /// Adds texels of three half floats, little endian, as returned by [`Self::texels`]; returns true if all are
    /// valid.
    #[must_use]
    pub(super) fn add_stored(&mut self, stored: &[[u8; 6]]) -> bool {
        let half = |low: u8, high: u8| u16::from_le_bytes([low, high]);
        let before = self.texels.len();
        self.texels.extend(stored.iter().map(|b| [half(b[0], b[1]), half(b[2], b[3]), half(b[4], b[5])]));
        let added = self.texels[before..].as_flattened();
        added.iter().fold(true, |sound, half| sound & (*half < f16::INFINITY.to_bits()))
    }

    /// The exponent of two by which the stored numbers are multiplied.
    pub(super) fn exponent(&self) -> i32 {
        self.exponent
    }

    /// The half floats as stored.
    pub(super) fn texels(&self) -> &[[u16; 3]] {
        &self.texels
    }

    /// Linear RGB.
    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Vec3 {
        let [r, g, b] = self.texels[index];
        Vec3::new(self.float(r), self.float(g), self.float(b))
    }

    /// Two neighbours as stored; black beyond the last.
    #[inline]
    pub(super) fn two(&self, index: usize) -> [[u16; 3]; 2] {
        match self.texels.get(index..index + 2) {
            Some(&[a, b]) => [a, b],
            _ => Default::default(),
        }
    }

    /// The factor of the half floats.
    pub(super) fn half_factor(&self) -> f32 {
        power_of_two(self.exponent) as f32
    }

    /// The factor of half floats whose exponent and mantissa are moved to their positions in a float.
    #[inline]
    pub(super) fn factor(&self) -> f32 {
        self.decode
    }

    /// A half float's exponent and mantissa, moved to their positions in a float, are the same number up to 2¹¹².
    #[inline(always)]
    fn float(&self, stored: u16) -> f32 {
        f32::from_bits(u32::from(stored) << 13) * self.decode
    }
}

/// The number of texels encoded per task.
const PIECE: usize = 4096;

#[inline(always)]
fn brighter(most: f32, value: f32) -> f32 {
    if value > most { value } else { most }
}

/// The largest number of the first three channels, at least 0.
#[inline(always)]
fn brightest<const N: usize>(colors: &[[f32; N]]) -> f32 {
    let (eights, rest) = colors.as_chunks::<8>();
    let mut most = [[0.0; N]; 8];
    for eight in eights {
        for (most, color) in most.as_flattened_mut().iter_mut().zip(eight.as_flattened()) {
            *most = brighter(*most, *color);
        }
    }
    most.iter().chain(rest).flat_map(|color| &color[..3]).fold(0.0, |most, value| brighter(most, *value))
}

/// Writes the nearest half floats of colours times `scale`; zeros if these would have less than full precision.
fn halves<const N: usize>(colors: &[[f32; N]], scale: f64, texels: &mut [[u16; 3]]) {
    let scaled = |v: f32| (f64::from(v) * scale) as f32;
    let scaled: Vec<[f32; 3]> = colors.iter().map(|c| [scaled(c[0]), scaled(c[1]), scaled(c[2])]).collect();
    let halves = texels.as_flattened_mut().reinterpret_cast_mut::<f16>();
    halves.convert_from_f32_slice(scaled.as_flattened());
    for half in halves.iter_mut().filter(|half| **half < f16::MIN_POSITIVE) {
        *half = f16::ZERO;
    }
}

/// e with 2^(e−1) ≤ `value` < 2^e, for values from 2⁻¹²⁶; −126 below.
fn exponent_of(value: f32) -> i32 {
    ((value.to_bits() >> 23) & 0xff) as i32 - 126
}

/// 2^`n` for n in [−1022, 1023].
fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

/// The mean of `a` and `b`; `share`, in [0, 1], is the weight of `b`.
#[inline(always)]
pub fn linear<L: Lane>(a: Vec3<L>, b: Vec3<L>, share: L) -> Vec3<L> {
    a * (share.lit(1.0) - share) + b * share
}

/// Bilinear interpolation of the upper left and right and the lower left and right texels; `across` and `down`, in
/// [0, 1], are the weights of the right and the lower texels.
#[inline(always)]
pub fn bilinear<L: Lane>([a, b, c, d]: [Vec3<L>; 4], [across, down]: [L; 2]) -> Vec3<L> {
    linear(linear(a, b, across), linear(c, d, across), down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_within_half_a_unit_in_the_last_place() {
        for brightest in [MAX_RADIANCE, 70_000.0, 65_504.0, 1.0, 3e-7] {
            let values: Vec<f32> = (0..29).map(|n| brightest / (1u32 << n) as f32 * 0.999).collect();
            let texels = HalfTexels::encode(&values.iter().map(|v| [*v, 0.0, *v, 1.0]).collect::<Vec<_>>());
            for (i, value) in values.iter().enumerate() {
                let found = texels.get(i);
                assert!((found.x / value - 1.0).abs() <= 1.0 / 2048.0, "{value}: {}", found.x);
                assert_eq!((found.y, found.z), (0.0, found.x));
            }
        }
    }

    #[test]
    fn every_half_float_is_decoded_as_its_format_says() {
        for bits in (1u16 << 10)..(31 << 10) {
            let mut texels = HalfTexels::with_exponent(3, 1).unwrap();
            assert!(texels.add_stored(&[[bits as u8, (bits >> 8) as u8, 0, 0, 0, 0]]));
            assert_eq!(texels.get(0).x, f16::from_bits(bits).to_f32() * 8.0);
        }
    }

    #[test]
    fn black_stays_black() {
        let texels = HalfTexels::encode(&[[0.0, 1e-30, 1.0, 1.0]]);
        assert_eq!(texels.get(0), Vec3::new(0.0, 0.0, 1.0));
        let texels = HalfTexels::encode(&[[0.0; 4]]);
        assert_eq!(texels.get(0), Vec3::splat(0.0));
    }
}
