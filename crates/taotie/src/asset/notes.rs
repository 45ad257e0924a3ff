//! Notes on things that are asked for, or are in a file, and find no place in the asset: each is told and counted.

use super::options::{AO_RAYS, BakeOptions};
use crate::bake::MapKind;
use crate::error::Warnings;
use crate::io::Loaded;
use crate::scene::{NormalSpace, TextureRef, UvTransform};

/// What a scan's file may hold that no bake reads, but a packed scan keeps.
const LEFT_OF_FILE: [&str; 3] = [
    "XMP metadata of the scan beside that of the whole asset, left out",
    "animations of the scan, which is baked at rest",
    "sets of materials (variants) of the scan, left out: it is baked without any",
];

/// Notes what a scan's file holds that no bake reads.
pub(super) fn left_of_scan_file(loaded: &mut Loaded) {
    let Loaded { warnings, xmp, rig, variants, .. } = loaded;
    let counts = [xmp.len().saturating_sub(1), usize::from(rig.is_some()), variants.names().len()];
    LEFT_OF_FILE.into_iter().zip(counts).for_each(|(what, count)| warnings.note(what, count));
}

/// Returns warnings without notes of what a packed scan keeps.
pub(super) fn of_packed_scan(warnings: &Warnings) -> Warnings {
    let mut left = Warnings::default();
    let others = warnings.iter().filter(|(what, _)| !LEFT_OF_FILE.contains(what));
    others.for_each(|(what, count)| left.note(what, count));
    left
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

/// Notes materials of a file that stays which are blended as a whole, since parts of the scan are.
pub(super) fn blended(materials: usize, warnings: &mut Warnings) {
    warnings.note(
        "materials of the low-poly mesh that are blended as a whole, since parts of the scan are: viewers may draw \
         their triangles in the wrong order",
        materials,
    );
}

/// Returns `true` where a texture is of uv set 0 and not moved by a transform.
pub(super) fn is_plain(texture: &TextureRef) -> bool {
    texture.uv_set == 0 && texture.transform == UvTransform::default()
}
