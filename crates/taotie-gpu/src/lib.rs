//! Renders scenes, and casts the rays of bakes, on GPUs.
//!
//! [`GpuRenderer`] draws the same images as [`taotie_engine::render::Renderer`], with shaders that [`taotie_shader`]
//! generates from the same formulas: textures with the same mip chains, the same lights, environments and models, the
//! same sample positions. Light is developed by [`taotie_engine::film`] on the CPU, so tone curves and backgrounds are
//! the same. The images are not bit-identical, since GPUs may fuse and reorder arithmetic.
//!
//! Shadows are rays that the shaders themselves trace through the CPU's tree of boxes, the same way on every machine;
//! the CPU composites the ground below the image. Output variables are rejected. Blended surfaces are drawn from the
//! farthest triangle to the nearest, by the triangles' centres; intersecting triangles are therefore blended in one
//! order, while [`taotie_engine::render::Renderer`] sorts each pixel.
//!
//! [`Gpu`] is a [`taotie_engine::bake::RayDevice`]: [`taotie_engine::bake::Scan::cast_by`] makes bakes of a scan cast their
//! projection rays and the rays of occlusion and bent normals on it.
//!
//! ```no_run
//! use taotie_engine::render::{Lighting, Prepared, RenderSettings, Shot};
//! use taotie_gpu::{AdapterChoice, Gpu, GpuRenderer};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = taotie_io::load_model("statue.glb")?.scene;
//! # let camera = scene.cameras()[0].clone();
//! let (lighting, settings) = (Lighting::default(), RenderSettings::default());
//! let prepared = Prepared::new(scene, &settings.surface)?;
//! let gpu = Gpu::find(&AdapterChoice::default())?;
//! let mut renderer = GpuRenderer::new(&gpu, &prepared)?;
//! let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
//! let frame = renderer.render(&shot, taotie_engine::Progress::SILENT)?;
//! # Ok(())
//! # }
//! ```

mod bakes;
mod blending;
mod frame_inputs;
mod gpu;
mod pipelines;
mod rays;
mod renderer;
mod shadows;
mod surfaces;
mod target;
mod textures;

pub use gpu::{AdapterChoice, AdapterDescription, AdapterKind, Gpu, GpuError, Result};
pub use renderer::GpuRenderer;
