//! The pixel program: every step from interpolated values to the radiance that leaves a point, written once over
//! [`Lane`](crate::math::Lane).
//!
//! Each stage takes numbers and returns numbers. Between stages a backend fetches the data of the next one: texels, table
//! entries, the environment's light, shadows.
//!
//! ```text
//! Geometry, NormalInputs              -> Geometry::front_normal         -> Frame::new
//! Texel: texels, factors              -> MaterialValues
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

mod geometry;
mod gradient;
mod light;
mod material;
mod program;
mod surface_point;
mod texels;

pub use geometry::{
    Frame, Geometry, MappedNormal, NormalInputs, NormalSource, anisotropy_direction, coat_normal,
};
pub use gradient::Gradient;
pub use light::{
    Anisotropic, Cone, EnvironmentTexels, Falloff, Highlight, Incidence, LightSource, Place, Turn,
    coat_highlight, highlight,
};
pub(crate) use material::takes_layers;
pub use material::{
    CLEAR, MaterialPoint, MaterialUniforms, MaterialValues, Model, PassedLight, anisotropy_turn,
    height_derivative, height_step, is_cook_torrance, lobe_roughness, lobe_slope, log2_texels,
    mapped_variance, occluded, own_turn, takes_albedos, takes_compensation, takes_roughness, turned_uv,
};
pub use program::{
    AnisotropyInputs, CoatInputs, EnvironmentSource, IncidentLight, LayerInputs, NormalValues, PixelInputs,
    ShadedPixel, SheenInputs,
};
pub use surface_point::{Coat, PointLayers, Sheen, SurfacePoint, coat_albedo, sheen_albedo};
pub use texels::{Texel, has_packed_occlusion};
