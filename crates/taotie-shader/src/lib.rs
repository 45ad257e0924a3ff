//! Shaders generated from the formulas that Taotie renders with.
//!
//! The formulas of `taotie_engine::shade` run on any [`Lane`](taotie_engine::math::Lane). Here they run on a
//! [`Recorded`] number, which records every operation in an expression graph ([`record`]). The same operation on the
//! same operands appears in the graph once. Three channels that are treated alike become one vector, and if a
//! formula's body appears in another's graph, it becomes a call ([`library()`]). [`evaluate()`] evaluates a graph on
//! any lane; [`shader()`] writes a model as WGSL or GLSL ES 3.00, [`functions()`] any formulas.
//!
//! [`pixel_shader()`] writes the whole pixel of a surface: the stages of `taotie_engine::pixel`, recorded for a [`Variant`]
//! ([`PixelProgram`]), with the code that fetches their inputs and joins them. Its [`Interface`] lists the bindings
//! for the host; [`FrameFactors`], [`light_numbers`] and [`SurfaceFactors`] fill the buffers. With the feature
//! `translate`, `translate` converts WGSL to HLSL, MSL and SPIR-V.

mod evaluate;
mod factors;
mod graph;
mod interface;
mod language;
mod library;
mod models;
mod pixel;
mod pixel_shader;
mod program;
mod recorder;
mod shader;
#[cfg(feature = "translate")]
mod translation;
mod variant;
mod vectors;

pub use evaluate::{EvaluateError, evaluate};
pub use factors::SurfaceFactors;
pub use graph::{Binary, Call, Field, Graph, Id, Kind, Node, Parameter, Unary};
pub use interface::{
    BufferSlot, EnvironmentAtlas, FrameFactors, Interface, MOST_LEVELS, MOST_LIGHTS, TextureSlot,
    UniformField, ValueKind, VertexInput, buffer_size, light_numbers, opaque,
};
pub use language::Language;
pub use library::library;
pub use models::model_name;
pub use pixel::PixelProgram;
pub use pixel_shader::{PixelShader, pixel_shader};
pub use program::{Formula, Program};
pub use recorder::{Recorded, RecordedTruth, Scope, record};
pub use shader::{functions, shader};
#[cfg(feature = "translate")]
pub use translation::{Translation, TranslationError, translate};
pub use variant::{Variant, VariantOptions};
