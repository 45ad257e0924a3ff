//! Notes on things that are asked for, or are in a file, and find no place in the asset: each is told and counted.

use super::options::{AO_RAYS, BakeOptions};
use crate::bake::MapKind;
use crate::error::Warnings;
use crate::io::Loaded;
use crate::scene::{AlphaMode, Material, NormalSpace, Scene, Specular, TextureRef, UvTransform};

/// Notes what a scan's file holds that no bake reads.
pub(super) fn left_of_scan_file(loaded: &mut Loaded) {
    let Loaded { warnings, xmp, rig, .. } = loaded;
    warnings.note(
        "XMP metadata of the scan beside that of the whole asset, left out",
        xmp.len().saturating_sub(1),
    );
    warnings.note("animations of the scan, which is baked at rest", usize::from(rig.is_some()));
}

/// Returns the materials that are shown, each once.
fn used(scene: &Scene) -> impl Iterator<Item = &Material> {
    let is_used = |m: &usize| scene.instances().iter().any(|instance| instance.material == *m);
    (0..scene.materials().len()).filter(is_used).map(|m| &scene.materials()[m])
}

/// Returns `true` where a scan has more than one colour: of vertices, textures or materials.
pub(super) fn has_colors(scene: &Scene) -> bool {
    let mut colors = used(scene).map(|material| material.base_color);
    let first = colors.next();
    colors.any(|color| Some(color) != first)
        || used(scene).any(|material| material.base_color_texture.is_some())
        || scene.meshes().iter().any(|mesh| !mesh.colors().is_empty())
}

/// Notes options that no map that is baked reads.
pub(super) fn unread_options(options: &BakeOptions, warnings: &mut Warnings) {
    let bakes = |any: &[MapKind]| options.bakes(any);
    let sky = bakes(&[MapKind::Occlusion, MapKind::Bent]);
    let normals = bakes(&[MapKind::Normal, MapKind::Bent]);
    let unread = [
        ("the number of rays for occlusion is not read: neither ao nor bent is baked", {
            options.ao_rays != AO_RAYS && !sky
        }),
        ("the distance of occlusion is not read: neither ao nor bent is baked", {
            options.ao_distance.is_some() && !sky
        }),
        ("the roughness is not read: no roughness is baked", {
            options.roughness.is_some() && !bakes(&[MapKind::Roughness])
        }),
        ("16 bits are not used: neither normal nor bent is baked", options.bits == 16 && !normals),
        ("object space is not used: neither normal nor bent is baked", {
            options.space == NormalSpace::Object && !normals
        }),
    ];
    unread.iter().filter(|(_, is)| *is).for_each(|(what, _)| warnings.note(*what, 1));
}

/// Notes what of a scan's material an asset made of the scan alone does not keep.
pub(super) fn left_of_scan(
    material: &Material,
    has_colors: bool,
    options: &BakeOptions,
    warnings: &mut Warnings,
) {
    let bakes = |map: MapKind| options.maps.contains(&map);
    warnings.note(
        "the scan's colours are left out; bake albedo to keep them",
        usize::from(has_colors && !bakes(MapKind::Albedo)),
    );
    let textures = [
        ("metallic-roughness", material.metallic_roughness_texture.is_some()),
        ("occlusion", material.occlusion_texture.is_some() && !bakes(MapKind::Occlusion)),
    ];
    for (what, _) in textures.iter().filter(|(_, is)| *is) {
        warnings.note(format!("the scan's {what} texture is left out"), 1);
    }
    left_of_material("scan", material, warnings);
}

/// Notes what is asked of a scan that it does not have.
pub(super) fn lacking(material: &Material, has_colors: bool, options: &BakeOptions, warnings: &mut Warnings) {
    let bakes = |map: MapKind| options.maps.contains(&map);
    warnings.note(
        "the scan has one colour alone, so the albedo map has no more",
        usize::from(bakes(MapKind::Albedo) && !has_colors),
    );
    let textured = material.metallic_roughness_texture.is_some() && options.roughness.is_none();
    warnings.note(
        "the scan's roughness texture is not read: the roughness map begins from its factor",
        usize::from(bakes(MapKind::Roughness) && textured),
    );
}

/// Notes what of a low-poly mesh's material and textures an asset does not keep.
pub(super) fn left_of_low(material: &Material, options: &BakeOptions, warnings: &mut Warnings) {
    left_of_material("low-poly mesh", material, warnings);
    let bakes = |map: MapKind| options.maps.contains(&map);
    let is_moved = |texture: &Option<TextureRef>| texture.as_ref().is_some_and(|texture| !is_plain(texture));
    let textures = [
        ("base colour", &material.base_color_texture, MapKind::Albedo),
        ("metallic-roughness", &material.metallic_roughness_texture, MapKind::Roughness),
        ("occlusion", &material.occlusion_texture, MapKind::Occlusion),
    ];
    for (what, _, _) in textures.iter().filter(|(_, texture, map)| is_moved(texture) && !bakes(*map)) {
        warnings.note(
            format!("the low-poly mesh's {what} texture is left out: it has uvs of its own, or a transform"),
            1,
        );
    }
    let has_relief = material.normal.is_some() && !bakes(MapKind::Normal);
    warnings.note(
        "the low-poly mesh's normal map is left out; bake normal in its place",
        usize::from(has_relief),
    );
}

/// Returns `true` where a texture is of uv set 0 and not moved by a transform.
pub(super) fn is_plain(texture: &TextureRef) -> bool {
    texture.uv_set == 0 && texture.transform == UvTransform::default()
}

fn left_of_material(whose: &str, material: &Material, warnings: &mut Warnings) {
    let left = [
        ("clearcoat", material.clearcoat.is_some()),
        ("sheen", material.sheen.is_some()),
        ("anisotropy", material.anisotropy.is_some()),
        ("emission", material.emissive != [0.0; 3]),
        ("transparency", material.alpha != AlphaMode::Opaque),
        ("unlit look", material.unlit),
        ("index of refraction", material.ior != 1.5),
        ("specular strength", material.specular != Specular::default()),
    ];
    for (what, _) in left.iter().filter(|(_, is)| *is) {
        warnings.note(format!("the {whose}'s {what} is left out"), 1);
    }
}
