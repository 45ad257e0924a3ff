//! A coarser level of detail, and what it is made from.

use super::smallest::{MadeAsset, PackedAsset};
use super::workshop::Rounding;
use crate::asset::low::LowPoly;
use crate::asset::maps::StoredMaps;
use crate::mesh::Mesh;

/// What coarser levels are made from.
pub(in crate::asset) enum Finest<'a> {
    /// A mesh and its maps, as they are stored, with the loss of its file if a search chose it.
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

/// What a level shows on its mesh.
pub(in crate::asset) enum LevelLook {
    /// The maps of the finest level.
    Shared,
    /// The same, but a normal map that was baked for it on the same uvs.
    Rebaked(Box<StoredMaps>),
    /// Maps of its own, or none.
    Own(Box<MadeAsset>),
    /// The scan's materials, in a GLB of its own.
    Packed(Vec<u8>),
}
