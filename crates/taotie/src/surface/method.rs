//! The names of the sources of shading normals and of the methods for tangents.

use crate::names::Named;

/// The source of the shading normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum SurfaceMethod {
    /// The geometric normal of the triangle.
    Facet,
    /// The interpolated vertex normal.
    Smooth,
    /// A height map by the surface-gradient method (Mikkelsen 2020).
    Bump,
    /// Bump mapping as printed in Table 2 of Guo and Wang 2025: not normalised, see [`super::bump_printed`].
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

/// The method for computing tangents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum TangentMethod {
    /// Each triangle's own solution of the two edge equations.
    Face,
    /// The angle-weighted mean of the triangles at a vertex.
    Averaged,
    /// Mikkelsen's tangent space (2008), which bakers and glTF agree on.
    #[default]
    MikkTSpace,
}

impl Named for TangentMethod {
    const WHAT: &'static str = "tangent method";
    const NAMES: &'static [(&'static str, Self)] =
        &[("face", Self::Face), ("averaged", Self::Averaged), ("mikktspace", Self::MikkTSpace)];
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
