//! Bakes high-poly scans to low-poly glTF with normal maps, renders them with physically based shading, and proves in
//! degrees how close they are.
//!
//! A picture:
//!
//! ```no_run
//! use taotie::Picture;
//!
//! let scene = taotie::load_model("model.glb")?.scene;
//! Picture::default().write(&scene, "model.png")?;
//! # Ok::<(), taotie::Error>(())
//! ```
//!
//! An asset and its proof: see [`asset`].
//!
//! Nothing prints, and results do not depend on the machine: the same scene gives the same bits at every SIMD level and
//! with any number of threads.
//!
//! The crates below, `taotie-io` (files) and `taotie-engine` (surfaces, shading, rendering, baking, comparing), have all
//! the parts. Their interfaces change with their needs; this one is kept stable.

pub mod asset;
pub mod comparison;
pub mod inspection;
mod picture;
pub mod studio;

pub use picture::Picture;
pub use taotie_engine::bake::MapKind;
pub use taotie_engine::film::Development;
pub use taotie_engine::image::{Bitmap, Image};
pub use taotie_engine::length::Unit;
pub use taotie_engine::math::Vec3;
pub use taotie_engine::mesh::Mesh;
pub use taotie_engine::render::{EnvironmentLight, Frame, RenderSettings};
pub use taotie_engine::scene::{Material, Scene};
pub use taotie_engine::shade::Shading;
pub use taotie_engine::surface::SurfaceMethod;
pub use taotie_engine::{Error, Progress, Result, Warning, Warnings};
pub use taotie_io::{Bytes, ImageCodec, Limits, Loaded, load_model};
