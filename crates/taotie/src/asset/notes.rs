//! Notes on requested things and file contents that the asset cannot include: each is reported and counted.

use super::options::{AO_RAYS, BakeOptions};
use crate::bake::MapKind;
use crate::error::Warnings;
use crate::io::Loaded;
use crate::scene::{NormalSpace, TextureRef, UvTransform};

/// Contents of a scan's file that no bake reads, but that a packed scan keeps.
const LEFT_OF_FILE: [&str; 3] = [
    "XMP metadata of the scan other than the whole asset's, left out",
    "animations of the scan, which is baked at rest",
    "material variants of the scan, left out: it is baked without any",
];

/// Notes the contents of a scan's file that no bake reads.
pub(super) fn left_of_scan_file(loaded: &mut Loaded) {
    let Loaded { warnings, xmp, rig, variants, .. } = loaded;
    let counts = [xmp.len().saturating_sub(1), usize::from(rig.is_some()), variants.names().len()];
    LEFT_OF_FILE.into_iter().zip(counts).for_each(|(what, count)| warnings.note(what, count));
}

/// Returns the warnings except those about contents that a packed scan keeps.
pub(super) fn of_packed_scan(warnings: &Warnings) -> Warnings {
    let mut left = Warnings::default();
    let others = warnings.iter().filter(|(what, _)| !LEFT_OF_FILE.contains(what));
    others.for_each(|(what, count)| left.note(what, count));
    left
}

/// Notes options that affect none of the baked maps.
pub(super) fn unread_options(options: &BakeOptions, warnings: &mut Warnings) {
    let bakes = |any: &[MapKind]| options.bakes(any);
    let sky = bakes(&[MapKind::Occlusion, MapKind::Bent]);
    let normals = bakes(&[MapKind::Normal, MapKind::Bent]);
    let unread = [
        ("the number of occlusion rays has no effect: neither ao nor bent is baked", {
            options.ao_rays != AO_RAYS && !sky
        }),
        ("the distance of occlusion has no effect: neither ao nor bent is baked", {
            options.ao_distance.is_some() && !sky
        }),
        ("the roughness has no effect: no roughness is baked", {
            options.roughness.is_some() && !bakes(&[MapKind::Roughness])
        }),
        ("16 bits have no effect: neither normal nor bent is baked", options.bits == 16 && !normals),
        ("object space has no effect: neither normal nor bent is baked", {
            options.space == NormalSpace::Object && !normals
        }),
    ];
    unread.iter().filter(|(_, is)| *is).for_each(|(what, _)| warnings.note(*what, 1));
}

/// Notes materials of a kept file that are blended as a whole because parts of the scan are.
pub(super) fn blended(materials: usize, warnings: &mut Warnings) {
    warnings.note(
        "materials of the low-poly mesh blended as a whole because parts of the scan are: viewers may draw \
         their triangles in the wrong order",
        materials,
    );
}

/// Returns `true` if a texture uses uv set 0 without a transform.
pub(super) fn is_plain(texture: &TextureRef) -> bool {
    texture.uv_set == 0 && texture.transform == UvTransform::default()
}
