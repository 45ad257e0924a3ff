//! Numbers, vectors, matrices and frames, each formula written once over the number type [`Lane`].

mod lane;
mod mat;
mod pack;
mod simd;
mod vec;

pub(crate) mod codes;
pub mod poly;
pub mod quadrature;
pub mod scalar;
pub mod sequence;
pub mod srgb;

pub use lane::{Lane, Mask};
pub use mat::Mat4;
pub use pack::Pack;
pub(crate) use pack::dispatch_pack;
pub use simd::SimdLevel;
pub use vec::{Vec2, Vec3};
