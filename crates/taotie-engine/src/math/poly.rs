//! `exp`, `ln` and `pow` as polynomials in [`Lane`] operations: the same bits in every lane and on every machine.
//!
//! The module is based on two minimax polynomials, found by the Remez exchange algorithm in 50 digits
//! (`tests/oracle/poly_coefficients.py` derives and prints them):
//!
//! ```text
//! e^r      = 1 + r + r² Q(r)          |r| ≤ ln 2 / 2            relative error 3.1e-9
//! ln(1+u)  = u − u²/2 + u³ P(u)       √½ − 1 ≤ u ≤ √2 − 1       relative error 7.5e-10
//! ```
//!
//! In `f32`, rounding dominates; in `f64`, the polynomials do, so an `f64` result is accurate to about 1e-8. The
//! bounds stated at each function of one number were found by testing every `f32` of its range: at most 0.99 ulp for
//! `exp` and `exp2`, 0.67 for `ln`, 1.55 for `log2`. The tests below repeat that, by default with a stride.

use super::{Lane, Mask};

/// Q, lowest power first.
const EXP: [f64; 5] = [
    0.499_999_934_517_505_9,
    0.166_665_206_898_973,
    0.041_668_387_346_882_61,
    0.008_368_709_819_672_878,
    0.001_381_461_417_387_859_3,
];

/// P, lowest power first.
const LN: [f64; 9] = [
    0.333_333_126_041_556_44,
    -0.250_000_095_987_141_3,
    0.200_021_186_527_207_4,
    -0.166_679_958_906_437_15,
    0.142_195_525_070_095_36,
    -0.124_055_883_091_720_3,
    0.118_881_605_784_682_34,
    -0.116_756_550_522_314_46,
    0.067_466_483_809_341_26,
];

/// ln 2 in two parts; the first has 9 bits, so that its product with an exponent is exact in `f32`.
const LN_2_HIGH: f64 = 355.0 / 512.0;
const LN_2_LOW: f64 = std::f64::consts::LN_2 - LN_2_HIGH;

/// Below this, e^x is not a normal `f32`.
const EXP_MIN: f64 = -87.33;
/// Up to this, the binary exponent of e^x is at most 127.
const EXP_MAX: f64 = 88.0;
/// The smallest normal `f32`, 2⁻¹²⁶.
const SMALLEST: f64 = f32::MIN_POSITIVE as f64;

/// Σ c_i x^i by Horner's rule, unrolled: a loop would have to be unrolled within the caller of a whole model.
macro_rules! horner {
    ($c:expr, $x:expr; $first:literal $(, $next:literal)*) => {{
        let value = $x.lit($c[$first]);
        $(let value = value * $x + $x.lit($c[$next]);)*
        value
    }};
}
pub(crate) use horner;

/// e^x.
///
/// `f32`: within 1 ulp for x in [−87.33, 88]. Zero below that range, e^88 = 1.65e38 above it: never subnormal,
/// infinite or NaN.
#[inline(always)]
pub fn exp<L: Lane>(x: L) -> L {
    exp_sum(x, x.lit(0.0))
}

/// 2^x.
///
/// `f32`: within 1 ulp for x in [−126, 127], exact at integers. Zero below that range, 2^127 above it.
#[inline(always)]
pub fn exp2<L: Lane>(x: L) -> L {
    let kept = x.clamp(-126.0, 127.0);
    let n = (kept + x.lit(0.5)).floor();
    let power = exp_reduced((kept - n) * x.lit(std::f64::consts::LN_2)).ldexp(n);
    L::select(x.lt(x.lit(-126.0)), x.lit(0.0), power)
}

/// ln x, for a normal `x` above 0.
///
/// `f32`: within 1 ulp. Values below 2⁻¹²⁶, negative or NaN count as 2⁻¹²⁶.
#[inline(always)]
pub fn ln<L: Lane>(x: L) -> L {
    let (high, low) = ln_parts(x);
    high + low
}

/// log₂ x, for a normal `x` above 0.
///
/// `f32`: within 2 ulp, exact at powers of two. Values below 2⁻¹²⁶, negative or NaN count as 2⁻¹²⁶.
#[inline(always)]
pub fn log2<L: Lane>(x: L) -> L {
    let (u, exponent) = reduce(x);
    let (high, low) = ln_1p_parts(u);
    exponent + (high + low) * x.lit(std::f64::consts::LOG2_E)
}

/// x^y for x ≥ 0.
///
/// `f32`: relative error at most 1.2e-7 + 1e-8 |y ln x|, so 2.6e-7 for results above 1e-6 and 1e-6 at the ends of the
/// range: the logarithm is carried in two parts, and the rounding error of its product with y is kept. One rounded
/// logarithm would give 5e-6 there.
/// |y| up to 1e30. Results below 1.2e-38 are zero, those above e^88 are e^88.
/// x⁰ = 1 for every x; 0^y = 0 for y > 0 (and 1 for y < 0, for which it is undefined in mathematics). x < 0 counts as
/// 0.
#[inline(always)]
pub fn pow<L: Lane>(x: L, y: L) -> L {
    let zero = x.lit(0.0);
    let (ln_high, ln_low) = ln_parts(x);
    let high = y * ln_high;
    let low = product_error(y, ln_high, high) + y * ln_low;
    let at_zero = L::select(zero.lt(y), zero, x.lit(1.0));
    L::select(zero.lt(x), exp_sum(high, low), at_zero)
}

/// The angle of the point (`x`, `y`) from the x axis, [−π, π]; 0 at the origin.
///
/// `f32`: the bits of `libm::atan2f`, for finite coordinates that are 0 or at least 1e-30 in magnitude, and within a
/// factor of 2²⁶ of each other if neither is 0.
///
/// Source: Sun Microsystems 1993, fdlibm, `s_atan.c` and `e_atan2.c`, in single precision by Ian Lance Taylor.
#[inline(always)]
pub(crate) fn angle<L: Lane>(y: L, x: L) -> L {
    let zero = x.lit(0.0);
    let acute = arc_tangent(y.abs() / x.abs().max(x.lit(f64::from(f32::MIN_POSITIVE))));
    let (high, low) = (x.lit(PI[0]), x.lit(PI[1]));
    let angle = L::select(x.lt(zero), high - (acute - low), acute);
    L::select(y.lt(zero), -angle, angle)
}

/// π in two parts.
const PI: [f64; 2] = [std::f32::consts::PI as f64, -8.742_278e-8_f32 as f64];

/// The odd powers of the arc tangent's series, from the third upwards.
const ARC_TANGENT: [f32; 5] =
    [3.333_332_8e-1, -1.999_915_8e-1, 1.425_363_6e-1, -1.064_801_74e-1, 6.168_760_6e-2];

/// Arcs: for arguments from the first number upwards, the second and third are added to the arc tangent of a small
/// one.
const ARCS: [[f32; 3]; 4] = [
    [0.4375, f32::from_bits(0x3eed_6338), 5.012_158_2e-9],
    [0.6875, f32::from_bits(0x3f49_0fda), 3.774_894_7e-8],
    [1.1875, f32::from_bits(0x3f7b_985e), 3.447_321_7e-8],
    [2.4375, f32::from_bits(0x3fc9_0fda), 7.549_789_4e-8],
];

/// The arc tangent of `t` ≥ 0.
#[inline(always)]
fn arc_tangent<L: Lane>(t: L) -> L {
    let (one, two, half) = (t.lit(1.0), t.lit(2.0), t.lit(1.5));
    let quotients = [(two * t - one, two + t), (t - one, t + one), (t - half, one + half * t), (-one, t)];
    let (mut above, mut below, mut high, mut low) = (t, one, t.lit(0.0), t.lit(0.0));
    for ([from, arc, rest], (a, b)) in ARCS.into_iter().zip(quotients) {
        let less = t.lt(number(t, from));
        (above, below) = (L::select(less, above, a), L::select(less, below, b));
        (high, low) = (L::select(less, high, number(t, arc)), L::select(less, low, number(t, rest)));
    }
    let u = above / below;
    let z = u * u;
    let w = z * z;
    let [a, b, c, d, e] = ARC_TANGENT;
    let even = z * (number(t, a) + w * (number(t, c) + w * number(t, e)));
    let odd = w * (number(t, b) + w * number(t, d));
    high - ((u * (even + odd) - low) - u)
}

#[inline(always)]
fn number<L: Lane>(like: L, value: f32) -> L {
    like.lit(f64::from(value))
}

/// e^(high + low), for a `low` that is small compared with `high`.
#[inline(always)]
fn exp_sum<L: Lane>(high: L, low: L) -> L {
    let kept = high.clamp(EXP_MIN, EXP_MAX);
    let n = (kept * kept.lit(std::f64::consts::LOG2_E) + kept.lit(0.5)).floor();
    // If `high` was clamped, `low` is meaningless and may even be infinite.
    let inside = high.lit(EXP_MIN).le(high).and(high.le(high.lit(EXP_MAX)));
    let low = L::select(inside, low, high.lit(0.0));
    let r = (kept - n * kept.lit(LN_2_HIGH)) - n * kept.lit(LN_2_LOW) + low;
    L::select(high.lt(high.lit(EXP_MIN)), high.lit(0.0), exp_reduced(r).ldexp(n))
}

/// e^r for |r| ≤ ln 2 / 2.
#[inline(always)]
fn exp_reduced<L: Lane>(r: L) -> L {
    let q = horner!(EXP, r; 4, 3, 2, 1, 0);
    r.lit(1.0) + (r + r * r * q)
}

/// ln x in two parts, with a relative error of 1e-8 in `f32`.
#[inline(always)]
fn ln_parts<L: Lane>(x: L) -> (L, L) {
    let (u, exponent) = reduce(x);
    let (high, low) = ln_1p_parts(u);
    let (high, error) = sum_and_error(exponent * x.lit(LN_2_HIGH), high);
    sum_and_error(high, error + (exponent * x.lit(LN_2_LOW) + low))
}

/// u and e with x = (1 + u) · 2^e and 1 + u in [√½, √2); u is exact.
#[inline(always)]
fn reduce<L: Lane>(x: L) -> (L, L) {
    let (mantissa, exponent) = x.max(x.lit(SMALLEST)).frexp();
    let one = x.lit(1.0);
    let below = mantissa.lt(x.lit(std::f64::consts::FRAC_1_SQRT_2));
    let mantissa = L::select(below, mantissa + mantissa, mantissa);
    (mantissa - one, L::select(below, exponent - one, exponent))
}

/// ln(1 + u) in two parts: u − u²/2 to twice the precision, the rest in the second.
#[inline(always)]
fn ln_1p_parts<L: Lane>(u: L) -> (L, L) {
    let half = u.lit(0.5);
    let squared = u * u;
    let (high, error) = sum_and_error(u, -(half * squared));
    let tail = u * squared * horner!(LN, u; 8, 7, 6, 5, 4, 3, 2, 1, 0);
    (high, tail + (error - half * product_error(u, u, squared)))
}

/// a + b rounded, and the rounding error, for |a| ≥ |b| or a = 0 (Dekker 1971, Fast2Sum).
#[inline(always)]
fn sum_and_error<L: Lane>(a: L, b: L) -> (L, L) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a·b − `product`, where `product` is a·b rounded: exact in `f32` (Dekker 1971, Mul12).
#[inline(always)]
fn product_error<L: Lane>(a: L, b: L, product: L) -> L {
    let (a_high, a_low) = halves(a);
    let (b_high, b_low) = halves(b);
    a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)
}

/// `a` as the sum of two 12-bit numbers (in `f32`; Veltkamp's splitting).
#[inline(always)]
fn halves<L: Lane>(a: L) -> (L, L) {
    let shifted = a * a.lit(4097.0);
    let high = shifted - (shifted - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;

    /// The distance of `value` from the exact `truth` in units of the last place of `truth`.
    fn ulps(value: f32, truth: f64) -> f64 {
        let nearest = truth as f32;
        let ulp = f64::from(f32::from_bits(nearest.abs().to_bits() + 1)) - f64::from(nearest.abs());
        (f64::from(value) - truth).abs() / ulp
    }

    /// The largest distance over every `stride`th `f32` between two numbers of the same sign.
    fn worst([low, high]: [f32; 2], stride: usize, value: fn(f32) -> f32, truth: fn(f64) -> f64) -> f64 {
        let (a, b) = (low.to_bits().min(high.to_bits()), low.to_bits().max(high.to_bits()));
        let of = |bits| ulps(value(f32::from_bits(bits)), truth(f64::from(f32::from_bits(bits))));
        (a..=b).step_by(stride).map(of).fold(0.0, f64::max)
    }

    /// Checks the bounds stated by the functions, over every `stride`th `f32`.
    fn bounds_hold(stride: usize) {
        let smallest = f32::MIN_POSITIVE;
        let found = [
            ("exp", 1.0, worst([smallest, 88.0], stride, exp, scalar::exp)),
            ("exp of negative", 1.0, worst([-87.33, -smallest], stride, exp, scalar::exp)),
            ("exp2", 1.0, worst([smallest, 127.0], stride, exp2, scalar::exp2)),
            ("exp2 of negative", 1.0, worst([-126.0, -smallest], stride, exp2, scalar::exp2)),
            ("ln below 1", 1.0, worst([smallest, 0.999_999_94], stride, ln, scalar::ln)),
            ("ln above 1", 1.0, worst([1.000_000_1, f32::MAX], stride, ln, scalar::ln)),
            ("log2 below 1", 2.0, worst([smallest, 0.999_999_94], stride, log2, scalar::log2)),
            ("log2 above 1", 2.0, worst([1.000_000_1, f32::MAX], stride, log2, scalar::log2)),
        ];
        for (name, bound, error) in found {
            assert!(error <= bound, "{name}: {error} ulp, {bound} promised");
        }
    }

    #[test]
    fn angles_are_those_of_libm_to_the_bit() {
        let numbers = (0..300).scan(1e-7f32, |x, _| Some(std::mem::replace(x, *x * -1.117)));
        let few = [0.0, 1.0, -1.0, 0.4375, 0.6875, -1.1875, 2.4375, 1e-30];
        let numbers: Vec<f32> = numbers.chain(few).collect();
        for (x, y) in numbers.iter().flat_map(|x| numbers.iter().map(move |y| (*x, *y))) {
            let apart = if x == 0.0 || y == 0.0 { 1.0 } else { (y / x).abs() };
            if (1.0 / (1 << 26) as f32..(1 << 26) as f32).contains(&apart) {
                assert_eq!(angle(y, x).to_bits(), libm::atan2f(y, x).to_bits(), "{y} {x}");
            }
        }
    }

    #[test]
    fn errors_stay_within_the_bounds_on_a_dense_grid() {
        bounds_hold(1021);
    }

    /// Takes about eight minutes on one core: `cargo test --release -p taotie --lib poly -- --ignored`.
    #[test]
    #[ignore = "tests every f32, which takes minutes"]
    fn errors_stay_within_the_bounds_everywhere() {
        bounds_hold(1);
    }

    /// The bases of [`the_power_keeps_its_bound`]: all magnitudes, and densely the cosines of a highlight.
    fn bases(count: u32) -> impl Iterator<Item = f32> {
        let (least, most) = (f32::MIN_POSITIVE.to_bits(), f32::MAX.to_bits());
        let any_size = (0..count).map(move |i| f32::from_bits(least + i * ((most - least) / count)));
        let cosines = (1..count).map(move |i| 1.0 - i as f32 / count as f32);
        let near_one = (1..count).map(|i| 1.0 - i as f32 * f32::EPSILON);
        any_size.chain(cosines).chain(near_one)
    }

    #[test]
    fn the_power_keeps_its_bound() {
        let (mut worst, mut largest) = (0.0f64, 0.0f64);
        for x in bases(4000) {
            for j in 0..400 {
                let y = [0.01, 1.0, 77.0, -1.0][j % 4] * (1.0 + j as f32 / 30.0);
                let log = f64::from(y) * scalar::ln(f64::from(x));
                if (-87.32..=87.99).contains(&log) {
                    let error = (f64::from(pow(x, y)) / scalar::pow(f64::from(x), f64::from(y)) - 1.0).abs();
                    (worst, largest) = (worst.max(error - 1e-8 * log.abs()), largest.max(error));
                }
            }
        }
        assert!(worst <= 1.2e-7 && largest <= 1e-6, "{worst} {largest}");
    }

    #[test]
    fn double_precision_is_good_to_a_few_1e_9() {
        for i in 0..20_000 {
            let x = -80.0 + f64::from(i) * 0.008;
            assert!((exp(x) / scalar::exp(x) - 1.0).abs() < 4e-9);
            let positive = scalar::exp(x);
            assert!((ln(positive) - x).abs() <= 1e-9 * x.abs() + 1e-15, "{x}");
        }
    }

    #[test]
    fn the_ends_of_the_range_are_plain_numbers() {
        assert_eq!([exp(-87.4f32), exp(-1e30), exp(f32::NEG_INFINITY)], [0.0; 3]);
        assert_eq!([exp(88.0f32), exp(1e30), exp(f32::INFINITY)], [exp(88.0); 3]);
        assert!(exp(-87.33f32) >= f32::MIN_POSITIVE && exp(88.0f32) < 1.66e38);
        assert_eq!(
            [exp2(-127.0f32), exp2(-126.0), exp2(500.0)],
            [0.0, f32::MIN_POSITIVE, f32::from_bits(254 << 23)]
        );
        assert_eq!([ln(1.0f32), log2(1.0), log2(8.0), log2(0.125), exp2(3.0)], [0.0, 0.0, 3.0, -3.0, 8.0]);
        assert_eq!([ln(0.0f32), ln(-1.0), ln(f32::NAN)], [ln(f32::MIN_POSITIVE); 3]);
    }

    #[test]
    fn powers_of_zero_and_one() {
        assert_eq!([pow(0.0f32, 0.01), pow(0.0, 1e9), pow(-0.3, 5.0)], [0.0; 3]);
        assert_eq!([pow(0.0f32, 0.0), pow(0.7, 0.0), pow(1.0, 1e30), pow(-1.0, 0.0)], [1.0; 4]);
        assert_eq!([pow(0.5f32, 1e30), pow(1e-38, 50.0)], [0.0; 2]);
        assert_eq!([pow(2.0f32, 1e30), pow(1e38, 50.0)], [exp(88.0); 2]);
    }
}
