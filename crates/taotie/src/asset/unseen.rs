//! Notes on what a proof does not compare, so that nobody assumes it is proved.

use super::look;
use crate::bake::MapKind;
use crate::scene::{Material, Scene, Specular};

/// A layer of a material: its test and its name.
type Layer = (fn(&Material) -> bool, &'static str);

/// Layers that no figure compares.
const LAYERS: [Layer; 4] = [
    (|m| m.clearcoat.is_some(), "clearcoat"),
    (|m| m.sheen.is_some(), "sheen"),
    (|m| m.anisotropy.is_some(), "anisotropy"),
    (|m| m.specular != Specular::default() || m.ior != 1.5, "specular strength and index of refraction"),
];

/// Returns the contents of an asset's files, or of its scan, that no figure and no image compares; `poses` if one of
/// them moves.
pub(super) fn unseen([scan, asset]: [&Scene; 2], poses: bool) -> Vec<String> {
    let materials = || look::used(scan).chain(look::used(asset));
    let plain = look::is_plain(scan).then_some("colour and material, which the scan does not specify");
    let poses = poses.then_some("poses: an animated asset is compared at rest");
    let has_occlusion = look::used(asset).any(|material| material.occlusion_texture.is_some());
    let occlusion = has_occlusion.then_some("ambient occlusion, whose rays are not traced a second time");
    let layers = LAYERS.into_iter().filter(|(has, _)| materials().any(has)).map(|(_, what)| what);
    plain.into_iter().chain(poses).chain(occlusion).chain(layers).map(str::to_owned).collect()
}

/// Returns the maps next to an asset that are not compared with anything.
pub(super) fn unproved_maps(maps: &[MapKind]) -> Vec<String> {
    let blind =
        [(MapKind::Bent, "bent normals"), (MapKind::Height, "heights"), (MapKind::Curvature, "curvature")];
    blind.into_iter().filter(|(map, _)| maps.contains(map)).map(|(_, what)| what.to_owned()).collect()
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
        let plainly = "colour and material, which the scan does not specify";
        assert_eq!(unseen([&plain, &plain], false), [plainly]);
        assert_eq!(unseen([&felt, &plain], false), ["sheen"]);
        assert_eq!(unseen([&plain, &plain], true)[1], "poses: an animated asset is compared at rest");
        assert_eq!(unproved_maps(&[MapKind::Normal, MapKind::Height]), ["heights"]);
    }
}
