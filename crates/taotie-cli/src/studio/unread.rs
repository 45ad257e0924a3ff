//! Options of the surface that find nothing in the model to act on: each is a warning.

use super::MaterialArgs;
use taotie::Warnings;
use taotie::scene::{Material, Scene};

/// Notes each option that nothing of the scene reads. `height_scale` is the height of white, where it was asked for.
pub fn note(args: &MaterialArgs, height_scale: Option<f64>, scene: &Scene, warnings: &mut Warnings) {
    let materials = scene.materials();
    let is_plain = scene.meshes().iter().all(|mesh| mesh.uvs().is_empty());
    let (mapped, lifted) = (materials.iter().any(has_normal_map), materials.iter().any(has_heights));
    let framed = mapped || materials.iter().any(|material| material.anisotropy.is_some());
    let unread = [
        ("--green is not read: no material has a normal map", args.green.is_some() && !mapped),
        ("--bump-scale is not read: no material has a height map", height_scale.is_some() && !lifted),
        (
            "--tangents is not read: no material has a normal map or is anisotropic",
            args.tangents.is_some() && !framed,
        ),
        (
            "--base-color-map shows one texel everywhere: no mesh has uvs",
            args.base_color_map.is_some() && is_plain,
        ),
        (
            "--occlusion-map shows one texel everywhere: no mesh has uvs",
            args.occlusion_map.is_some() && is_plain,
        ),
    ];
    unread.iter().for_each(|(what, is)| warnings.note(*what, usize::from(*is)));
}

fn has_normal_map(material: &Material) -> bool {
    material.normal.is_some() || material.clearcoat.as_ref().is_some_and(|coat| coat.normal.is_some())
}

fn has_heights(material: &Material) -> bool {
    material.height.is_some()
}
