//! Shaders written from the formulas that Taotie renders with.
//!
//! The formulas of `taotie::shade` run on any [`Lane`](taotie::math::Lane). Here they run on a [`Recorded`] number, which
//! writes down what is done with it: an expression graph ([`record`]). The same operation on the same operands stands in
//! the graph once. Three channels that are treated alike become one vector, and where a formula's body stands in
//! another's graph it becomes a call ([`library()`]). [`evaluate()`] plays a graph back on any lane; [`shader()`] writes a
//! model as WGSL or GLSL ES 3.00, [`functions()`] any formulas.

mod body;
mod environment;
mod evaluate;
mod graph;
mod inputs;
mod language;
mod layers;
mod library;
mod models;
mod names;
mod outline;
mod program;
mod recorder;
mod shader;
mod structures;
mod vectors;

pub use evaluate::{EvaluateError, evaluate};
pub use graph::{Binary, Call, Graph, Id, Kind, Node, Parameter, Unary};
pub use language::Language;
pub use library::library;
pub use models::model_name;
pub use program::{Formula, Program};
pub use recorder::{Recorded, RecordedTruth, Scope, record};
pub use shader::{functions, shader};
