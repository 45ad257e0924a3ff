//! The tone curves by name.

use super::curves::{aces, agx, linear, neutral, reinhard};
use crate::error::{Error, Result};
use crate::math::{Lane, Vec3};

/// How unbounded light is fitted into what a screen shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ToneCurve {
    /// Khronos PBR Neutral: authored colours come out as authored, only highlights are compressed.
    #[default]
    Neutral,
    /// No curve: what is above one is cut.
    Linear,
    /// x / (1 + x) of each channel.
    Reinhard,
    /// Hill's fit of the ACES reference rendering and sRGB output transforms.
    Aces,
    /// Sobotka's AgX, default look.
    Agx,
}

impl ToneCurve {
    /// Every curve with its name on the command line.
    pub const NAMES: [(&'static str, ToneCurve); 5] = [
        ("neutral", Self::Neutral),
        ("linear", Self::Linear),
        ("reinhard", Self::Reinhard),
        ("aces", Self::Aces),
        ("agx", Self::Agx),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, curve)| *curve == self).map_or("", |(name, _)| name)
    }

    /// The curve of this name.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists the names.
    pub fn from_name(name: &str) -> Result<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, curve)| *curve).ok_or_else(|| {
            let known = Self::NAMES.map(|(known, _)| known).join(", ");
            Error::invalid(format!("tone curve `{name}`"), format!("there is {known}"))
        })
    }

    /// The display-referred linear colour in [0, 1] of a scene-referred one (linear sRGB primaries).
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

/// Each channel kept within [0, `high`]; NaN becomes zero.
#[inline(always)]
pub(super) fn clamped<L: Lane>(v: Vec3<L>, high: f64) -> Vec3<L> {
    Vec3::new(v.x.clamp(0.0, high), v.y.clamp(0.0, high), v.z.clamp(0.0, high))
}
