//! Materials from photographs of a model whose shape, cameras and lights are known: base colour, roughness and metallic of
//! each texel, with their standard deviations.
//!
//! Each texel gathers the samples of all photographs that see it lit. The engine's own formulas, run on dual numbers, are
//! fitted to them; where the samples leave a variable undetermined, the texels around decide.

mod estimate;
mod fit;
mod frame;
mod gather;
mod layout;
mod linear;
mod maps;
mod model;
mod neighbourhood;
mod reflection;
mod sight;
mod transforms;

pub use estimate::{MaterialEstimate, MaterialsEstimate, MaterialsInput, PhotographResiduals, TexelEstimate};
pub use frame::{Frame, Lamp, LampPlace, Lens, Pose};
pub use layout::Layout;
pub(crate) use linear::{inverse, times};
pub use maps::MaterialMaps;
pub use model::{Model, Texel};
pub use transforms::Transforms;
