//! Taotie puts a scan's relief on a light mesh, shades it by physics, and proves that it still looks the same.
//!
//! The crate is layered; a module imports only from lower layers and never from a sibling:
//!
//! ```text
//! L3   render          bake           io
//! L2   surface  shade  scene  raster  trace  film  compare
//! L1   image           mesh
//! L0   math         error  names  progress
//! ```
//!
//! `raster` and `trace` find *hits*, never colours; `shade` turns numbers into numbers and never sees a scene;
//! they meet in [`render`]. Only [`io`] reads paths. Nothing prints, and nothing depends on the machine: the same
//! scene gives the same bits at every SIMD level and with any number of threads.
//!
//! ```no_run
//! use taotie::render::{Lighting, RenderSettings, Shot, render};
//! use taotie::scene::{Orbit, fitting_distance, three_point_rig};
//!
//! # fn main() -> taotie::Result<()> {
//! let scene = taotie::io::load_model("model.glb".as_ref())?.scene;
//! let target = scene.bounds().expect("a scene that was read has triangles").center();
//! let mut orbit = Orbit { azimuth: 0.4, elevation: 0.2, distance: 0.0, target, fov_y: 0.5 };
//! orbit.distance = fitting_distance(&orbit, 1.0, 0.9, scene.corners());
//! let camera = orbit.camera(orbit.distance / 2.0);
//! let lighting = Lighting { lights: three_point_rig(&camera), ..Lighting::default() };
//! let settings = RenderSettings::default();
//! let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
//! let frame = render(&scene, &shot)?;
//! println!("{:?}", frame.color.pixel(512, 512));
//! # Ok(())
//! # }
//! ```

pub mod bake;
pub mod compare;
pub mod error;
pub mod film;
pub mod image;
pub mod io;
pub mod math;
pub mod mesh;
pub mod names;
pub mod progress;
pub mod raster;
pub mod render;
pub mod scene;
pub mod shade;
pub mod surface;
pub mod trace;

pub use error::{Error, Result, Warnings};
pub use progress::Progress;
