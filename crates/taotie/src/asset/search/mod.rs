//! The search for the asset of the fewest bytes that is near enough to its scan.
//!
//! Errors of different sources, such as of the mesh, of texels and of what a codec loses, add up in squares. So each is
//! measured by itself, and together they give an estimate of the smallest candidate; that is made, read back and measured.

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
