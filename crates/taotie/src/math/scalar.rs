//! Trigonometry and logarithms for set-up code, bit-identical on every platform.
//!
//! The standard library calls the platform's mathematics library, whose last bits differ between systems; these
//! functions are pure Rust. Formulas that run per pixel use [`super::poly`] instead.

pub use libm::{acos, asin, atan2, cbrt, cos, exp, exp2, log as ln, log2, log10, pow, sin, tan};
