//! The request for an asset: figures and the requirements that limit them, levels of detail, and the options of a
//! bake and of its packing.

mod channels;
mod figure;
mod lod;
mod options;
pub(super) mod requirement;

pub use channels::Channels;
pub(super) use channels::{CHANNELS, ChannelSource, MapChannel, Quantity};
pub use figure::{Figure, FigureUnit, Looking};
pub(super) use figure::{Sampling, name_within, shown_unit, title_within};
pub use lod::Lod;
pub(super) use lod::{pixels_across, screen_coverage};
pub use options::{BakeOptions, MeshSource, Packing, RayDistance};
pub(super) use options::{MASK_NEEDS_UVS, NEEDS_UVS, SQUARE, note_unread_options};
pub use requirement::{Preset, Requirement};
