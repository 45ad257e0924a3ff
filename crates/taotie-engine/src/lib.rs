//! Surfaces, shading, rasterising, ray tracing, baking and comparing: numbers in, numbers out.
//!
//! The crate is layered; a module imports only from lower layers and never from a sibling:
//!
//! ```text
//! L5   normal_map   proof
//! L4   render       bake
//! L3   pixel
//! L2   surface  shade  scene  raster  trace  film  compare
//! L1   image         mesh
//! L0   math     error  names  progress  parallel  groups  length
//! ```
//!
//! `raster` and `trace` find *hits*, never colours; `shade` maps numbers to numbers and never sees a scene; they meet
//! in [`render`]. Nothing here opens a file or prints, and results do not depend on the machine: the same scene gives
//! the same bits at every SIMD level and with any number of threads.
//!
//! `taotie-io` reads and writes scenes; most users want `taotie`, the whole tool behind a small stable interface. This
//! crate's interface changes with its needs.

pub mod bake;
pub mod compare;
pub mod error;
pub mod film;
pub mod groups;
pub mod image;
pub mod length;
pub mod math;
pub mod mesh;
pub mod names;
pub mod normal_map;
pub mod parallel;
pub mod pixel;
pub mod progress;
pub mod proof;
pub mod raster;
pub mod render;
pub mod scene;
pub mod shade;
pub mod surface;
pub mod trace;

pub use error::{Error, Result, Warning, Warnings};
pub use progress::Progress;
