//! The functions that read textures.

use crate::factors::transform_names;
use crate::pixel::PixelProgram;
use crate::variant::{Placement, Variant};
use std::collections::BTreeSet;
use taotie_engine::scene::TextureRole;

const COORDINATES: &str = "// The uv in a texture, and its changes to the next samples.
Coordinates coordinates(vec2 uv) {
    return Coordinates(uv, dFdx(uv) * frame.spacing, dFdy(uv) * frame.spacing);
}

// The log2 of the number of finest-level texels that a pixel covers, for a texture of this size.
float level_of(Coordinates at, vec2 size) {
    return log2_texels(at.d_x.x, at.d_x.y, at.d_y.x, at.d_y.y, size.x, size.y);
}

// A texture at these coordinates.
vec4 texel(sampler2D map, Coordinates at) {
    return textureLod(map, at.uv, level_of(at, vec2(textureSize(map, 0))));
}
";

const TRANSFORMED: &str = "
// The uv, or its change, under the linear part of a transform, row by row.
vec2 turned_uv(vec4 rows, vec2 uv) {
    return vec2(turned(rows.x, rows.y, uv.x, uv.y), turned(rows.z, rows.w, uv.x, uv.y));
}

// The coordinates under a texture's transform.
Coordinates transformed(Coordinates at, vec4 rows, vec2 offset) {
    return Coordinates(turned_uv(rows, at.uv) + offset, turned_uv(rows, at.d_x), turned_uv(rows, at.d_y));
}
";

const HEIGHT: &str = "
// The derivatives of the height by u and v: central differences, one texel of the current level to each side.
vec2 height_slopes(Coordinates at) {
    vec2 size = vec2(textureSize(height_texture, 0));
    float level = level_of(at, size);
    float texels = exp2(clamp(level, 0.0, material.height_last_level));
    vec2 u = vec2(height_step(texels, size.x), 0.0);
    vec2 v = vec2(0.0, height_step(texels, size.y));
    float right = textureLod(height_texture, at.uv + u, level).r;
    float left = textureLod(height_texture, at.uv - u, level).r;
    float below = textureLod(height_texture, at.uv + v, level).r;
    float above = textureLod(height_texture, at.uv - v, level).r;
    return vec2(height_derivative(right, left, u.x), height_derivative(below, above, v.y));
}
";

/// The texture and channels of a field of `Texels`; `None` for values from vertices.
fn source(field: &str, variant: &Variant) -> Option<(TextureRole, &'static str)> {
    use TextureRole as Role;
    Some(match field {
        "base_color" => (Role::BaseColor, "rgb"),
        "alpha" => (Role::BaseColor, "a"),
        "roughness" => (Role::MetallicRoughness, "g"),
        "metallic" => (Role::MetallicRoughness, "b"),
        "occlusion" if variant.packed_occlusion => (Role::MetallicRoughness, "r"),
        "occlusion" => (Role::Occlusion, "r"),
        "emissive" => (Role::Emissive, "rgb"),
        "normal" => (Role::Normal, "rgb"),
        "normal_variance" => (Role::Normal, "a"),
        "height_du" => (Role::Height, "x"),
        "height_dv" => (Role::Height, "y"),
        "specular" => (Role::Specular, "a"),
        "specular_color" => (Role::SpecularColor, "rgb"),
        "clearcoat" => (Role::Clearcoat, "r"),
        "clearcoat_roughness" => (Role::ClearcoatRoughness, "g"),
        "clearcoat_normal" => (Role::ClearcoatNormal, "rgb"),
        "clearcoat_variance" => (Role::ClearcoatNormal, "a"),
        "sheen_color" => (Role::SheenColor, "rgb"),
        "sheen_roughness" => (Role::SheenRoughness, "a"),
        "anisotropy" => (Role::Anisotropy, "b"),
        "anisotropy_red" => (Role::Anisotropy, "r"),
        "anisotropy_green" => (Role::Anisotropy, "g"),
        _ => return None,
    })
}

/// The textures read by the stages, in the order of bindings.
pub(crate) fn textures(pixel: &PixelProgram, variant: &Variant) -> Vec<(TextureRole, Placement)> {
    let fields = pixel.fields("Texels");
    let roles: BTreeSet<TextureRole> =
        fields.iter().filter_map(|field| source(field, variant)).map(|(role, _)| role).collect();
    roles.into_iter().filter_map(|role| Some((role, variant.texture(role)?))).collect()
}

/// The name of a texel.
fn local(role: TextureRole) -> &'static str {
    role.name().trim_end_matches("_texture")
}

/// The coordinates of a texture; `sets` are already declared by their names.
fn coordinates(role: TextureRole, placement: Placement) -> String {
    let plain = match placement.uv_set {
        Some(set) => format!("uv{set}"),
        None => "Coordinates(vec2(0.0), vec2(0.0), vec2(0.0))".into(),
    };
    let [rows, offset] = transform_names(role);
    if placement.transformed {
        format!("transformed({plain}, material.{rows}, material.{offset})")
    } else {
        plain
    }
}

/// The declarations of the coordinates of uv sets.
fn uv_sets(textures: &[(TextureRole, Placement)]) -> String {
    let sets: BTreeSet<usize> = textures.iter().filter_map(|(_, placement)| placement.uv_set).collect();
    sets.iter().map(|set| format!("    Coordinates uv{set} = coordinates(i.uv{set});\n")).collect()
}

/// The functions that read textures; empty if no stage reads any.
pub(crate) fn fetches(pixel: &PixelProgram, variant: &Variant) -> String {
    let (fields, textures) = (pixel.fields("Texels"), textures(pixel, variant));
    if fields.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    if !textures.is_empty() {
        text += COORDINATES;
        text += if textures.iter().any(|(_, placement)| placement.transformed) { TRANSFORMED } else { "" };
        text += &height(&textures);
        text += "\n";
    }
    text += "// The texture and vertex values at the point.\nTexels texels(Interpolated i) {\n";
    text += &uv_sets(&textures);
    for (role, placement) in &textures {
        text += &match role {
            TextureRole::Height => "    vec2 height = height_slopes(height_coordinates(i));\n".to_owned(),
            role => {
                let at = coordinates(*role, *placement);
                format!("    vec4 {} = texel({}, {at});\n", local(*role), role.name())
            }
        };
    }
    let values: Vec<String> = fields.iter().map(|field| value(field, variant)).collect();
    text + &format!("    return Texels({});\n}}\n", values.join(", "))
}

fn value(field: &str, variant: &Variant) -> String {
    match (field, source(field, variant)) {
        (_, Some((role, channels))) => format!("{}.{channels}", local(role)),
        ("color", None) => "i.color.rgb".into(),
        (_, None) => "i.color.a".into(),
    }
}

/// The functions of a height map.
fn height(textures: &[(TextureRole, Placement)]) -> String {
    let Some((role, placement)) = textures.iter().find(|(role, _)| *role == TextureRole::Height) else {
        return String::new();
    };
    let set = uv_sets(&[(*role, *placement)]);
    let at = coordinates(*role, *placement);
    let placed = format!(
        "\n// The coordinates of the height map.\n\
         Coordinates height_coordinates(Interpolated i) {{\n{set}    return {at};\n}}\n"
    );
    placed + HEIGHT
}
