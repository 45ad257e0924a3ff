//! Notes on what a proof does not look at, so that nobody takes it for proved.

use super::look;
use crate::bake::MapKind;
use crate::scene::{Material, NormalSpace, Scene, Specular};

/// A layer of a material: the test for it, and its name.
type Layer = (fn(&Material) -> bool, &'static str);

/// Layers that no figure compares.
const LAYERS: [Layer; 4] = [
    (|m| m.clearcoat.is_some(), "clearcoat"),
    (|m| m.sheen.is_some(), "sheen"),
    (|m| m.anisotropy.is_some(), "anisotropy"),
    (|m| m.specular != Specular::default() || m.ior != 1.5, "specular strength and index of refraction"),
];

/// Returns what an asset holds, or its scan, that no figure and no image compares.
pub(super) fn unseen(maps: &[MapKind], space: NormalSpace, [scan, asset]: [&Scene; 2]) -> Vec<String> {
    let blind = [
        (MapKind::Occlusion, "ambient occlusion, whose rays are not traced a second time"),
        (MapKind::OcclusionMap, "the occlusion of the scan's own texture"),
        (MapKind::Bent, "bent normals"),
        (MapKind::Height, "heights"),
        (MapKind::Curvature, "curvature"),
    ];
    let materials = || look::used(scan).chain(look::used(asset));
    let is_beside = space == NormalSpace::Object && maps.contains(&MapKind::Normal);
    let beside = is_beside.then_some("the object-space normal map in the images");
    let maps = blind.into_iter().filter(|(map, _)| maps.contains(map)).map(|(_, what)| what);
    let layers = LAYERS.into_iter().filter(|(has, _)| materials().any(has)).map(|(_, what)| what);
    let plain = look::is_plain(scan).then_some("colour and material, of which the scan says nothing");
    plain.into_iter().chain(beside).chain(maps).chain(layers).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::scene::Sheen;

    fn ball(material: Material) -> Scene {
        Scene::of_mesh(Mesh::sphere(1.0, 8, 4), material).unwrap()
    }

    #[test]
    fn what_no_figure_covers_is_named() {
        let sheen = Sheen { color: [1.0; 3], color_texture: None, roughness: 0.5, roughness_texture: None };
        let plain = ball(Material::default());
        let felt = ball(Material { sheen: Some(sheen), ..Material::default() });
        let maps = [MapKind::Normal, MapKind::Height];
        let named = unseen(&maps, NormalSpace::Tangent, [&plain, &plain]);
        assert_eq!(named, ["colour and material, of which the scan says nothing", "heights"]);
        assert_eq!(unseen(&maps, NormalSpace::Tangent, [&felt, &plain]), ["heights", "sheen"]);
        assert_eq!(unseen(&[], NormalSpace::Object, [&felt, &felt]), ["sheen"]);
        let named = unseen(&maps, NormalSpace::Object, [&felt, &felt]);
        assert_eq!(named, ["the object-space normal map in the images", "heights", "sheen"]);
    }
}
