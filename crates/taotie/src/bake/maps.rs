//! The maps that can be baked.

use crate::names::Named;

/// A map that a scan can be baked into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum MapKind {
    /// The scan's normals.
    Normal,
    /// The open part of the hemisphere over the scan, weighted by the cosine: 1 is open.
    #[cfg_attr(feature = "serde", serde(rename = "ao"))]
    Occlusion,
    /// The scan's base colour, from its vertices, materials and textures.
    Albedo,
    /// The height of the scan above the low-poly mesh.
    Height,
    /// The mean open direction.
    Bent,
    /// The scan's mean curvature, above 0 where it bulges.
    Curvature,
    /// Roughness, widened by relief finer than a texel.
    Roughness,
    /// The scan's own metalness and roughness, from its materials and textures.
    #[cfg_attr(feature = "serde", serde(rename = "metallic-roughness"))]
    MetallicRoughness,
    /// The radiance that the scan emits.
    Emission,
    /// The scan's alpha, from its vertices, materials and textures.
    Alpha,
    /// The scan's own occlusion texture.
    #[cfg_attr(feature = "serde", serde(rename = "occlusion"))]
    OcclusionMap,
}

impl Named for MapKind {
    const WHAT: &'static str = "map";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("normal", Self::Normal),
        ("ao", Self::Occlusion),
        ("albedo", Self::Albedo),
        ("height", Self::Height),
        ("bent", Self::Bent),
        ("curvature", Self::Curvature),
        ("roughness", Self::Roughness),
        ("metallic-roughness", Self::MetallicRoughness),
        ("emission", Self::Emission),
        ("alpha", Self::Alpha),
        ("occlusion", Self::OcclusionMap),
    ];
}

/// A set of maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "Vec<MapKind>", into = "Vec<MapKind>")
)]
pub struct Maps(u16);

impl Maps {
    /// Returns the set with one more map.
    pub fn with(self, map: MapKind) -> Self {
        Self(self.0 | 1 << map as u8)
    }

    /// Returns `true` if a map is in the set.
    pub fn has(self, map: MapKind) -> bool {
        self.0 & 1 << map as u8 != 0
    }

    /// Returns `true` if any of several maps is in the set.
    pub fn has_any(self, maps: &[MapKind]) -> bool {
        maps.iter().any(|map| self.has(*map))
    }

    /// Returns the maps, in the order of [`MapKind`].
    pub fn iter(self) -> impl Iterator<Item = MapKind> {
        MapKind::NAMES.iter().map(|(_, map)| *map).filter(move |map| self.has(*map))
    }
}

impl From<Vec<MapKind>> for Maps {
    fn from(maps: Vec<MapKind>) -> Self {
        maps.into_iter().collect()
    }
}

impl From<Maps> for Vec<MapKind> {
    fn from(maps: Maps) -> Self {
        maps.iter().collect()
    }
}

impl FromIterator<MapKind> for Maps {
    fn from_iter<I: IntoIterator<Item = MapKind>>(maps: I) -> Self {
        maps.into_iter().fold(Self::default(), Self::with)
    }
}
