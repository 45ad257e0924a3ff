//! The extensions of a file that are understood.

use crate::error::{Error, Result, Warnings};
use gltf::json::mesh::Primitive;
use gltf::json::{Root, Value};
use std::path::Path;

/// The extension of primitives that Draco compresses.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// Extensions of glTF whose meaning is drawn.
pub const SUPPORTED: [&str; 17] = [
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_clearcoat",
    "KHR_materials_anisotropy",
    "KHR_materials_sheen",
    "KHR_materials_variants",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    DRACO,
];

/// Extensions that give a texture another image than its own, the one that is believed most first.
pub(in crate::io) const OF_TEXTURES: [&str; 3] =
    ["EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu"];

/// Extensions that do not change an image with the default materials: of levels of detail the finest is drawn, and
/// the channels of KHR_animation_pointer are left out with a separate warning.
const WITHOUT_EFFECT: [&str; 4] = ["KHR_xmp", "KHR_xmp_json_ld", "KHR_animation_pointer", "MSFT_lod"];

/// Says whether an extension is understood, or changes nothing.
pub(in crate::io) fn is_known(name: &str) -> bool {
    SUPPORTED.contains(&name) || WITHOUT_EFFECT.contains(&name)
}

/// The JSON of an extension that the parser does not know.
pub(super) fn extension<'a>(primitive: &'a Primitive, name: &str) -> Option<&'a Value> {
    primitive.extensions.as_ref()?.others.get(name)
}

/// The extension and the feature that reads it, where this build lacks that.
fn lacking(name: &str) -> Option<(&'static str, &'static str)> {
    let features = [
        (DRACO, "draco", cfg!(feature = "draco")),
        ("KHR_texture_basisu", "basis", cfg!(feature = "basis")),
        ("EXT_texture_avif", "avif", cfg!(feature = "avif")),
        ("EXT_texture_webp", "webp", cfg!(feature = "webp")),
    ];
    let found = features.into_iter().find(|(extension, _, there)| *extension == name && !there);
    found.map(|(extension, feature, _)| (extension, feature))
}

/// Refuses a file that requires extensions that are not understood, and notes those that it merely uses.
pub(super) fn check_extensions(path: &Path, root: &Root, warnings: &mut Warnings) -> Result<()> {
    let known = |name: &&String| is_known(name);
    if let Some(name) = root.extensions_required.iter().find(|name| !known(name)) {
        return Err(Error::unsupported(
            format!("{}: the required extension {name}", path.display()),
            "save the model without it",
        ));
    }
    if let Some((name, feature)) = root.extensions_required.iter().find_map(|name| lacking(name)) {
        return Err(Error::needs_feature(
            format!("{}: the required extension {name}", path.display()),
            feature,
        ));
    }
    for (name, feature) in root.extensions_used.iter().filter_map(|name| lacking(name)) {
        warnings.note(
            format!("the extension {name} is ignored; the feature `{feature}` of the crate reads it"),
            1,
        );
    }
    for name in root.extensions_used.iter().filter(|name| !known(name)) {
        warnings.note(format!("the extension {name} is ignored"), 1);
    }
    Ok(())
}
