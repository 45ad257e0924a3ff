//! The sources of the shading normal: facets, vertex normals, bump and normal maps, and the tangents that they need.
//!
//! The formulas that run per pixel ([`tangent_normal`], [`bump`] and others) are written once over
//! [`crate::math::Lane`]; code that runs once per mesh or per texture works on whole arrays.

mod angles;
mod bends;
mod bump;
mod corners;
mod creases;
mod edges;
mod frame;
mod hard_edges;
mod inspect;
mod maps;
mod method;
mod mikktspace;
mod normals;
mod parted;
mod tangents;
mod uv_islands;
mod weld;
mod winding;

pub(crate) use bends::{Bends, MODELLED_CREASE_DEG, looks_scanned};
pub use bump::{Relief, ReliefBase, bump, bump_printed, relief_normal, surface_gradient};
pub(crate) use creases::{creased, has_turned_facets};
pub use frame::{UvDerivatives, uv_derivatives};
pub(crate) use hard_edges::HardEdges;
pub use inspect::{GreenGuess, GreenVerdict, NormalMapKind, green_direction, invalid_texels, is_normal_map};
pub use maps::{
    decode_normal, decode_object_normal, encode_normal, object_normal, rebuild_z, tangent_normal,
    tangent_space_normal,
};
pub use method::{SurfaceMethod, TangentMethod};
pub use normals::{facet_normal, vertex_normals, with_normals};
pub(crate) use normals::{mean_by_position, shared_by_position, with_normals_at};
pub(crate) use parted::parted;
pub(crate) use tangents::{NO_UV_AREA, tangent_bytes, with_frames_at};
pub use tangents::{Tangented, with_frames, with_tangents};
pub(crate) use uv_islands::uv_islands;
pub(crate) use weld::{Classes, bits, by_position};
pub(crate) use winding::Opposed;
