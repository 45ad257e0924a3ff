//! The files of an asset: a model or standalone maps, with notes on the maps and the record of the bake.

mod map_files;
pub(super) mod maps_alone;
mod provenance;
mod written;

pub use map_files::MapNote;
pub(super) use map_files::{StoredValues, codes_of_normals, name_of, without_folders};
pub use provenance::{Parameters, model_unit};
pub use written::WrittenAsset;
pub(super) use written::possible_files;
