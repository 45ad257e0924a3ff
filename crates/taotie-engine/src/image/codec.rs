//! Stored texels to linear values and back: single codes, as the same polynomial in every lane, and whole rows.

use super::Encoding;
use crate::math::srgb::{Codes, in_low_bits};
use crate::math::{Lane, Pack, Vec3};

/// The encoding of one level.
#[derive(Debug, Clone)]
pub(super) struct Codec {
    pub encoding: Encoding,
    /// Normals of the finest level become unit vectors before they are averaged, and have no variance.
    pub is_finest: bool,
    srgb: Option<Box<Srgb>>,
}

/// The tables for decoding and encoding 8-bit colour.
#[derive(Debug, Clone)]
struct Srgb {
    decode: [f32; 256],
    codes: Codes,
}

impl Codec {
    pub fn new(encoding: Encoding) -> Self {
        let srgb = (encoding == Encoding::Srgb).then(|| {
            let decode = decode_u8(encoding);
            Box::new(Srgb { decode, codes: nearest_codes(&decode) })
        });
        Self { encoding, is_finest: true, srgb }
    }
}

/// The linear value of each 8-bit code.
pub(super) fn decode_u8(encoding: Encoding) -> [f32; 256] {
    std::array::from_fn(|code| match encoding {
        Encoding::Linear | Encoding::Normal => (code as f64 / 255.0) as f32,
        Encoding::Srgb => linear_from_code(code as f32),
    })
}

/// The index of the entry nearest to a value, for a table that rises from 0 to 1; the larger index if two are equally
/// near.
fn nearest_codes(table: &[f32; 256]) -> Codes {
    Codes::new(&std::array::from_fn(|i| {
        let (below, above) = (table[i], table[i + 1]);
        let (mut low, mut high) = (below.to_bits(), above.to_bits());
        while high - low > 1 {
            let middle = low.midpoint(high);
            let value = f32::from_bits(middle);
            *(if value - below < above - value { &mut low } else { &mut high }) = middle;
        }
        high
    }))
}

/// Channels in one of the stored precisions. Rows of floats are padded to whole packs.
pub(super) trait Texel: Copy + Default + Send + Sync {
    /// Decodes a row of texels into its contribution to the means of the next level.
    fn decode<P: Pack>(token: P::Token, codec: &Codec, from: &[[Self; 4]], to: &mut [[f32; 4]]);
    /// Encodes a row of means, which is modified.
    fn encode<P: Pack>(token: P::Token, codec: &Codec, means: &mut [[f32; 4]], to: &mut [[Self; 4]]);
}

impl Texel for u8 {
    #[inline(always)]
    fn decode<P: Pack>(token: P::Token, codec: &Codec, from: &[[Self; 4]], to: &mut [[f32; 4]]) {
        match codec.srgb.as_deref() {
            Some(Srgb { decode, .. }) => {
                for ([r, g, b, a], to) in from.iter().zip(to) {
                    let color = |code: &u8| decode[usize::from(*code)];
                    *to = [color(r), color(g), color(b), f32::from(*a) / 255.0];
                }
            }
            None => {
                for (from, to) in from.as_flattened().iter().zip(to.as_flattened_mut()) {
                    *to = f32::from(*from) / 255.0;
                }
                finest_normals::<P>(token, codec, to);
            }
        }
    }

    #[inline(always)]
    fn encode<P: Pack>(token: P::Token, codec: &Codec, means: &mut [[f32; 4]], to: &mut [[Self; 4]]) {
        match codec.srgb.as_deref() {
            Some(Srgb { codes, .. }) => {
                prepare_srgb::<P>(token, means);
                for (mean, to) in means.iter().zip(to) {
                    let [r, g, b, a] = *mean;
                    *to = [codes.of(r), codes.of(g), codes.of(b), a.to_bits() as u8];
                }
            }
            None => {
                round_codes::<P>(token, 255.0, means);
                for (mean, to) in means.as_flattened().iter().zip(to.as_flattened_mut()) {
                    *to = mean.to_bits() as u8;
                }
            }
        }
    }
}

impl Texel for u16 {
    #[inline(always)]
    fn decode<P: Pack>(token: P::Token, codec: &Codec, from: &[[Self; 4]], to: &mut [[f32; 4]]) {
        for (from, to) in from.as_flattened().iter().zip(to.as_flattened_mut()) {
            *to = f32::from(*from) / 65535.0;
        }
        finest_normals::<P>(token, codec, to);
    }

    #[inline(always)]
    fn encode<P: Pack>(token: P::Token, codec: &Codec, means: &mut [[f32; 4]], to: &mut [[Self; 4]]) {
        put_variances::<P>(token, codec, means);
        round_codes::<P>(token, 65535.0, means);
        for (mean, to) in means.as_flattened().iter().zip(to.as_flattened_mut()) {
            *to = mean.to_bits() as u16;
        }
    }
}

impl Texel for f32 {
    #[inline(always)]
    fn decode<P: Pack>(token: P::Token, codec: &Codec, from: &[[Self; 4]], to: &mut [[f32; 4]]) {
        to[..from.len()].copy_from_slice(from);
        finest_normals::<P>(token, codec, to);
    }

    #[inline(always)]
    fn encode<P: Pack>(token: P::Token, codec: &Codec, means: &mut [[f32; 4]], to: &mut [[Self; 4]]) {
        put_variances::<P>(token, codec, means);
        let count = to.len();
        to.copy_from_slice(&means[..count]);
    }
}

/// Normalises the normals of the finest level, still stored as (n + 1)/2, and sets the variance to zero.
#[inline(always)]
fn finest_normals<P: Pack>(token: P::Token, codec: &Codec, row: &mut [[f32; 4]]) {
    if codec.encoding != Encoding::Normal || !codec.is_finest {
        return;
    }
    for texels in row.chunks_exact_mut(P::LANES) {
        let [r, g, b, a] = P::load_pixels(token, texels);
        let (zero, one, two) = (a.lit(0.0), a.lit(1.0), a.lit(2.0));
        let n = vector(r, g, b).normalize_or(Vec3::new(zero, zero, one));
        P::store_pixels([(n.x + one) / two, (n.y + one) / two, (n.z + one) / two, zero], texels);
    }
}

/// The variance of unit vectors from their mean: E|n − mean|² = 1 − |mean|².
#[inline(always)]
fn put_variances<P: Pack>(token: P::Token, codec: &Codec, row: &mut [[f32; 4]]) {
    if codec.encoding != Encoding::Normal {
        return;
    }
    for texels in row.chunks_exact_mut(P::LANES) {
        let [r, g, b, a] = P::load_pixels(token, texels);
        let mean = vector(r, g, b);
        let variance = (a.lit(1.0) - mean.dot(mean)).clamp(0.0, 1.0);
        P::store_pixels([r, g, b, variance], texels);
    }
}

#[inline(always)]
fn vector<L: Lane>(r: L, g: L, b: L) -> Vec3<L> {
    let (one, two) = (r.lit(1.0), r.lit(2.0));
    Vec3::new(two * r - one, two * g - one, two * b - one)
}

/// Colours prepared for lookup, alphas with their code in the lowest bits.
#[inline(always)]
fn prepare_srgb<P: Pack>(token: P::Token, row: &mut [[f32; 4]]) {
    for texels in row.chunks_exact_mut(P::LANES) {
        let [r, g, b, a] = P::load_pixels(token, texels);
        let alpha = low_code(a, 255.0);
        P::store_pixels([Codes::bounded(r), Codes::bounded(g), Codes::bounded(b), alpha], texels);
    }
}

/// Converts values in [0, 1] to floats with their code in the lowest bits.
#[inline(always)]
fn round_codes<P: Pack>(token: P::Token, top: f64, row: &mut [[f32; 4]]) {
    for values in row.as_flattened_mut().chunks_exact_mut(P::LANES) {
        low_code(P::load(token, values), top).store(values);
    }
}

#[inline(always)]
fn low_code<L: Lane>(value: L, top: f64) -> L {
    in_low_bits((value * value.lit(top) + value.lit(0.5)).floor())
}

/// Up to this code, sRGB is linear: 0.04045 · 255 = 10.3.
const LINE_UP_TO: f64 = 10.5;

/// The slope of that segment, per code.
const LINE: f64 = 1.0 / (255.0 * 12.92);

/// Minimax over the codes from 11 to 255, the error weighted by the step between codes; lowest power first.
const CURVE: [f64; 7] = [
    8.766_406_683e-4,
    1.346_828_103e-4,
    7.685_941_478e-6,
    4.609_535_476e-8,
    -1.240_998_634e-10,
    2.845_350_744e-13,
    -2.960_075_236e-16,
];

/// The linear value of an 8-bit sRGB code, [0, 255] to [0, 1]; 0 and 255 exactly.
///
/// Within 0.004 of the step between two codes. Law: `tests::codes_are_decoded_as_the_standard_says`.
/// Source: IEC 61966-2-1.
#[inline(always)]
pub(super) fn linear_from_code<L: Lane>(code: L) -> L {
    let [c0, c1, c2, c3, c4, c5, c6] = CURVE;
    let curve = code * code.lit(c6) + code.lit(c5);
    let curve = curve * code + code.lit(c4);
    let curve = curve * code + code.lit(c3);
    let curve = curve * code + code.lit(c2);
    let curve = curve * code + code.lit(c1);
    let curve = curve * code + code.lit(c0);
    L::select(code.lt(code.lit(LINE_UP_TO)), code * code.lit(LINE), curve)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::srgb::linear_from_srgb;

    #[test]
    fn codes_are_decoded_as_the_standard_says() {
        let truth = |code: i32| linear_from_srgb(f64::from(code) / 255.0);
        for code in 0..=255 {
            let step = truth(code.max(1)) - truth(code.max(1) - 1);
            let error = (f64::from(linear_from_code(code as f32)) - truth(code)).abs();
            assert!(error <= 0.004 * step, "{code}: {error} of {step}");
        }
        assert_eq!((linear_from_code(0.0f32), linear_from_code(255.0f32)), (0.0, 1.0));
    }
}
