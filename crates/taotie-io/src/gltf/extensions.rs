//! The supported extensions.

use gltf::json::mesh::Primitive;
use gltf::json::{Root, Value};
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::scene::LAYERS;

/// The extension of Draco-compressed primitives.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// The extension that shows a node's mesh several times.
pub(crate) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The glTF extensions that are read: first those of layers.
pub const GLTF_EXTENSIONS: [&str; LAYERS.len() + OTHERS.len()] = {
    let (mut all, mut i) = ([""; LAYERS.len() + OTHERS.len()], 0);
    while i < all.len() {
        all[i] = if i < LAYERS.len() { LAYERS[i].extension } else { OTHERS[i - LAYERS.len()] };
        i += 1;
    }
    all
};

/// Those that are not layers of materials.
const OTHERS: [&str; 14] = [
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_variants",
    INSTANCING,
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    DRACO,
];

/// Extensions that give a texture an alternative image, in order of preference.
pub(crate) const OF_TEXTURES: [&str; 3] = ["EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu"];

/// Extensions that do not affect an image with the default materials: the finest level of detail is drawn, and the
/// channels of KHR_animation_pointer are skipped with a separate warning.
const WITHOUT_EFFECT: [&str; 4] = ["KHR_xmp", "KHR_xmp_json_ld", "KHR_animation_pointer", "MSFT_lod"];

/// Layers that are kept in written files, but not drawn.
const NOT_DRAWN: [&str; 3] =
    ["KHR_materials_volume", "KHR_materials_iridescence", "KHR_materials_dispersion"];

/// Returns `true` if an extension is supported, or has no effect.
pub(crate) fn is_known(name: &str) -> bool {
    GLTF_EXTENSIONS.contains(&name) || WITHOUT_EFFECT.contains(&name)
}

/// Returns the JSON of an extension that the parser does not know.
pub(super) fn extension<'a>(primitive: &'a Primitive, name: &str) -> Option<&'a Value> {
    primitive.extensions.as_ref()?.others.get(name)
}

/// Returns the extension and the feature that reads it, if this build lacks that feature.
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

/// Rejects a file that requires unsupported extensions, and notes those that it merely uses.
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
        warnings.note(format!("ignored extension {name}; the crate feature `{feature}` supports it"), 1);
    }
    for name in root.extensions_used.iter().filter(|name| NOT_DRAWN.contains(&name.as_str())) {
        warnings.note(format!("{name} is kept, but not drawn"), 1);
    }
    for name in root.extensions_used.iter().filter(|name| !known(name)) {
        warnings.note(format!("ignored extension {name}"), 1);
    }
    Ok(())
}
