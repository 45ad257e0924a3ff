//! A coarser level of detail, and its source.

use super::smallest::{MadeAsset, PackedAsset};
use super::workshop::Rounding;
use crate::asset::low::LowPoly;
use crate::asset::maps::StoredMaps;
use crate::mesh::Mesh;

/// The source of coarser levels.
pub(in crate::asset) enum Finest<'a> {
    /// A mesh and its maps, as stored, with the loss of the file's formats if a search chose it.
    Made { low: &'a LowPoly, maps: &'a StoredMaps, rounding: Option<Rounding> },
    /// The scan, packed.
    Packed(&'a PackedAsset),
}

/// A coarser level of detail.
pub(in crate::asset) struct Coarser {
    pub mesh: Mesh,
    pub look: LevelLook,
    /// The pixels across the object at which it is first shown.
    pub across: u32,
    /// `true` if it meets the limits of the finest level there.
    pub is_near: bool,
}

/// The maps or materials that a level shows on its mesh.
pub(in crate::asset) enum LevelLook {
    /// The maps of the finest level.
    Shared,
    /// The same, except for a normal map baked for it on the same uvs.
    Rebaked(Box<StoredMaps>),
    /// Its own maps, or none.
    Own(Box<MadeAsset>),
    /// The scan's materials, in a separate GLB.
    Packed(Vec<u8>),
}
