//! The choice of the SIMD level, which affects speed but never pixels, and of the code compiled for it.

use crate::error::{Error, Result};
use crate::names::Named;
use fearless_simd::Level;

/// A SIMD level by name. All levels give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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
    /// 128-bit registers of WebAssembly.
    Simd128,
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
        ("simd128", Self::Simd128),
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
                .or_else(|| simd128(machine))
                .or(Some(machine)),
            Self::Scalar => Some(Level::fallback()),
            Self::Sse2 => sse2(machine),
            Self::Avx2 => avx2(machine),
            Self::Avx512 => avx512(machine),
            Self::Neon => neon(machine),
            Self::Simd128 => simd128(machine),
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

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
fn simd128(machine: Level) -> Option<Level> {
    machine.as_wasm_simd128().map(Level::WasmSimd128)
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

#[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
fn simd128(_: Level) -> Option<Level> {
    None
}

/// Evaluates `call` once, with `$pack` naming the pack type of `level` and `$token` its proof, compiled for that
/// level. Everything that `call` runs must be `#[inline(always)]`, or it loses the level.
///
/// `fearless_simd::dispatch!` would compile five levels, one of them eight scalars wide; this compiles only those
/// that differ: one `f32` at a time, packs of eight on SSE2, AVX2, NEON or SIMD128, and packs of sixteen on AVX-512.
macro_rules! dispatch_pack {
    ($level:expr, $pack:ident, $token:ident => $call:expr) => {
        match $level {
            #[cfg(target_arch = "x86_64")]
            fearless_simd::Level::Avx512($token) => {
                use fearless_simd::Simd as _;
                type $pack = fearless_simd::f32x16<fearless_simd::x86::Avx512>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            level => $crate::math::dispatch_eight!(level, $pack, $token => $call),
        }
    };
}
pub(crate) use dispatch_pack;

/// Like [`dispatch_pack`], with packs of at most eight, for data in groups of eight.
macro_rules! dispatch_eight {
    ($level:expr, $pack:ident, $token:ident => $call:expr) => {{
        #[allow(unused_imports, reason = "the scalar level needs none")]
        use fearless_simd::{Level, Simd as _};
        match $crate::math::at_most_eight($level) {
            #[cfg(target_arch = "x86_64")]
            Level::Avx2($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::x86::Avx2>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            #[cfg(target_arch = "x86_64")]
            Level::Sse2($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::x86::Sse2>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            #[cfg(target_arch = "aarch64")]
            Level::Neon($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::aarch64::Neon>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Level::WasmSimd128($token) => {
                type $pack = fearless_simd::f32x8<fearless_simd::wasm32::WasmSimd128>;
                $token.vectorize(
                    #[inline(always)]
                    || $call,
                )
            }
            _ => {
                type $pack = f32;
                let $token = ();
                $call
            }
        }
    }};
}
pub(crate) use dispatch_eight;

/// Evaluates `call` once, with `$simd` the proof of a level that has registers: at the scalar level, the CPU's
/// baseline. Everything that `call` runs must be `#[inline(always)]`, or it loses the level.
///
/// Compiling emulated registers takes four times as long as all the levels with real ones, so it is only done for
/// targets without registers. `fearless_simd::dispatch!` would compile it everywhere, and SSE4.2, which is never
/// selected.
#[cfg(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
))]
macro_rules! dispatch_registers {
    ($level:expr, $simd:ident => $call:expr) => {{
        use fearless_simd::{Level, Simd as _};
        match $crate::math::at_least_baseline($level) {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512($simd) => $simd.vectorize(
                #[inline(always)]
                || $call,
            ),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $call,
            ),
            #[cfg(target_arch = "x86_64")]
            Level::Sse2($simd) => $simd.vectorize(
                #[inline(always)]
                || $call,
            ),
            #[cfg(target_arch = "aarch64")]
            Level::Neon($simd) => $simd.vectorize(
                #[inline(always)]
                || $call,
            ),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Level::WasmSimd128($simd) => $simd.vectorize(
                #[inline(always)]
                || $call,
            ),
            _ => unreachable!("a level without a `SimdLevel`"),
        }
    }};
}
#[cfg(not(any(
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
macro_rules! dispatch_registers {
    ($level:expr, $simd:ident => $call:expr) => {
        fearless_simd::dispatch!($crate::math::at_least_baseline($level), $simd => $call)
    };
}
pub(crate) use dispatch_registers;

/// Returns the level; at the scalar level, the CPU's baseline.
pub(crate) fn at_least_baseline(level: Level) -> Level {
    if level.is_fallback() { Level::baseline() } else { level }
}

/// The level, or the next lower one with packs of eight.
pub(crate) fn at_most_eight(level: Level) -> Level {
    #[cfg(target_arch = "x86_64")]
    if let (Level::Avx512(_), Some(avx2)) = (level, level.as_avx2()) {
        return Level::Avx2(avx2);
    }
    level
}
