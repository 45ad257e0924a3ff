//! Reflectance, the light that a surface reflects to the viewer: pure functions of numbers, each formula written once
//! over [`Lane`](crate::math::Lane).
//!
//! [`fresnel`], [`ndf`] and [`masking`] are the parts, free to combine; [`reflect`] evaluates the named models of
//! [`Shading`], and [`furnace`] integrates their reflection. Nothing here depends on a scene: the caller samples
//! textures into a [`MaterialSample`], creates [`Angles`] from its directions and multiplies the result by the
//! irradiance, for which [`lights`] has the formulas.

mod angles;
mod anisotropy;
mod coat;
mod compensation;
mod energy;
mod facets;
mod material_sample;
mod models;
mod shading;
mod widening;

pub mod dfg;
pub mod environment;
pub mod fresnel;
pub mod furnace;
pub mod lights;
pub mod masking;
pub mod ndf;
pub mod sampling;
pub mod sheen;

pub use angles::Angles;
pub use anisotropy::AnisotropicLobe;
pub(crate) use coat::COAT_F0;
pub use coat::{coat_fresnel, coat_lobe};
pub use compensation::{Compensation, compensation};
pub use energy::{Energy, EnvironmentWeights, environment_weights, specular_occlusion};
pub use facets::Facets;
pub use material_sample::MaterialSample;
pub use models::{reflect, reflect_anisotropic};
pub use shading::Shading;
pub use widening::{SubPixelVariance, curvature_variance};
