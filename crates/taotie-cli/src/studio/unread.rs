//! Surface options that have no effect on the model: each is a warning.

use super::MaterialArgs;
use taotie_engine::Warnings;
use taotie_engine::scene::{Material, Scene};

/// Adds a warning for each option that has no effect on the scene. `height_scale` is the height of white, if given.
pub fn note(args: &MaterialArgs, height_scale: Option<f64>, scene: &Scene, warnings: &mut Warnings) {
    let materials = scene.materials();
    let is_plain = scene.meshes().iter().all(|mesh| mesh.uvs().is_empty());
    let (mapped, lifted) = (materials.iter().any(has_normal_map), materials.iter().any(has_heights));
    let framed = mapped || materials.iter().any(|material| material.anisotropy.is_some());
    let unread = [
        ("--green has no effect: no material has a normal map", args.green.is_some() && !mapped),
        ("--bump-scale has no effect: no material has a height map", height_scale.is_some() && !lifted),
        (
            "--tangents has no effect: no material has a normal map or is anisotropic",
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
