//! The sRGB transfer function, IEC 61966-2-1, and tables of 8-bit codes for it and similar curves.
//!
//! Images in memory are linear; the function itself only runs when reading and writing files.

use super::{Lane, scalar};

/// The linear value of an encoded value; both in [0, 1].
pub fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { scalar::pow((encoded + 0.055) / 1.055, 2.4) }
}

/// The encoded value of a linear value; both in [0, 1].
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * scalar::pow(linear, 1.0 / 2.4) - 0.055 }
}

/// The number of low bits of a float that do not affect its bucket.
const SHIFT: u32 = 16;
/// The smallest value in the table, below the first threshold.
const LEAST: f32 = 1.0 / 8192.0;
/// The bucket of [`LEAST`].
const FIRST: u32 = LEAST.to_bits() >> SHIFT;
/// The buckets from [`FIRST`] to that of one.
const USED: u32 = (1.0f32.to_bits() >> SHIFT) - FIRST + 1;
/// [`USED`], rounded up to a power of two so that a mask keeps indices in range.
const BUCKETS: usize = 2048;

/// The table of one function from [2⁻¹³, 1] to codes.
///
/// A function that increases with a value is determined by 255 thresholds. A bucket of floats that share sign,
/// exponent and the first seven bits of the mantissa contains at most one threshold of any curve like sRGB's, so one
/// lookup, one addition and one shift give the exact code.
///
/// An entry is added to the bits of a value, so that its code is above the lowest 16 bits: the code at the start of
/// its bucket replaces the bucket's number, and from the threshold upwards the sum carries one more. The index of a
/// bucket is its number modulo the size.
#[derive(Debug, Clone)]
pub(crate) struct Codes([u32; BUCKETS]);

impl Codes {
    /// The function whose code is `i + 1` from the float with the bits `thresholds[i]` upwards. The first is above
    /// 2⁻¹³, and no bucket contains two.
    pub const fn new(thresholds: &[u32; 255]) -> Self {
        let mut table = [0; BUCKETS];
        let (mut bucket, mut code) = (FIRST, 0);
        while bucket < FIRST + USED {
            let (start, end) = (bucket << SHIFT, (bucket + 1) << SHIFT);
            while bits_of(thresholds, code) <= start {
                code += 1;
            }
            assert!(bits_of(thresholds, code + 1) >= end, "a bucket contains at most one threshold");
            let base = ((code as u32) << SHIFT) + end.saturating_sub(bits_of(thresholds, code));
            table[bucket as usize % BUCKETS] = base.wrapping_sub(start);
            bucket += 1;
        }
        Self(table)
    }

    /// The value to look up for one in [0, 1].
    #[inline(always)]
    pub fn bounded<L: Lane>(value: L) -> L {
        value.max(value.lit(f64::from(LEAST)))
    }

    /// The code of a value in [2⁻¹³, 1].
    #[inline(always)]
    pub fn of(&self, value: f32) -> u8 {
        let bits = value.to_bits();
        let sum = self.0[(bits >> SHIFT) as usize % BUCKETS].wrapping_add(bits);
        (sum >> SHIFT) as u8
    }
}

/// The bits of the smallest float with the code `index + 1`; those of infinity for codes that do not exist.
const fn bits_of(thresholds: &[u32; 255], index: usize) -> u32 {
    if index < thresholds.len() { thresholds[index] } else { f32::INFINITY.to_bits() }
}

/// The float whose lowest bits are those of an integer in [0, 2²³).
#[inline(always)]
pub(crate) fn in_low_bits<L: Lane>(integer: L) -> L {
    integer + integer.lit(8_388_608.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_change_at_their_thresholds() {
        let middle = |i: usize| linear_from_srgb((i as f64 + 0.5) / 255.0) as f32;
        let thresholds = std::array::from_fn(|i| middle(i).to_bits());
        let codes = Codes::new(&thresholds);
        for (i, bits) in thresholds.into_iter().enumerate() {
            assert_eq!([bits - 1, bits].map(|b| codes.of(f32::from_bits(b))), [i as u8, i as u8 + 1]);
        }
        assert_eq!([0.0, 1e-5, 1.0].map(|v| codes.of(Codes::bounded(v))), [0, 0, 255]);
    }
}
