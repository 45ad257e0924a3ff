//! Bakes high-poly scans to low-poly glTF with normal maps, renders them with physically based shading, and measures
//! the error.
//!
//! The crate is layered; a module imports only from lower layers and never from a sibling:
//!
//! ```text
//! L6   asset          comparison
//! L5   normal_map     studio         inspection     proof
//! L4   render          bake           io
//! L3   pixel
//! L2   surface  shade  scene  raster  trace  film  compare
//! L1   image           mesh
//! L0   math         error  names  progress  parallel  groups  length
//! ```
//!
//! `raster` and `trace` find *hits*, never colours; `shade` maps numbers to numbers and never sees a scene; they meet
//! in [`render`]. Only [`io`] reads paths. Nothing prints, and results do not depend on the machine: the same scene
//! gives the same bits at every SIMD level and with any number of threads.
//!
//! ```no_run
//! use taotie_engine::render::{RenderSettings, Shot, render};
//! use taotie::studio::{CameraOptions, Framing, LightOptions, Viewpoint};
//!
//! # fn main() -> taotie_engine::Result<()> {
//! let scene = taotie_io::load_model("model.glb".as_ref())?.scene;
//! let framing = Framing { size: [1024, 1024], all_around: false };
//! let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, &scene)?;
//! let lighting = LightOptions::default().lighting(None, &scene, viewpoint.at(0.0));
//! let (camera, settings) = (viewpoint.at(0.0).camera(), RenderSettings::default());
//! let frame = render(&scene, &Shot { camera: &camera, lighting: &lighting, settings: &settings })?;
//! println!("{:?}", frame.color.pixel(512, 512));
//! # Ok(())
//! # }
//! ```

pub mod asset;
pub mod comparison;
pub mod inspection;
pub mod studio;

pub use taotie_engine::{Error, Progress, Result, Warnings};
