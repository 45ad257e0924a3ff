//! Hints about content that will not look as intended.

use super::material::MaterialReport;
use super::mesh::MeshReport;
use crate::scene::{GreenChannel, NormalSpace};
use crate::surface::{GreenVerdict, NormalMapKind};

/// The mean angle from MikkTSpace's tangents that is worth a hint, in degrees.
const FAR_FROM_MIKKTSPACE: f64 = 5.0;

/// Content that will not look as intended.
///
/// ```
/// use taotie::inspection::Hint;
///
/// /// Returns a short explanation.
/// fn advice(hint: &Hint) -> String {
///     match hint {
///         Hint::OtherGreen { material, by_pixels, .. } => format!("{material}: green points {by_pixels:?}"),
///         Hint::OtherSpace { material, by_pixels, .. } => format!("{material}: a map in {by_pixels:?} space"),
///         other => format!("{other:?}"),
///     }
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Hint {
    /// The normal map of a material does not look like one.
    NoNormalMap {
        /// The material's name.
        material: String,
    },
    /// A normal map is drawn in a different space from the one that its pixels suggest.
    OtherSpace {
        /// The material's name.
        material: String,
        /// The space in which it is drawn.
        drawn: NormalSpace,
        /// The space that its pixels suggest.
        by_pixels: NormalSpace,
    },
    /// A normal map is drawn with a different green direction from the one that its pixels suggest.
    OtherGreen {
        /// The material's name.
        material: String,
        /// The direction with which it is drawn.
        drawn: GreenChannel,
        /// The direction that its pixels suggest.
        by_pixels: GreenChannel,
    },
    /// The tangents of a mesh are far from MikkTSpace's.
    FarFromMikkTSpace {
        /// The mesh's name.
        mesh: String,
        /// Mean angle, degrees.
        mean_degrees: f64,
    },
}

/// Returns hints about normal maps and tangents.
pub(super) fn of(materials: &[MaterialReport], meshes: &[MeshReport]) -> Vec<Hint> {
    materials.iter().filter_map(about_map).chain(meshes.iter().filter_map(about_tangents)).collect()
}

fn about_map(material: &MaterialReport) -> Option<Hint> {
    let map = material.normal_map.as_ref()?;
    let material = material.name.clone();
    let by_pixels = match map.pixels.kind_by_pixels {
        NormalMapKind::No => return Some(Hint::NoNormalMap { material }),
        NormalMapKind::Tangent => NormalSpace::Tangent,
        NormalMapKind::Object => NormalSpace::Object,
    };
    if by_pixels != map.space {
        return Some(Hint::OtherSpace { material, drawn: map.space, by_pixels });
    }
    let by_pixels = match map.pixels.green_by_pixels? {
        GreenVerdict::Up => GreenChannel::Up,
        GreenVerdict::Down => GreenChannel::Down,
        GreenVerdict::Unclear => return None,
    };
    (by_pixels != map.green).then_some(Hint::OtherGreen { material, drawn: map.green, by_pixels })
}

fn about_tangents(mesh: &MeshReport) -> Option<Hint> {
    let mean_degrees = mesh.tangents.as_ref()?.mikktspace.as_ref()?.mean_degrees;
    let mesh = mesh.name.clone();
    (mean_degrees > FAR_FROM_MIKKTSPACE).then_some(Hint::FarFromMikkTSpace { mesh, mean_degrees })
}
