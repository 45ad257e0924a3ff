//! Numbers, vectors, matrices and frames, each formula written once over the number type [`Lane`].

mod curve;
mod lane;
mod mat;
mod number;
mod pack;
mod simd;
mod vec;

pub mod integration;
pub mod poly;
pub mod srgb;

pub use curve::Curve;
pub use lane::{Lane, Mask};
pub use mat::Mat4;
pub use number::{Dual, Number};
pub use pack::{Aligned, Column, Pack, Quads, Words};
pub(crate) use pack::{BATCH, MOST_LANES};
pub use simd::SimdLevel;
pub(crate) use simd::{at_least_baseline, at_most_eight, dispatch_eight, dispatch_pack, dispatch_registers};
pub use vec::{Vec2, Vec3};

/// Trigonometry and logarithms for set-up code, bit-identical on every platform.
///
/// The standard library calls the platform's mathematics library, whose last bits differ between systems; these
/// functions are pure Rust. Formulas that run per pixel use [`poly`] instead.
pub mod scalar {
    pub use libm::{acos, asin, atan2, cbrt, cos, exp, exp2, log as ln, log2, log10, pow, sin, tan};
}
