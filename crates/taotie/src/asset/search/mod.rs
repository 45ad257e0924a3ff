//! The search for the smallest asset in bytes that is close enough to its scan.
//!
//! Errors from different sources, such as the mesh, texels and codecs, add up in squares. So each is measured
//! separately, and together they give an estimate of the smallest candidate; that is made, read back and measured.

mod bare;
#[cfg(test)]
mod brute;
mod budget;
mod ceilings;
mod coarser;
mod codecs;
mod curve;
mod encodings;
mod forecast;
mod goal;
mod level;
mod level_maker;
mod levels;
mod map_size;
mod mapped;
mod other_maps;
mod packed;
mod round;
mod smallest;
mod trial;
mod winner;
mod workshop;

pub(super) use coarser::{Coarser, Finest, LevelLook};
pub(super) use level::Level;
pub(super) use levels::make_levels;
pub(super) use smallest::{MadeAsset, PackedAsset, Smallest, smallest};
pub use trial::Trial;
pub(super) use workshop::Rounding;
