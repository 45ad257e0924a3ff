//! The sources of the shading normal: facets, vertex normals, bump and normal maps, and the tangents that they need.
//!
//! The formulas that run per pixel ([`tangent_normal`], [`bump`] and others) are written once over
//! [`crate::math::Lane`]; code that runs once per mesh or per texture works on whole arrays.

mod bends;
mod connectivity;
mod creases;
mod face_tangents;
mod inspect;
mod maps;
mod noise;
mod normals;
mod tangents;
mod weld;
mod winding;

pub(crate) use bends::mean_curvatures;
pub use bends::{Bends, MODELLED_CREASE_DEG, looks_scanned, with_hard_edges};
pub use connectivity::{HardEdges, uv_islands};
pub(crate) use creases::{creased, has_turned_facets, parted};
pub use face_tangents::{UvDerivatives, uv_derivatives};
pub use inspect::{GreenGuess, GreenVerdict, NormalMapKind, green_direction, invalid_texels, is_normal_map};
pub use maps::{
    Relief, ReliefBase, bump, bump_printed, decode_normal, decode_object_normal, encode_normal,
    object_normal, rebuild_z, relief_normal, surface_gradient, tangent_normal, tangent_space_normal,
};
pub use noise::{Denoised, Noise, NoiseChange, NoiseHandling, denoising_bytes};
pub use normals::{facet_normal, vertex_normals, with_normals};
pub(crate) use normals::{mean_by_position, shared_by_position, with_normals_at};
pub(crate) use tangents::{NO_UV_AREA, with_frames_at};
pub use tangents::{TangentMethod, Tangented, tangent_bytes, with_frames, with_tangents};
pub use weld::{Classes, bits, by_position, shell_labels};
pub use winding::Opposed;

use crate::names::Named;

/// The source of the shading normal.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceMethod {
    /// The geometric normal of the triangle.
    Facet,
    /// The interpolated vertex normal.
    Smooth,
    /// A height map by the surface-gradient method (Mikkelsen 2020).
    Bump,
    /// Bump mapping as printed in Table 2 of Guo and Wang 2025: not normalised, see [`bump_printed`].
    BumpPrinted,
    /// Read from an object-space map.
    ObjectNormal,
    /// Read from a tangent-space map.
    #[default]
    TangentNormal,
}

impl SurfaceMethod {
    /// Every method, in the order of their names.
    pub const ALL: [Self; 6] =
        [Self::Facet, Self::Smooth, Self::Bump, Self::BumpPrinted, Self::ObjectNormal, Self::TangentNormal];

    /// Returns true if a map bends the normals, and not as printed.
    pub fn is_mapped(self) -> bool {
        matches!(self, Self::Bump | Self::ObjectNormal | Self::TangentNormal)
    }
}

impl Named for SurfaceMethod {
    const WHAT: &'static str = "surface method";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("facet", Self::Facet),
        ("smooth", Self::Smooth),
        ("bump", Self::Bump),
        ("bump-printed", Self::BumpPrinted),
        ("object-normal", Self::ObjectNormal),
        ("tangent-normal", Self::TangentNormal),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_methods_have_a_name_in_their_order() {
        let named: Vec<_> = SurfaceMethod::NAMES.iter().map(|(_, method)| *method).collect();
        assert_eq!(named, SurfaceMethod::ALL);
        // Pages of the viewer store positions in this list.
        let names = ["facet", "smooth", "bump", "bump-printed", "object-normal", "tangent-normal"];
        assert_eq!(SurfaceMethod::ALL.map(Named::name), names);
    }
}
