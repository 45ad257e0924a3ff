//! The tone curves, by name and by formula.
//!
//! The formulas map linear colours with channels in [0, 1e9] and sRGB primaries; results may leave [0, 1] by rounding
//! or out-of-gamut colours, and [`ToneCurve::apply`] clamps them.

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
