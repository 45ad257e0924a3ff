//! The functions that fetch the inputs of the stages: textures and vertex values, and the geometry of a point from the
//! interpolated values and their changes to the next pixels.

use crate::factors::transform_names;
use crate::pixel::{PixelProgram, texel_source};
use crate::variant::{Placement, Variant};
use std::collections::BTreeSet;
use taotie_engine::scene::TextureRole;

/// The textures read by the stages, in the order of bindings.
pub(super) fn textures(pixel: &PixelProgram, variant: &Variant) -> Vec<(TextureRole, Placement)> {
    let fields = pixel.fields("Texels");
    let roles: BTreeSet<TextureRole> =
        fields.iter().filter_map(|field| texel_source(field, variant)).map(|(role, _)| role).collect();
    roles.into_iter().filter_map(|role| Some((role, variant.texture(role)?))).collect()
}

/// The functions that read textures; empty if no stage reads any.
pub(super) fn fetches(pixel: &PixelProgram, variant: &Variant) -> String {
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
    let values: Vec<String> = fields.iter().map(|field| texel_value(field, variant)).collect();
    text + &format!("    return Texels({});\n}}\n", values.join(", "))
}

fn texel_value(field: &str, variant: &Variant) -> String {
    match (field, texel_source(field, variant)) {
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

/// The function `geometry`; empty if no stage reads it.
pub(super) fn geometry(pixel: &PixelProgram) -> String {
    let fields = pixel.fields("Geometry");
    if fields.is_empty() {
        return String::new();
    }
    let values: Vec<&str> = fields.iter().map(|field| geometry_value(field)).collect();
    let takes_height = fields.iter().any(|field| field.starts_with("du_") || field.starts_with("dv_"));
    let height = if takes_height { "    Coordinates height = height_coordinates(i);\n" } else { "" };
    let facing = if fields.contains(&"facing") { FACING } else { "" };
    format!("{VIEWER}{facing}{height}    return Geometry({});\n}}\n", values.join(", "))
}

/// The value of a field; changes are to the next sample.
fn geometry_value(field: &str) -> &'static str {
    match field {
        "n_geom" => "n_geom",
        "normal" => "i.normal",
        "normal_dx" => "dFdx(i.normal) * frame.spacing",
        "normal_dy" => "dFdy(i.normal) * frame.spacing",
        "tangent" => "i.tangent",
        "handedness" => "i.handedness",
        "facing" => "facing",
        "v" => "v",
        "position_dx" => "position_dx * frame.spacing",
        "position_dy" => "position_dy * frame.spacing",
        "du_dx" => "height.d_x.x",
        "dv_dx" => "height.d_x.y",
        "du_dy" => "height.d_y.x",
        "dv_dy" => "height.d_y.y",
        "height_width" => "vec2(textureSize(height_texture, 0)).x",
        _ => "0.0",
    }
}

/// Written before the structure's fields are put together.
const VIEWER: &str = "// The unit direction to the viewer.
vec3 direction_to_viewer(vec3 position, vec3 fallback) {
    if (frame.eye.w == 0.0) {
        return frame.eye.xyz;
    }
    return normalize_or(frame.eye.xyz - position, fallback);
}

// The geometry of the point. The triangle's normal is that of the plane in which the position changes.
Geometry geometry(Interpolated i, bool front) {
    vec3 position_dx = dFdx(i.position);
    vec3 position_dy = dFdy(i.position);
    vec3 facet = normalize_or(cross(position_dx, position_dy), vec3(0.0, 0.0, 1.0));
    vec3 v = direction_to_viewer(i.position, facet);
    mut vec3 n_geom = facet;
    if (dot(facet, v) < 0.0) {
        n_geom = -facet;
    }
";

const FACING: &str = "    mut float facing = 1.0;
    if (!front) {
        facing = -1.0;
    }
";
