//! The sources of a bake: the scan, read and corrected, and the low-poly mesh, given or made, with its material and
//! cage.

mod corrections;
mod extent;
mod given;
mod low_file;
mod low_material;
pub(super) mod low_poly;
mod material;
mod scan;
mod size;

pub use corrections::{ScanOptions, into_metres};
pub(super) use corrections::{from_metres, root_scale, turned};
pub(super) use extent::{Extent, Spot, Whole};
pub(super) use given::{GivenMesh, Inputs};
pub(super) use low_file::{Document, is_in_scan_unit};
pub(super) use low_material::{LowLook, Metalness, assign_object_map};
#[cfg(test)]
pub(super) use low_poly::Skew;
pub(super) use low_poly::{Base, KeptTextures, LowPoly, MadeFrom, Pair, RayLength, Rays, Relief};
pub use low_poly::{Origin, Simplification};
pub(super) use material::{Carried, Found, Property, is_plain, used_materials};
pub(super) use scan::{About, ScanNoise};
pub use scan::{Scan, ScanFile};
pub use size::ScanSize;
pub(super) use size::{ModelFile, all_files, is_gltf, stated_unit, warnings_of_packed_scan};
