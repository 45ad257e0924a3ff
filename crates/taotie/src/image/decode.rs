//! Decoding from stored codes to linear values, as the same polynomial in every lane.

use crate::math::Lane;

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
