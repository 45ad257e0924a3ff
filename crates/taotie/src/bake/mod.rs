//! Baking: simplifies and unwraps high-poly surfaces, finds the correspondence of the points of a low-poly surface
//! and the point of a mesh that each texel of a map shows.
//!
//! [`Coverage`] holds the triangle of each texel, [`TexelSurface`] the surface point there. The formulas are in
//! [`crate::surface`]; here they are evaluated for all texels, in parallel and with the same bits for any number of
//! threads.

mod alpha;
mod appearance;
mod area_samples;
mod astray;
mod baked_maps;
mod cage;
mod coverage;
mod curvature;
mod faults;
mod fill;
mod fit_normals;
mod grow;
mod hidden_shells;
mod joined;
mod layout;
mod levels;
mod map_places;
mod mapped_normal;
mod maps;
mod material_sums;
mod normal_system;
mod owner;
mod projection;
mod raster;
mod retextured;
mod scan;
mod search;
mod seen_cells;
mod sight;
mod sights;
mod simplify;
mod sky;
mod texel_surface;
mod texels;
mod texture_lookup;
mod textured_mesh;
mod triangle_modes;
mod uncovered;
mod unwrap;
mod uv_lookup;
mod verify;
mod verify_maps;
mod verify_material;
mod visibility;

pub use appearance::MaterialSample;
pub(crate) use area_samples::{Triangles, sample_area, sample_triangles};
pub(crate) use astray::Astray;
pub use baked_maps::{BakedMaps, TexelStatus};
pub use cage::Cage;
pub use coverage::{Coverage, TexelGrid};
pub use faults::Faults;
pub(crate) use fit_normals::fit_normals;
pub(crate) use hidden_shells::Shells;
pub(crate) use joined::framed_low_poly_mesh;
pub use joined::low_poly_mesh;
pub use levels::{DetailLevel, levels};
pub use map_places::leading_texture;
pub use mapped_normal::MappedNormal;
pub use maps::{MapKind, Maps};
pub use projection::{Correspondence, ProjectionRay};
pub(crate) use retextured::Retextured;
pub use scan::Scan;
pub use sights::SightLine;
pub(crate) use sights::sphere_directions;
pub use simplify::{Simplified, SimplifyMethod, SimplifyOptions, simplify};
pub use texel_surface::{SurfacePoint, TexelSurface};
pub(crate) use texels::bytes_of_bands;
pub use texels::{BakeCounts, BakeInput, BakeSettings, Baked, bake};
pub use texture_lookup::LookupPoint;
pub(crate) use texture_lookup::texel_width;
pub use textured_mesh::TexturedMesh;
pub(crate) use textured_mesh::lacks_tangents;
pub(crate) use uncovered::uncovered;
pub use unwrap::{UnwrapOptions, Unwrapped, unwrap};
pub use uv_lookup::UvLookup;
pub use verify::{Fit, NormalError, Verifier};
pub use verify_maps::{ErrorMaps, TexelChecks};
pub use verify_material::MaterialError;
pub use visibility::Visibility;
