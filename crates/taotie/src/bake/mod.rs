//! Baking: high-poly surfaces simplified and unwrapped, the correspondence of the points of a low-poly surface, and the
//! point of a mesh that each texel of a map shows.
//!
//! [`Coverage`] says which triangle a texel belongs to, [`TexelSurface`] what the surface is there. Formulas stand in
//! [`crate::surface`]; here they are run over all texels, in parallel and with the same bits for any number of
//! threads.

mod baked_maps;
mod cage;
mod color;
mod coverage;
mod curvature;
mod faults;
mod fill;
mod grow;
mod layout;
mod levels;
mod maps;
mod owner;
mod projection;
mod raster;
mod scan;
mod search;
mod simplify;
mod sky;
mod texel_surface;
mod texels;
mod unwrap;
mod uv_lookup;
mod verify;

pub use baked_maps::{BakedMaps, TexelStatus};
pub use cage::Cage;
pub use coverage::{Coverage, TexelGrid};
pub use faults::Faults;
pub use levels::{DetailLevel, levels};
pub use maps::{MapKind, Maps};
pub use projection::{Correspondence, ProjectionRay};
pub use scan::{Scan, low_poly_mesh};
pub use simplify::{Simplified, SimplifyMethod, SimplifyOptions, simplify};
pub use texel_surface::{SurfacePoint, TexelSurface};
pub use texels::{BakeCounts, BakeInput, BakeSettings, Baked, bake};
pub use unwrap::{UnwrapOptions, Unwrapped, unwrap};
pub use uv_lookup::UvLookup;
pub use verify::{Deviation, Fit, NormalError, Verifier};
