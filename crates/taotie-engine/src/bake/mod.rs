//! Baking: simplifies and unwraps a high-poly surface, projects a low-poly one onto it, and averages the values that
//! the samples of each texel find. [`bake`] is the whole; [`Verifier`] measures the result.
//!
//! [`Coverage`] holds the triangle of each texel, [`TexelSurface`] the surface point there. The formulas are in
//! [`crate::surface`]; here they are evaluated for all texels, in parallel and with the same bits for any number of
//! threads.

mod appearance;
mod cage;
mod coverage;
mod faults;
mod fill;
mod fit;
mod fit_normals;
mod layout;
mod maps;
mod projection;
mod remesh;
mod scan;
mod sights;
mod simplify;
mod skew;
mod sky;
mod texel_sums;
mod texel_surface;
mod texels;
mod texture_lookup;
mod textured_mesh;
mod unwrap;
mod verify;

pub use appearance::{MaterialSample, leading_texture};
pub use cage::{Cage, CageGroups, RayPreview};
pub use coverage::{Coverage, TexelGrid};
pub use faults::{Faults, Shells, coinciding_sides};
pub use fit::{Astray, Fit, uncovered};
pub use fit_normals::fit_normals;
pub use maps::{BakeCounts, Baked, BakedMaps, MapContent, MapKind, Maps, Plane, SetSizes, TexelStatus};
pub use projection::{Among, Correspondence, Floating, MatchRule, ProjectionRay, Target};
pub use remesh::{REMESH_BYTES, Remesh, Remeshed, remesh};
pub(crate) use scan::Retextured;
pub use scan::{CastRay, Open, RayCaster, RayDevice, Scan, SkyPoint, SkyRays, Visibility, bytes_on_device};
pub use sights::SightLine;
pub(crate) use sights::sphere_directions;
pub use simplify::{DetailLevel, Simplified, SimplifyMethod, SimplifyOptions, levels, simplify};
pub(crate) use sky::{Bevel, Seen, facet_of};
pub use texel_surface::{SurfacePoint, TexelSurface, UvIndex, UvLookup};
pub use texels::{BakeInput, BakeSettings, bake, bytes_of_bands};
pub use texture_lookup::{LookupPoint, MappedNormal, texel_width};
pub use textured_mesh::{TexturedMesh, framed_low_poly_mesh, lacks_tangents, low_poly_mesh};
pub use unwrap::{UnwrapOptions, Unwrapped, unwrap};
pub use verify::{ErrorMaps, MaterialError, NormalError, TexelChecks, Verifier};
