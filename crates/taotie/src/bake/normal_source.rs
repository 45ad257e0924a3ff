//! The source of a part's normals beside its vertices.

use crate::scene::{HeightMap, Material, NormalMap, NormalSpace};

/// The map that bends a part's normals, chosen as renderers choose it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NormalSource {
    /// None: vertices say all.
    Smooth,
    /// A normal map in object space.
    ObjectMap(NormalMap),
    /// A normal map in tangent space.
    TangentMap(NormalMap),
    /// A height map.
    Height(HeightMap),
}

impl NormalSource {
    /// Returns the source of a material on a mesh with so many uv sets. Without the map's own there is none.
    pub fn of(material: &Material, uv_sets: usize) -> Self {
        let source = match (material.normal, material.height) {
            (Some(map), _) if map.space == NormalSpace::Object => Self::ObjectMap(map),
            (Some(map), _) => Self::TangentMap(map),
            (None, Some(map)) => Self::Height(map),
            (None, None) => Self::Smooth,
        };
        if source.uv_set().is_some_and(|set| set >= uv_sets) { Self::Smooth } else { source }
    }

    /// Returns the uv set that tangents have to follow, where they are read.
    pub fn tangent_set(&self) -> Option<usize> {
        if let Self::TangentMap(map) = self { Some(map.texture.uv_set) } else { None }
    }

    fn uv_set(&self) -> Option<usize> {
        match self {
            Self::Smooth => None,
            Self::ObjectMap(map) | Self::TangentMap(map) => Some(map.texture.uv_set),
            Self::Height(map) => Some(map.texture.uv_set),
        }
    }
}
