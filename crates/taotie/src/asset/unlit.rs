//! Maps that an unlit material (`KHR_materials_unlit`) does not show.

use super::made::Part;
use crate::bake::MapKind;
use crate::error::Warnings;
use crate::io::GltfMaterial;

/// Returns the warning for these materials.
pub(super) fn note<T>(hiding: impl Iterator<Item = T>) -> Warnings {
    let mut warnings = Warnings::default();
    let what = "materials are unlit (KHR_materials_unlit): viewers show only their base colour map";
    warnings.note(what, hiding.count());
    warnings
}

/// Returns true if a written material hides textures.
pub(super) fn hides_maps(material: &GltfMaterial<'_>) -> bool {
    let GltfMaterial { metallic_roughness_map, occlusion_map, normal_map, emissive_map, layers, .. } =
        material;
    let hidden = [metallic_roughness_map, occlusion_map, normal_map, emissive_map];
    layers.is_some_and(|layers| layers.unlit) && hidden.iter().any(|map| map.is_some())
}

/// Returns true if the low-poly mesh's material hides standalone maps.
pub(super) fn hides_maps_of(part: &Part) -> bool {
    let is_seen = |map| matches!(map, MapKind::Albedo | MapKind::Alpha);
    part.low.material.unlit && part.maps.textures.inside().any(|(map, _)| !is_seen(map))
}
