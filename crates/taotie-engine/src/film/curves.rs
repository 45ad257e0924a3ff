//! The curves from light to code values: tone curves, by name and by formula, the encoding of sRGB, and rounding to
//! codes; the 8-bit code of a linear value by table lookup instead of a power.
//!
//! The formulas of tone curves map linear colours with channels in [0, 1e9] and sRGB primaries; results may leave [0,
//! 1] by rounding or out-of-gamut colours, and [`ToneCurve::apply`] clamps them.

use crate::math::srgb::Codes;
use crate::math::{Lane, Mask, Vec3, poly};
use crate::names::Named;

/// The curve that compresses unbounded light into the range of a display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneCurve {
    /// Khronos PBR Neutral: authored colours are reproduced as authored, only highlights are compressed.
    #[default]
    Neutral,
    /// No curve: values above one are clipped.
    Linear,
    /// x / (1 + x) of each channel.
    Reinhard,
    /// Hill's fit of the ACES reference rendering and sRGB output transforms.
    Aces,
    /// Sobotka's AgX, default look.
    Agx,
}

impl Named for ToneCurve {
    const WHAT: &'static str = "tone curve";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("neutral", Self::Neutral),
        ("linear", Self::Linear),
        ("reinhard", Self::Reinhard),
        ("aces", Self::Aces),
        ("agx", Self::Agx),
    ];
}

impl ToneCurve {
    /// The display-referred linear colour in [0, 1] for a scene-referred one (linear sRGB primaries).
    ///
    /// Channels below zero or NaN count as zero, those above 1e9 as 1e9.
    #[inline(always)]
    pub fn apply<L: Lane>(self, rgb: Vec3<L>) -> Vec3<L> {
        let rgb = clamped(rgb, 1e9);
        let shown = match self {
            Self::Neutral => neutral(rgb),
            Self::Linear => linear(rgb),
            Self::Reinhard => reinhard(rgb),
            Self::Aces => aces(rgb),
            Self::Agx => agx(rgb),
        };
        clamped(shown, 1.0)
    }
}

/// Each channel clamped to [0, `high`]; NaN becomes zero.
#[inline(always)]
pub(super) fn clamped<L: Lane>(v: Vec3<L>, high: f64) -> Vec3<L> {
    Vec3::new(v.x.clamp(0.0, high), v.y.clamp(0.0, high), v.z.clamp(0.0, high))
}

/// Khronos PBR Neutral.
///
/// Subtracts the 0.04 that a dielectric reflects under uniform white light (less towards black), leaves everything up
/// to a peak of 0.76 unchanged and compresses brighter peaks hyperbolically towards one, with desaturation:
///
/// ```text
/// x = min(r, g, b);  c ← c − (x < 0.08 ? x − 6.25 x² : 0.04);  p = max(c);  p ≤ 0.76: c
/// p' = 1 − 0.24² / (p − 0.52);  g = 1 / (0.15 (p − p') + 1);  c ← mix(p', c p'/p, g)
/// ```
///
/// Laws: colours with one channel at zero and none above 0.76 are unchanged; the order of channels is kept
/// (`laws::film`).
/// Source: Khronos PBR Neutral tone mapper, specification 1.0 (2024).
#[inline(always)]
pub fn neutral<L: Lane>(rgb: Vec3<L>) -> Vec3<L> {
    let x = rgb.x;
    let (start, desaturation, one) = (x.lit(0.8 - 0.04), x.lit(0.15), x.lit(1.0));
    let least = rgb.x.min(rgb.y).min(rgb.z);
    let offset = L::select(least.lt(x.lit(0.08)), least - x.lit(6.25) * least * least, x.lit(0.04));
    let c = rgb - Vec3::splat(offset);
    let peak = c.x.max(c.y).max(c.z);
    let is_moderate = peak.lt(start);
    if !is_moderate.not().any() {
        return c;
    }
    let room = one - start;
    let new_peak = one - room * room / (peak + room - start);
    let keep = one / (desaturation * (peak - new_peak) + one);
    let squeezed = c * (new_peak / peak);
    let bright = squeezed * keep + Vec3::splat(new_peak * (one - keep));
    Vec3::select(is_moderate, c, bright)
}

/// No curve.
#[inline(always)]
pub fn linear<L: Lane>(rgb: Vec3<L>) -> Vec3<L> {
    rgb
}

/// x / (1 + x) of each channel: the simplest of Reinhard's operators, without its luminance and white point, as in
/// three.js and most real-time renderers.
///
/// Source: Reinhard et al. 2002, "Photographic tone reproduction for digital images", eq. 3.
#[inline(always)]
pub fn reinhard<L: Lane>(rgb: Vec3<L>) -> Vec3<L> {
    let one = rgb.x.lit(1.0);
    Vec3::new(rgb.x / (one + rgb.x), rgb.y / (one + rgb.y), rgb.z / (one + rgb.z))
}

/// Hill's fit of the ACES reference rendering transform and the sRGB output transform, for colours divided by 0.6
/// first, as in three.js, which brightens mid grey to the level of the other curves.
///
/// Source: Stephen Hill, BakingLab `ACES.hlsl` (2016), MIT; the factor: three.js `ACESFilmicToneMapping`.
#[inline(always)]
pub fn aces<L: Lane>(rgb: Vec3<L>) -> Vec3<L> {
    /// Linear sRGB to AP1 with the saturation of the reference rendering transform; rows.
    const INPUT: [[f64; 3]; 3] =
        [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
    /// AP1 with the saturation of the output transform to linear sRGB; rows.
    const OUTPUT: [[f64; 3]; 3] =
        [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];
    let v = transformed(&INPUT, rgb * rgb.x.lit(1.0 / 0.6));
    transformed(&OUTPUT, Vec3::new(aces_fit(v.x), aces_fit(v.y), aces_fit(v.z)))
}

#[inline(always)]
fn aces_fit<L: Lane>(v: L) -> L {
    let a = v * (v + v.lit(0.024_578_6)) - v.lit(0.000_090_537);
    let b = v * (v.lit(0.983_729) * v + v.lit(0.432_951_0)) + v.lit(0.238_081);
    a / b
}

/// AgX, base look: a log encoding of 16.5 stops around mid grey, inset towards white in Rec. 2020, then a sigmoid.
///
/// The sigmoid is Wrensch's polynomial of degree six instead of a table (mean squared error 3.7e-6), the matrices are
/// those of Blender's configuration; both as in three.js and Filament. Its large terms cancel, so `f32` is accurate
/// to 1e-5 here and to 3e-7 in the other curves.
///
/// Sources: Troy Sobotka, AgX (2022); Benjamin Wrensch, "Minimal AgX implementation" (2023); Filament, `AgxToneMapper`.
#[inline(always)]
pub fn agx<L: Lane>(rgb: Vec3<L>) -> Vec3<L> {
    const REC2020_FROM_SRGB: [[f64; 3]; 3] =
        [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0113], [0.0164, 0.0880, 0.8956]];
    const SRGB_FROM_REC2020: [[f64; 3]; 3] =
        [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
    const INSET: [[f64; 3]; 3] = [
        [0.856_627_153_315_983, 0.095_121_240_538_158_8, 0.048_251_606_145_858_3],
        [0.137_318_972_929_847, 0.761_241_990_602_591, 0.101_439_036_467_562],
        [0.111_898_212_999_95, 0.076_799_418_603_190_3, 0.811_302_368_396_859],
    ];
    const OUTSET: [[f64; 3]; 3] = [
        [1.127_100_581_814_436_8, -0.110_606_643_096_603_23, -0.016_493_938_717_834_573],
        [-0.141_329_763_498_438_3, 1.157_823_702_216_272, -0.016_493_938_717_834_257],
        [-0.141_329_763_498_438_26, -0.110_606_643_096_602_94, 1.251_936_406_595_040_5],
    ];
    let v = transformed(&INSET, transformed(&REC2020_FROM_SRGB, rgb));
    let v = transformed(&OUTSET, Vec3::new(agx_sigmoid(v.x), agx_sigmoid(v.y), agx_sigmoid(v.z)));
    let gamma = rgb.x.lit(2.2);
    transformed(
        &SRGB_FROM_REC2020,
        Vec3::new(poly::pow(v.x, gamma), poly::pow(v.y, gamma), poly::pow(v.z, gamma)),
    )
}

/// The display value of AgX for a scene value of one channel.
#[inline(always)]
fn agx_sigmoid<L: Lane>(v: L) -> L {
    /// Stops below and above one: mid grey 0.18 minus 10 and plus 6.5.
    const LOW: f64 = -12.47393;
    const HIGH: f64 = 4.026069;
    let stops = poly::log2(v.max(v.lit(1e-10)));
    let x = ((stops - v.lit(LOW)) * v.lit(1.0 / (HIGH - LOW))).clamp(0.0, 1.0);
    let cubic = ((v.lit(15.5) * x - v.lit(40.14)) * x + v.lit(31.96)) * x - v.lit(6.868);
    ((cubic * x + v.lit(0.4298)) * x + v.lit(0.1191)) * x - v.lit(0.00232)
}

/// The product of a matrix, given by rows, and a column vector.
#[inline(always)]
fn transformed<L: Lane>([a, b, c]: &[[f64; 3]; 3], v: Vec3<L>) -> Vec3<L> {
    Vec3::new(row(a, v), row(b, v), row(c, v))
}

#[inline(always)]
fn row<L: Lane>(row: &[f64; 3], v: Vec3<L>) -> L {
    v.x * v.x.lit(row[0]) + v.y * v.y.lit(row[1]) + v.z * v.z.lit(row[2])
}

/// The sRGB-encoded value of a linear one, both in [0, 1]: IEC 61966-2-1.
///
/// `f32`: within 3e-7, so 1e-4 of an 8-bit code and 0.02 of a 16-bit one (`laws::film::encoding_is_close`).
#[inline(always)]
pub fn srgb_from_linear<L: Lane>(linear: L) -> L {
    let power = poly::pow(linear, linear.lit(1.0 / 2.4));
    let curve = power * linear.lit(1.055) - linear.lit(0.055);
    L::select(linear.le(linear.lit(0.003_130_8)), linear * linear.lit(12.92), curve)
}

/// The code nearest to a value in [0, 1], if `top` is the code of one: an integral number in [0, `top`].
#[inline(always)]
pub fn round_to_codes<L: Lane>(value: L, top: f64) -> L {
    (value * value.lit(top) + value.lit(0.5)).floor()
}

/// The code nearest to the sRGB encoding of a linear value in [0, 1], after [`Codes::bounded`]: bit-identical to
/// `round_to_codes(srgb_from_linear(value), 255.0)` (`every_value_has_the_code_of_the_formula`).
pub static SRGB_CODES: Codes = Codes::new(&THRESHOLDS);

/// The bits of the smallest float of each code from 1 to 255; `thresholds_are_those_of_the_formula` finds and prints
/// them.
#[rustfmt::skip]
const THRESHOLDS: [u32; 255] = [
    0x391f_22b3, 0x39ee_b40e, 0x3a46_eb61, 0x3a8b_3e5d, 0x3ab3_070b, 0x3ada_cfb7, 0x3b01_4c32, 0x3b15_3089,
    0x3b29_14df, 0x3b3c_f936, 0x3b50_f2d1, 0x3b65_fb9a, 0x3b7c_3404, 0x3b89_d05f, 0x3b96_2332, 0x3ba3_14be,
    0x3bb0_a731, 0x3bbe_dcb7, 0x3bcd_b76c, 0x3bdd_3966, 0x3bed_64ae, 0x3bfe_3b44, 0x3c07_df90, 0x3c10_f919,
    0x3c1a_6b32, 0x3c24_36c7, 0x3c2e_5cc7, 0x3c38_de19, 0x3c43_bba3, 0x3c4e_f646, 0x3c5a_8ee2, 0x3c66_8653,
    0x3c72_dd73, 0x3c7f_9512, 0x3c86_5703, 0x3c8d_1490, 0x3c94_0396, 0x3c9b_247c, 0x3ca2_77a7, 0x3ca9_fd79,
    0x3cb1_b653, 0x3cb9_a299, 0x3cc1_c2a9, 0x3cca_16e3, 0x3cd2_9fa4, 0x3cdb_5d4d, 0x3ce4_5034, 0x3ced_78b7,
    0x3cf6_d730, 0x3d00_35fc, 0x3d05_1bb6, 0x3d0a_1cee, 0x3d0f_39d1, 0x3d14_728a, 0x3d19_c745, 0x3d1f_382c,
    0x3d24_c56a, 0x3d2a_6f24, 0x3d30_3586, 0x3d36_18b9, 0x3d3c_18e6, 0x3d42_3634, 0x3d48_70cb, 0x3d4e_c8d3,
    0x3d55_3e73, 0x3d5b_d1d3, 0x3d62_8319, 0x3d69_526a, 0x3d70_3fee, 0x3d77_4bce, 0x3d7e_7628, 0x3d82_df92,
    0x3d86_9374, 0x3d8a_56cc, 0x3d8e_29ad, 0x3d92_0c28, 0x3d95_fe50, 0x3d9a_0036, 0x3d9e_11ec, 0x3da2_3385,
    0x3da6_6510, 0x3daa_a6a1, 0x3dae_f848, 0x3db3_5a16, 0x3db7_cc1d, 0x3dbc_4e6b, 0x3dc0_e115, 0x3dc5_842a,
    0x3dca_37ba, 0x3dce_fbd6, 0x3dd3_d090, 0x3dd8_b5f5, 0x3ddd_ac19, 0x3de2_b30a, 0x3de7_cad9, 0x3dec_f395,
    0x3df2_2d4f, 0x3df7_781a, 0x3dfc_d3fe, 0x3e01_2088, 0x3e03_dfaf, 0x3e06_a77c, 0x3e09_77f7, 0x3e0c_5127,
    0x3e0f_3314, 0x3e12_1dc6, 0x3e15_1144, 0x3e18_0d95, 0x3e1b_12c2, 0x3e1e_20d1, 0x3e21_37cb, 0x3e24_57b7,
    0x3e27_809a, 0x3e2a_b27c, 0x3e2d_ed67, 0x3e31_3160, 0x3e34_7e6f, 0x3e37_d49d, 0x3e3b_33ed, 0x3e3e_9c68,
    0x3e42_0e14, 0x3e45_88fa, 0x3e49_0d21, 0x3e4c_9a8f, 0x3e50_314b, 0x3e53_d15c, 0x3e57_7ac9, 0x3e5b_2d99,
    0x3e5e_e9d2, 0x3e62_af7c, 0x3e66_7e9d, 0x3e6a_5740, 0x3e6e_3964, 0x3e72_2512, 0x3e76_1a53, 0x3e7a_192d,
    0x3e7e_21a6, 0x3e81_19e2, 0x3e83_27c8, 0x3e85_3a87, 0x3e87_5222, 0x3e89_6e9d, 0x3e8b_8ffc, 0x3e8d_b641,
    0x3e8f_e170, 0x3e92_118b, 0x3e94_4696, 0x3e96_8094, 0x3e98_bf89, 0x3e9b_0376, 0x3e9d_4c61, 0x3e9f_9a4b,
    0x3ea1_ed38, 0x3ea4_452a, 0x3ea6_a226, 0x3ea9_042c, 0x3eab_6b43, 0x3ead_d76b, 0x3eb0_48a9, 0x3eb2_bf02,
    0x3eb5_3a72, 0x3eb7_bb02, 0x3eba_40b1, 0x3ebc_cb86, 0x3ebf_5b81, 0x3ec1_f0a7, 0x3ec4_8af9, 0x3ec7_2a7d,
    0x3ec9_cf31, 0x3ecc_791e, 0x3ecf_2842, 0x3ed1_dca3, 0x3ed4_9640, 0x3ed7_5521, 0x3eda_1945, 0x3edc_e2b1,
    0x3edf_b166, 0x3ee2_856b, 0x3ee5_5ebc, 0x3ee8_3d62, 0x3eeb_215c, 0x3eee_0ab0, 0x3ef0_f95c, 0x3ef3_ed6a,
    0x3ef6_e6d6, 0x3ef9_e5a7, 0x3efc_e9e1, 0x3eff_f37e, 0x3f01_8146, 0x3f03_0b82, 0x3f04_9878, 0x3f06_2827,
    0x3f07_ba93, 0x3f09_4fb9, 0x3f0a_e7a0, 0x3f0c_8244, 0x3f0e_1faa, 0x3f0f_bfd2, 0x3f11_62be, 0x3f13_086e,
    0x3f14_b0e5, 0x3f16_5c22, 0x3f18_0a29, 0x3f19_baf9, 0x3f1b_6e96, 0x3f1d_24fe, 0x3f1e_de35, 0x3f20_9a3b,
    0x3f22_5913, 0x3f24_1abb, 0x3f25_df37, 0x3f27_a687, 0x3f29_70ae, 0x3f2b_3dab, 0x3f2d_0d83, 0x3f2e_e033,
    0x3f30_b5bd, 0x3f32_8e25, 0x3f34_6968, 0x3f36_478c, 0x3f38_288f, 0x3f3a_0c74, 0x3f3b_f33a, 0x3f3d_dce5,
    0x3f3f_c975, 0x3f41_b8eb, 0x3f43_ab48, 0x3f45_a08f, 0x3f47_98bf, 0x3f49_93db, 0x3f4b_91e2, 0x3f4d_92d8,
    0x3f4f_96bd, 0x3f51_9d92, 0x3f53_a757, 0x3f55_b411, 0x3f57_c3bd, 0x3f59_d65e, 0x3f5b_ebf6, 0x3f5e_0485,
    0x3f60_200d, 0x3f62_3e91, 0x3f64_600b, 0x3f66_8486, 0x3f68_abfa, 0x3f6a_d671, 0x3f6d_03e3, 0x3f6f_345b,
    0x3f71_67d0, 0x3f73_9e4d, 0x3f75_d7ca, 0x3f78_1452, 0x3f7a_53db, 0x3f7c_9671, 0x3f7e_dc0e,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The code by the formula.
    fn formula(bits: u32) -> u32 {
        round_to_codes(srgb_from_linear(f32::from_bits(bits)), 255.0) as u32
    }

    fn looked_up(bits: u32) -> u32 {
        SRGB_CODES.of(Codes::bounded(f32::from_bits(bits))).into()
    }

    fn same_codes(values: impl Iterator<Item = u32>) {
        values.for_each(|bits| assert_eq!(looked_up(bits), formula(bits), "{}", f32::from_bits(bits)));
    }

    #[test]
    fn thresholds_are_those_of_the_formula() {
        let found: Vec<u32> = (1..=255)
            .map(|code| {
                let (mut low, mut high) = (0, 1.0f32.to_bits());
                while high - low > 1 {
                    let middle = (low + high) / 2;
                    *(if formula(middle) >= code { &mut high } else { &mut low }) = middle;
                }
                high
            })
            .collect();
        assert_eq!(found, THRESHOLDS, "{found:#010x?}");
    }

    #[test]
    fn values_near_thresholds_and_on_a_grid_have_the_code_of_the_formula() {
        THRESHOLDS.into_iter().for_each(|bits| same_codes(bits - 1000..bits + 1000));
        same_codes((0..=1.0f32.to_bits()).step_by(4001));
        same_codes([1.0f32, 0.0, 1.0 / 8192.0].into_iter().map(f32::to_bits));
    }

    /// Takes about a minute on one core: `cargo test --release -p taotie-engine --lib film::curves -- --ignored`.
    #[test]
    #[ignore = "tests every f32 in [0, 1], which takes a minute"]
    fn every_value_has_the_code_of_the_formula() {
        same_codes(0..=1.0f32.to_bits());
    }
}
