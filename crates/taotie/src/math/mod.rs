//! Numbers, vectors, matrices and frames, each formula written once over the number type [`Lane`].

mod column;
mod dual;
mod lane;
mod mat;
mod number;
mod numbers;
mod pack;
#[cfg(feature = "serde")]
mod serial;
mod simd;
mod vec;

pub(crate) mod codes;
pub mod poly;
pub mod quadrature;
pub mod scalar;
pub mod sequence;
pub mod srgb;

pub(crate) use column::BATCH;
pub use column::{Aligned, Column, Quads, Words};
pub use dual::Dual;
pub use lane::{Lane, Mask};
pub use mat::Mat4;
pub use number::Number;
pub use pack::Pack;
pub(crate) use pack::{
    MOST_LANES, at_least_baseline, at_most_eight, dispatch_eight, dispatch_pack, dispatch_registers,
};
pub use simd::SimdLevel;
pub use vec::{Vec2, Vec3};
