//! The bake itself: its plan, the memory that it needs, the faults that it finds, and the asset with its maps.

mod asset;
pub(super) mod judgement;
mod maps;
mod memory;
mod plan;

pub use asset::{Asset, Trial};
pub(super) use asset::{Coarser, LevelLook, Made, MadeAsset, Part, Rounding};
pub use judgement::Misses;
pub(super) use judgement::{INSIDE_OUT, percent, refuse_astray, useless_map};
pub use maps::{Range, SeparateMap, Textures};
pub(super) use maps::{Recipe, StoredMaps, bake_maps, label_color, labeled};
pub use memory::MemoryEstimate;
pub use plan::DroppedProperty;
pub(super) use plan::{BakePlan, chosen_side, set_sizes, side_shortfall};
