//! The search for the smallest asset in bytes that is close enough to its scan.
//!
//! Errors from different sources, such as the mesh, texels and codecs, add up in squares. So each is measured
//! separately, and together they give an estimate of the smallest candidate; that is made, read back and measured.

mod bare;
mod encodings;
mod goal;
mod levels;
mod mapped;
mod packed;
mod smallest;
mod workshop;

pub(super) use goal::Level;
pub(super) use levels::{Finest, make_levels};
pub(super) use smallest::{PackedAsset, Smallest, smallest};
