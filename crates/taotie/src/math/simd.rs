//! The choice of the SIMD level, which affects speed but never pixels.

use crate::error::{Error, Result};
use crate::names::Named;
use fearless_simd::Level;

/// A SIMD level by name. All levels give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum SimdLevel {
    /// The fastest level on this machine.
    #[default]
    Auto,
    /// One number at a time; code without such a form runs at the CPU's baseline.
    Scalar,
    /// 128-bit registers, the baseline of x86-64.
    Sse2,
    /// 256-bit registers of x86-64-v3.
    Avx2,
    /// 512-bit registers of x86-64-v4 as in Ice Lake and later.
    Avx512,
    /// 128-bit registers of 64-bit Arm.
    Neon,
}

impl Named for SimdLevel {
    const WHAT: &'static str = "SIMD level";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("auto", Self::Auto),
        ("scalar", Self::Scalar),
        ("sse2", Self::Sse2),
        ("avx2", Self::Avx2),
        ("avx512", Self::Avx512),
        ("neon", Self::Neon),
    ];
}

impl SimdLevel {
    /// The levels supported by this machine, without `Auto`.
    pub fn available() -> Vec<SimdLevel> {
        let named = Self::NAMES.iter().map(|(_, level)| *level);
        named.filter(|level| *level != Self::Auto && level.dispatch().is_ok()).collect()
    }

    /// Checks that this machine supports the level.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if the CPU lacks the level.
    pub fn check(self) -> Result<()> {
        self.dispatch().map(|_| ())
    }

    /// The proof that this machine supports its fastest level.
    pub(crate) fn fastest() -> Level {
        Self::Auto.dispatch().unwrap_or(Level::fallback())
    }

    /// The proof that this machine supports this level.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if the CPU lacks the level.
    #[doc(hidden)]
    pub fn dispatch(self) -> Result<Level> {
        let machine = Level::new();
        let level = match self {
            Self::Auto => avx512(machine)
                .or_else(|| avx2(machine))
                .or_else(|| sse2(machine))
                .or_else(|| neon(machine))
                .or(Some(machine)),
            Self::Scalar => Some(Level::fallback()),
            Self::Sse2 => sse2(machine),
            Self::Avx2 => avx2(machine),
            Self::Avx512 => avx512(machine),
            Self::Neon => neon(machine),
        };
        level.ok_or_else(|| {
            Error::unsupported(
                format!("SIMD level `{}`", self.name()),
                "this CPU does not support it; use `auto`",
            )
        })
    }
}

#[cfg(target_arch = "x86_64")]
fn sse2(machine: Level) -> Option<Level> {
    machine.as_sse2().map(Level::Sse2)
}

#[cfg(target_arch = "x86_64")]
fn avx2(machine: Level) -> Option<Level> {
    machine.as_avx2().map(Level::Avx2)
}

#[cfg(target_arch = "x86_64")]
fn avx512(machine: Level) -> Option<Level> {
    machine.as_avx512().map(Level::Avx512)
}

#[cfg(target_arch = "aarch64")]
fn neon(machine: Level) -> Option<Level> {
    machine.as_neon().map(Level::Neon)
}

#[cfg(not(target_arch = "x86_64"))]
fn sse2(_: Level) -> Option<Level> {
    None
}

#[cfg(not(target_arch = "x86_64"))]
fn avx2(_: Level) -> Option<Level> {
    None
}

#[cfg(not(target_arch = "x86_64"))]
fn avx512(_: Level) -> Option<Level> {
    None
}

#[cfg(not(target_arch = "aarch64"))]
fn neon(_: Level) -> Option<Level> {
    None
}
