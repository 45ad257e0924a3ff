//! The pixel program: all that happens between interpolated values and the radiance that leaves a point, written once
//! over [`Lane`](crate::math::Lane).
//!
//! Each stage takes numbers and returns numbers. Between stages a backend fetches what the next one needs: texels,
//! entries of tables, the environment's light, shadows.
//!
//! ```text
//! Geometry, texels of normals         -> Geometry::smooth, ::bumped, …  -> Frame::new
//! texels, factors                     -> MaterialValues
//! MaterialUniforms, values, tables    -> MaterialPoint::new
//! Frame, MaterialPoint, PointLayers   -> SurfacePoint
//! Frame                               -> highlight, coat_highlight      where the environment is looked up
//! SurfacePoint, LightSource           -> SurfacePoint::own, ::reflect
//! SurfacePoint, EnvironmentTexels     -> SurfacePoint::reflect_environment
//! ```
//!
//! [`PixelInputs`] runs all of them for a single point, of any number that can index an array: in `f64` it is what others
//! are measured against, and dual numbers give its [`Gradient`].
//!
//! `render` runs it on packs, `render::reference` on paths, a recorder makes shaders of it. [`Model`] and the `Option`s
//! of the uniforms say which parts a surface has; they are known before any pixel.

mod environment;
mod frame;
mod geometry;
mod gradient;
mod inputs;
mod layers;
mod light;
mod material;
mod model;
mod surface_point;
mod textured;
mod whole;

pub use environment::{Anisotropic, EnvironmentTexels, Highlight, Turn, coat_highlight, highlight};
pub use frame::{Frame, anisotropy_direction, coat_normal};
pub use geometry::{Geometry, MappedNormal};
pub use gradient::Gradient;
pub use inputs::{
    AnisotropyInputs, CoatInputs, EnvironmentSource, LayerInputs, NormalSource, PixelInputs, SheenInputs,
    Surroundings,
};
pub use layers::{Coat, Sheen, coat_albedo, sheen_albedo};
pub use light::{Cone, Falloff, Incidence, LightSource, Place};
pub use material::{MaterialPoint, MaterialUniforms, MaterialValues, lobe_roughness, lobe_slope};
pub use model::{Model, is_cook_torrance, takes_albedos, takes_compensation, takes_layers, takes_roughness};
pub use surface_point::{PointLayers, SurfacePoint};
pub use textured::{anisotropy_turn, height_derivative, height_step, log2_texels, occluded, turned_uv};
pub use whole::ShadedPixel;
