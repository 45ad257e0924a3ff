//! The texture slots of a material that an asset has too.

use super::options::BakeOptions;
use super::property::Property;
use crate::bake::MapKind;
use crate::scene::{Material, TextureRef};

/// A texture slot, with the maps that are baked in its place.
#[derive(Debug)]
pub(super) struct Slot {
    /// Its name in words.
    pub name: &'static str,
    /// The property that it stores.
    pub property: Property,
    maps: &'static [MapKind],
}

/// All slots except the normal map, which is never kept.
pub(super) static SLOTS: [Slot; 4] = [
    Slot { name: "base colour", property: Property::BaseColor, maps: &[MapKind::Albedo] },
    Slot {
        name: "metallic-roughness",
        property: Property::MetallicRoughness,
        maps: &[MapKind::Roughness, MapKind::MetallicRoughness],
    },
    Slot {
        name: "occlusion",
        property: Property::Occlusion,
        maps: &[MapKind::Occlusion, MapKind::OcclusionMap],
    },
    Slot { name: "emission", property: Property::Emission, maps: &[MapKind::Emission] },
];

impl Slot {
    /// Returns the texture that a material has in this slot.
    pub fn texture(&self, material: &Material) -> Option<TextureRef> {
        match self.property {
            Property::BaseColor => material.base_color_texture,
            Property::MetallicRoughness => material.metallic_roughness_texture,
            Property::Occlusion => material.occlusion_texture,
            _ => material.emissive_texture,
        }
    }

    /// Returns true if a map is baked in its place.
    pub fn is_baked(&self, options: &BakeOptions) -> bool {
        options.bakes(self.maps)
    }
}
