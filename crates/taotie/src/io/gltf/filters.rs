//! The filters of EXT_meshopt_compression and KHR_meshopt_compression: from stored values to numbers.
//!
//! meshoptimizer has them too, but it uses the processor's approximate reciprocals for speed, which differ between
//! vendors. These give the same bits everywhere. Source: KHR_meshopt_compression, appendix B.
//! Law: they agree with meshoptimizer's to one unit (`tests::meshoptimizer_agrees_to_one_unit`).

use std::f64::consts::FRAC_1_SQRT_2;

/// The bit width of the numbers of a four-component vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Width {
    /// 8 bits.
    Byte,
    /// 16 bits.
    Short,
}

impl Width {
    /// Returns the largest signed number.
    fn signed_one(self) -> f64 {
        match self {
            Self::Byte => 127.0,
            Self::Short => 32767.0,
        }
    }

    /// Returns the largest unsigned number.
    fn unsigned_one(self) -> f64 {
        2.0 * self.signed_one() + 1.0
    }
}

/// Decodes unit vectors from two octahedral coordinates and the stored 1; the fourth number is unchanged.
pub(super) fn octahedral(bytes: &mut [u8], width: Width) {
    each(bytes, width, |[x, y, one, rest]| {
        let one = f64::from(one.max(1));
        let (x, y) = (f64::from(x) / one, f64::from(y) / one);
        let z = 1.0 - x.abs() - y.abs();
        // The lower half is folded over the corners of the upper half.
        let fold = z.min(0.0);
        let (x, y) = (x - fold.abs().copysign(x), y - fold.abs().copysign(y));
        let scale = width.signed_one() / (x * x + y * y + z * z).sqrt();
        [nearest(x * scale), nearest(y * scale), nearest(z * scale), rest]
    });
}

/// Decodes unit quaternions from 16-bit numbers: three components, and a fourth number with the stored 1 and, in two
/// bits, the index of the largest component, which is positive and omitted.
pub(super) fn quaternion(bytes: &mut [u8]) {
    each(bytes, Width::Short, |[x, y, z, last]| {
        let scale = FRAC_1_SQRT_2 / f64::from((last | 3).max(1));
        let last = last & 3;
        let [x, y, z] = [x, y, z].map(|v| f64::from(v) * scale);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let mut turned = [0; 4];
        for (place, value) in (last as usize..).zip([w, x, y, z]) {
            turned[place % 4] = nearest(value * Width::Short.signed_one());
        }
        turned
    });
}

/// Decodes floats from a signed 8-bit exponent and a signed 24-bit mantissa.
pub(super) fn exponential(bytes: &mut [u8]) {
    for word in bytes.as_chunks_mut::<4>().0 {
        let stored = i32::from_le_bytes(*word);
        let (exponent, mantissa) = (stored >> 24, (stored << 8) >> 8);
        let power = f64::from_bits(((1023 + exponent) as u64) << 52);
        *word = ((f64::from(mantissa) * power) as f32).to_le_bytes();
    }
}

/// Decodes colours from luma, two differences, and alpha of one bit less, below a bit that marks the bit depth.
pub(super) fn color(bytes: &mut [u8], width: Width) {
    let most = width.unsigned_one();
    each(bytes, width, |[y, co, cg, a]| {
        // Numbers are read as signed; luma and alpha are not.
        let [y, a] = [y, a].map(|v| if v < 0 { v + most as i32 + 1 } else { v });
        let one = (1 << (32 - a.leading_zeros())) - 1;
        let a = a & (one >> 1);
        let a = (a << 1) | (a & 1);
        let scale = most / f64::from(one.max(1));
        [y + co - cg, y + cg, y - co - cg, a].map(|v| nearest((f64::from(v) * scale).clamp(0.0, most)))
    });
}

/// Replaces each vector of four signed little-endian numbers.
fn each(bytes: &mut [u8], width: Width, decode: impl Fn([i32; 4]) -> [i32; 4]) {
    match width {
        Width::Byte => {
            for v in bytes.as_chunks_mut::<4>().0 {
                *v = decode(v.map(|b| i32::from(b as i8))).map(|n| n as u8);
            }
        }
        Width::Short => {
            for v in bytes.as_chunks_mut::<8>().0 {
                let [a, b, c, d] = [0, 2, 4, 6].map(|i| i32::from(i16::from_le_bytes([v[i], v[i + 1]])));
                let decoded = decode([a, b, c, d]).map(|n| (n as u16).to_le_bytes());
                v.copy_from_slice(decoded.as_flattened());
            }
        }
    }
}

/// Rounds to the nearest integer, halves away from zero.
fn nearest(v: f64) -> i32 {
    v.round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of four numbers in [−1, 1], the same in every run.
    fn vectors() -> Vec<[f32; 4]> {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0) as f32
        };
        (0..2000).map(|_| std::array::from_fn(|_| next())).collect()
    }

    fn units(parts: usize) -> Vec<[f32; 4]> {
        let unit = |v: [f32; 4]| {
            let length = v[..parts].iter().map(|x| x * x).sum::<f32>().sqrt();
            std::array::from_fn(|k| if k < parts { v[k] / length } else { 1.0 })
        };
        vectors().into_iter().map(unit).collect()
    }

    fn shorts(vectors: &[[i16; 4]]) -> Vec<u8> {
        vectors.iter().flatten().flat_map(|v| v.to_le_bytes()).collect()
    }

    fn from_shorts(bytes: &[u8]) -> Vec<i32> {
        bytes.as_chunks::<2>().0.iter().map(|b| i32::from(i16::from_le_bytes(*b))).collect()
    }

    fn assert_close(ours: impl IntoIterator<Item = i32>, theirs: impl IntoIterator<Item = i32>) {
        let (ours, theirs): (Vec<_>, Vec<_>) = (ours.into_iter().collect(), theirs.into_iter().collect());
        assert_eq!(ours.len(), theirs.len());
        let apart = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).max();
        assert!(apart <= Some(1), "{apart:?}");
    }

    #[test]
    fn meshoptimizer_agrees_to_one_unit() {
        for bits in [2, 5, 8] {
            let stored: Vec<[i8; 4]> = meshopt::encode_filter_oct(&units(3), bits);
            let (mut ours, mut theirs) =
                (stored.as_flattened().iter().map(|v| *v as u8).collect::<Vec<_>>(), stored);
            octahedral(&mut ours, Width::Byte);
            meshopt::decode_filter_oct(&mut theirs);
            assert_close(
                ours.iter().map(|v| i32::from(*v as i8)),
                theirs.iter().flatten().map(|v| i32::from(*v)),
            );
            let stored: Vec<[u8; 4]> = meshopt::encode_filter_color(&positive(), bits);
            let (mut ours, mut theirs) = (stored.as_flattened().to_vec(), stored);
            color(&mut ours, Width::Byte);
            meshopt::decode_filter_color(&mut theirs);
            assert_close(ours.iter().map(|v| i32::from(*v)), theirs.iter().flatten().map(|v| i32::from(*v)));
        }
        for bits in [4, 12, 16] {
            let mut theirs: Vec<[i16; 4]> = meshopt::encode_filter_oct(&units(3), bits);
            let mut ours = shorts(&theirs);
            octahedral(&mut ours, Width::Short);
            meshopt::decode_filter_oct(&mut theirs);
            assert_close(from_shorts(&ours), theirs.iter().flatten().map(|v| i32::from(*v)));
            let mut theirs = meshopt::encode_filter_quat(&units(4), bits);
            let mut ours = shorts(&theirs);
            quaternion(&mut ours);
            meshopt::decode_filter_quat(&mut theirs);
            assert_close(from_shorts(&ours), theirs.iter().flatten().map(|v| i32::from(*v)));
            let mut theirs: Vec<[u16; 4]> = meshopt::encode_filter_color(&positive(), bits);
            let mut ours: Vec<u8> = theirs.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
            color(&mut ours, Width::Short);
            meshopt::decode_filter_color(&mut theirs);
            let ours = from_shorts(&ours).into_iter().map(|v| i32::from(v as u16));
            assert_close(ours, theirs.iter().flatten().map(|v| i32::from(*v)));
        }
    }

    fn positive() -> Vec<[f32; 4]> {
        vectors().into_iter().map(|v| v.map(f32::abs)).collect()
    }

    #[test]
    fn floats_are_exact() {
        let mut theirs = meshopt::encode_filter_exp(&vectors(), 24, meshopt::EncodeExpMode::Separate);
        let mut ours: Vec<u8> = theirs.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        exponential(&mut ours);
        meshopt::decode_filter_exp(&mut theirs);
        assert_eq!(ours, theirs.iter().flatten().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
        // 2^−3 · 5, 2^2 · −9, and 2^−128, which is 2^21 times the smallest float.
        let mut bytes =
            [0xfd00_0005u32, 0x02ff_fff7, 0x8000_0001].map(u32::to_le_bytes).as_flattened().to_vec();
        exponential(&mut bytes);
        let floats: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(floats, [0.625, -36.0, f32::from_bits(1 << 21)]);
    }

    #[test]
    fn corners_of_the_octahedron() {
        let mut bytes = [127, 0, 127, 5, 0, 0, 127, 6, 0x81, 0, 127, 7, 127, 127, 127, 8];
        octahedral(&mut bytes, Width::Byte);
        // +x, +z, −x, and the corner of the square, which is −z.
        assert_eq!(bytes, [127, 0, 0, 5, 0, 0, 127, 6, 0x81, 0, 0, 7, 0, 0, 0x81, 8]);
    }

    /// Bytes that no encoder writes still decode to numbers.
    #[test]
    fn nonsense_is_survived() {
        for byte in [0u8, 1, 0x7f, 0x80, 0xff] {
            for width in [Width::Byte, Width::Short] {
                octahedral(&mut [byte; 24], width);
                color(&mut [byte; 24], width);
            }
            quaternion(&mut [byte; 24]);
            exponential(&mut [byte; 24]);
        }
    }
}
