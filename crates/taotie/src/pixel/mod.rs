//! The pixel program: every step from interpolated values to the radiance that leaves a point, written once over
//! [`Lane`](crate::math::Lane).
//!
//! Each stage takes numbers and returns numbers. Between stages a backend fetches the data of the next one: texels, table
//! entries, the environment's light, shadows.
//!
//! ```text
//! Geometry, NormalInputs              -> Geometry::front_normal         -> Frame::new
//! texels, factors                     -> MaterialValues
//! MaterialUniforms, values, tables    -> MaterialPoint::new
//! Frame, MaterialPoint, PointLayers   -> SurfacePoint
//! Frame                               -> highlight, coat_highlight      where the environment is looked up
//! SurfacePoint, LightSource           -> SurfacePoint::own, ::reflect
//! SurfacePoint, EnvironmentTexels     -> SurfacePoint::reflect_environment
//! ```
//!
//! [`PixelInputs`] runs all of them for a single point, with any number type that can index an array: `f64` is the
//! reference for the others, and dual numbers yield the [`Gradient`].
//!
//! `render` runs it on packs, `render::reference` on paths, and a recorder turns it into shaders. [`Model`] and the
//! `Option`s of the uniforms state which parts a surface has; they are known before any pixel.

mod environment;
mod frame;
mod geometry;
mod gradient;
mod inputs;
mod layers;
mod light;
mod material;
mod model;
mod normal_source;
mod surface_point;
mod textured;
mod whole;

pub use environment::{Anisotropic, EnvironmentTexels, Highlight, Turn, coat_highlight, highlight};
pub use frame::{Frame, anisotropy_direction, coat_normal};
pub use geometry::{Geometry, MappedNormal};
pub use gradient::Gradient;
pub use inputs::{
    AnisotropyInputs, CoatInputs, EnvironmentSource, IncidentLight, LayerInputs, NormalValues, PixelInputs,
    SheenInputs,
};
pub use layers::{Coat, Sheen, coat_albedo, sheen_albedo};
pub use light::{Cone, Falloff, Incidence, LightSource, Place};
pub use material::{MaterialPoint, MaterialUniforms, MaterialValues, lobe_roughness, lobe_slope};
pub use model::{Model, is_cook_torrance, takes_albedos, takes_compensation, takes_layers, takes_roughness};
pub use normal_source::{NormalInputs, NormalSource};
pub use surface_point::{PointLayers, SurfacePoint};
pub use textured::{anisotropy_turn, height_derivative, height_step, log2_texels, occluded, turned_uv};
pub use whole::ShadedPixel;
