//! The tone curves by name.

use super::curves::{aces, agx, linear, neutral, reinhard};
use crate::math::{Lane, Vec3};
use crate::names::Named;

/// The curve that compresses unbounded light into the range of a display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
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
