//! Which SIMD level runs: a choice of speed, never of pixels.

use crate::error::{Error, Result};
use fearless_simd::Level;

/// A SIMD level by name. All levels give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SimdLevel {
    /// The level that is fastest on this machine.
    #[default]
    Auto,
    /// One number at a time.
    Scalar,
    /// 128-bit packs, the baseline of x86-64.
    Sse2,
    /// 128-bit packs of x86-64-v2.
    Sse42,
    /// 256-bit packs of x86-64-v3.
    Avx2,
    /// The mask registers of Ice Lake's AVX-512 over 256-bit packs.
    Avx512,
    /// 128-bit packs of 64-bit Arm.
    Neon,
}

impl SimdLevel {
    /// Every level with its name on the command line.
    pub const NAMES: [(&'static str, SimdLevel); 7] = [
        ("auto", Self::Auto),
        ("scalar", Self::Scalar),
        ("sse2", Self::Sse2),
        ("sse4.2", Self::Sse42),
        ("avx2", Self::Avx2),
        ("avx512", Self::Avx512),
        ("neon", Self::Neon),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, level)| *level == self).map_or("auto", |(name, _)| name)
    }

    /// The levels that this machine can run, `Auto` left out.
    pub fn available() -> Vec<SimdLevel> {
        Self::NAMES
            .iter()
            .map(|(_, level)| *level)
            .filter(|level| *level != Self::Auto && level.dispatch().is_ok())
            .collect()
    }

    /// The proof that this machine can run this level.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the processor lacks the level.
    pub fn dispatch(self) -> Result<Level> {
        let best = Level::new();
        let level = match self {
            // AVX-512 gains nothing over AVX2 on packs of eight.
            Self::Auto => Some(avx2(best).unwrap_or(best)),
            Self::Scalar => Some(Level::fallback()),
            Self::Sse2 => sse2(best),
            Self::Sse42 => sse42(best),
            Self::Avx2 => avx2(best),
            Self::Avx512 => avx512(best),
            Self::Neon => neon(best),
        };
        level.ok_or_else(|| {
            Error::unsupported(
                format!("SIMD level `{}`", self.name()),
                "this processor does not have it; leave it at `auto`",
            )
        })
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod levels {
    use fearless_simd::Level;

    pub(super) fn sse2(best: Level) -> Option<Level> {
        best.as_sse2().map(Level::Sse2)
    }
    pub(super) fn sse42(best: Level) -> Option<Level> {
        best.as_sse4_2().map(Level::Sse4_2)
    }
    pub(super) fn avx2(best: Level) -> Option<Level> {
        best.as_avx2().map(Level::Avx2)
    }
    pub(super) fn avx512(best: Level) -> Option<Level> {
        best.as_avx512().map(Level::Avx512)
    }
    pub(super) fn neon(_: Level) -> Option<Level> {
        None
    }
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
mod levels {
    use fearless_simd::Level;

    pub(super) fn sse2(_: Level) -> Option<Level> {
        None
    }
    pub(super) use sse2 as sse42;
    pub(super) use sse2 as avx2;
    pub(super) use sse2 as avx512;

    #[cfg(target_arch = "aarch64")]
    pub(super) fn neon(best: Level) -> Option<Level> {
        best.as_neon().map(Level::Neon)
    }
    #[cfg(not(target_arch = "aarch64"))]
    pub(super) use sse2 as neon;
}

use levels::{avx2, avx512, neon, sse2, sse42};
