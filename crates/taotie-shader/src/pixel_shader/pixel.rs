//! The function `pixel`, which runs the stages, with lookups in the tables of directional albedos and the environment.

use crate::language::Language;
use crate::pixel::{PixelProgram, reads};
use crate::variant::{Alpha, Variant};
use taotie_engine::pixel::is_cook_torrance;
use taotie_engine::shade::dfg::{COLUMNS, ROWS};

/// The functions from incident light to the pixel.
pub(super) fn pixel(pixel: &PixelProgram, variant: &Variant, language: Language) -> String {
    let incidence = if variant.unlit { "" } else { INCIDENCE };
    let (texels, geometry) = (!pixel.fields("Texels").is_empty(), !pixel.fields("Geometry").is_empty());
    let mut text = format!("{incidence}// Linear RGB radiance to the viewer, and opacity.\n");
    text += "vec4 pixel(Interpolated i, bool front) {\n";
    text += if texels { "    Texels t = texels(i);\n" } else { "" };
    text += if geometry { "    Geometry g = geometry(i, front);\n" } else { "" };
    text += &opacity(pixel, variant);
    if variant.transmits {
        text += &format!("    float passed = {};\n", call(pixel, "passed_light"));
    }
    text += &if variant.unlit { unlit(pixel) } else { lit(pixel, variant, language) };
    let alpha = match (variant.alpha, variant.transmits) {
        (Alpha::Blend, false) => "alpha",
        (Alpha::Blend, true) => "alpha * (1.0 - passed)",
        (_, false) => "1.0",
        (_, true) => "1.0 - passed",
    };
    // Blending multiplies by the opacity, but reflections keep their strength.
    let radiance = if variant.transmits { "radiance / (1.0 - passed)" } else { "radiance" };
    text + &format!("    return vec4({radiance}, {alpha});\n}}\n")
}

fn opacity(pixel: &PixelProgram, variant: &Variant) -> String {
    let alpha = || format!("    float alpha = {};\n", call(pixel, "opacity"));
    match variant.alpha {
        Alpha::Opaque => String::new(),
        Alpha::Blend => alpha(),
        Alpha::Mask => alpha() + "    if (alpha < material.cutoff) {\n        discard;\n    }\n",
    }
}

fn unlit(pixel: &PixelProgram) -> String {
    format!("    vec3 radiance = {};\n", call(pixel, "unlit_color"))
}

fn lit(pixel: &PixelProgram, variant: &Variant, language: Language) -> String {
    let table = i32::from(is_cook_torrance(variant.shading));
    let mut text = String::new();
    text += &declared(pixel, "shading_frame", "ShadingFrame f");
    text += &declared(pixel, "material_values", "MaterialValues m");
    for (argument, stage, table) in
        [("dfg", "albedo_position", table), ("coat_dfg", "coat_albedo_position", 0)]
    {
        if reads(&pixel.read, argument) {
            text += &format!("    Dfg {argument} = albedos({}, {table});\n", call(pixel, stage));
        }
    }
    if reads(&pixel.read, "sheen_table") {
        text += &format!("    float sheen_table = sheen_entry({});\n", call(pixel, "sheen_albedo_position"));
    }
    text += &declared(pixel, "surface_point", "SurfacePoint p");
    text += &format!("    mut vec3 radiance = {};\n", call(pixel, "own_radiance"));
    if variant.environment {
        text += &reflected_environment(pixel);
    }
    let lights = lights(pixel, variant);
    text + &match language {
        Language::Wgsl => lights,
        Language::GlslEs => format!(
            "#ifdef {HOST_LIGHTS}\n    radiance += host_lights(p, i.position);\n#else\n{lights}#endif\n"
        ),
    }
}

/// The macro by which a host of GLSL ES replaces the block of lights with its function `host_lights`.
pub(super) const HOST_LIGHTS: &str = "HOST_LIGHTS";

fn reflected_environment(pixel: &PixelProgram) -> String {
    let texels = reads(&pixel.read, "e");
    let looked_up = if texels { "    EnvironmentTexels e = environment_texels(p);\n" } else { "" };
    format!("{looked_up}    radiance += {};\n", call(pixel, "reflect_environment"))
}

fn lights(pixel: &PixelProgram, variant: &Variant) -> String {
    let shadow = if variant.shadows { " * visibility(index, i.position, g.n_geom)" } else { "" };
    format!(
        "    for (int index = 0; index < int(frame.light_count); index++) {{\n        \
         Incidence arriving = incidence(lights[index], i.position);\n        \
         radiance += {} * arriving.irradiance{shadow};\n    }}\n",
        call(pixel, "reflect_light")
    )
}

/// The declaration of a stage's result; empty if nothing needs it.
fn declared(pixel: &PixelProgram, stage: &str, what: &str) -> String {
    match pixel.program().find(stage) {
        Some(_) => format!("    {what} = {};\n", call(pixel, stage)),
        None => String::new(),
    }
}

/// The call of a stage, with its arguments.
fn call(pixel: &PixelProgram, stage: &str) -> String {
    let parameters =
        pixel.program().find(stage).map(|formula| formula.graph.parameters()).unwrap_or_default();
    let mut arguments: Vec<&str> = Vec::new();
    for parameter in parameters {
        let argument = match parameter.path.split('.').next() {
            Some("u") => "material",
            Some("ambient") => "frame.ambient",
            Some("l") => "arriving.l",
            Some(argument) => argument,
            None => continue,
        };
        if !arguments.contains(&argument) {
            arguments.push(argument);
        }
    }
    format!("{stage}({})", arguments.join(", "))
}

const INCIDENCE: &str = "// The incident light at a position.
Incidence incidence(Light light, vec3 position) {
    if (light.kind == 0.0) {
        return Incidence(light.place, light.color);
    }
    if (light.kind == 1.0) {
        return incidence_without_falloff(light, position);
    }
    return incidence_with_falloff(light, position);
}

";

/// Returns true if a stage reads the tables of directional albedos.
pub(super) fn reads_tables(pixel: &PixelProgram) -> bool {
    ["dfg", "coat_dfg", "sheen_table"].iter().any(|argument| reads(&pixel.read, argument))
}

/// The meaning of the texture of the tables.
pub(super) const TABLES: &str = "Directional albedos, 64 texels of four 32-bit floats a row: 48 rows of GGX, 48 of Cook-Torrance, 48 of sheen in red.";

/// The functions that read the tables of directional albedos.
pub(super) fn tables(pixel: &PixelProgram) -> String {
    let (lobe, sheen) =
        (reads(&pixel.read, "dfg") || reads(&pixel.read, "coat_dfg"), reads(&pixel.read, "sheen_table"));
    if !lobe && !sheen {
        return String::new();
    }
    let mut text = format!(
        "// The texel of a table's node: table 0 is for GGX, 1 for Cook-Torrance, 2 for sheen.\n\
         ivec2 table_texel(TablePosition q, int table) {{\n    \
         int node = int(q.node);\n    \
         return ivec2(node % {COLUMNS}, node / {COLUMNS} + {ROWS} * table);\n}}\n"
    );
    if lobe {
        text += &albedos(&pixel.fields("Dfg"));
    }
    if sheen {
        text +=
            &format!("{SHEEN}{FOUR}    return between_entries(a.r, b.r, c.r, d.r, q.across, q.down);\n}}\n");
    }
    text
}

/// Reads the entries of the lobe's fields, one per channel, in order.
fn albedos(fields: &[&str]) -> String {
    let channel = |field: &str| match field {
        "scale" => "r",
        "bias" => "g",
        "edge" => "b",
        _ => "a",
    };
    let entry = |field: &&str| {
        let c = channel(field);
        format!("between_entries(a.{c}, b.{c}, c.{c}, d.{c}, q.across, q.down)")
    };
    let entries: Vec<String> = fields.iter().map(entry).collect();
    format!("{ALBEDOS}{FOUR}    return Dfg(\n        {}\n    );\n}}\n", entries.join(",\n        "))
}

const ALBEDOS: &str = "
// The directional albedos of a lobe.
Dfg albedos(TablePosition q, int table) {
    ivec2 at = table_texel(q, table);
";

const SHEEN: &str = "
// The fraction of light that white sheen reflects.
float sheen_entry(TablePosition q) {
    ivec2 at = table_texel(q, 2);
";

/// The texels around a position in a table.
const FOUR: &str = "    vec4 a = texelFetch(albedo_tables, at, 0);
    vec4 b = texelFetch(albedo_tables, at + ivec2(1, 0), 0);
    vec4 c = texelFetch(albedo_tables, at + ivec2(0, 1), 0);
    vec4 d = texelFetch(albedo_tables, at + ivec2(1, 1), 0);
";

/// The functions that look up the environment; the last is `environment_texels`.
pub(super) fn environment(pixel: &PixelProgram) -> String {
    let fields = pixel.fields("EnvironmentTexels");
    if fields.is_empty() {
        return String::new();
    }
    let gathers = fields.iter().any(|field| *field != "mean");
    let values: Vec<&str> = fields.iter().map(|field| light(field)).collect();
    let gathering = if gathers { GATHERED } else { "" };
    let mean = if fields.contains(&"mean") { MEAN } else { "" };
    format!(
        "{LEVEL}{gathering}{mean}\n// The light from the environment at the point.\n\
         EnvironmentTexels environment_texels(SurfacePoint p) {{\n{}    return EnvironmentTexels({});\n}}\n",
        highlights(&fields, pixel),
        values.join(", ")
    )
}

/// The declarations of the highlights to gather.
fn highlights(fields: &[&str], pixel: &PixelProgram) -> String {
    let mut text = String::new();
    for (field, stage) in [("specular", "highlight"), ("coat", "coat_highlight")] {
        if fields.contains(&field) && pixel.program().find(stage).is_some() {
            text += &format!("    Highlight {field} = {stage}(p);\n");
        }
    }
    text
}

fn light(field: &str) -> &'static str {
    match field {
        "specular" => "gathered(specular.direction, specular.roughness)",
        "mean" => "mean_light(p.n)",
        _ => "gathered(coat.direction, coat.roughness)",
    }
}

const LEVEL: &str = "// The direction in the environment's local space.
vec3 environment_direction(vec3 world) {
    return to_environment(frame.environment_sin, frame.environment_cos, world);
}

// The light of a level. `map`: the origin of its map in the atlas, texels across without the border, and its factor.
vec3 level_light(int level, MapPlace place) {
    vec4 map = environment_levels[level];
    Taps x = octahedral_taps(place.u, map.z);
    Taps y = octahedral_taps(place.v, map.z);
    ivec2 at = ivec2(int(map.x + x.first), int(map.y + y.first));
    vec3 a = texelFetch(environment_maps, at, 0).rgb;
    vec3 b = texelFetch(environment_maps, at + ivec2(1, 0), 0).rgb;
    vec3 c = texelFetch(environment_maps, at + ivec2(0, 1), 0).rgb;
    vec3 d = texelFetch(environment_maps, at + ivec2(1, 1), 0).rgb;
    return bilinear(a, b, c, d, x.share, y.share) * map.w;
}
";

const MEAN: &str = "
// The irradiance divided by π at a normal: the roughest level, whose lobe is the cosine.
vec3 mean_light(vec3 n) {
    MapPlace place = octahedral_place(environment_direction(n));
    return level_light(int(frame.environment_levels) - 1, place) * frame.environment_intensity;
}
";

const GATHERED: &str = "
// The angle of (x, y) from the x axis; 0 if both are 0.
float angle_of(float y, float x) {
    if (x == 0.0 && y == 0.0) {
        return 0.0;
    }
    return atan(y, x);
}

// The radiance from a direction in the environment's local space, from the unfiltered image.
vec3 picture_light(vec3 direction) {
    vec2 size = vec2(textureSize(environment_picture, 0));
    float azimuth = angle_of(direction.z, direction.x);
    float polar = angle_of(length(direction.xz), direction.y);
    PicturePosition at = picture_position(azimuth, polar, size.x, size.y);
    ivec2 low = ivec2(int(at.left), int(at.top));
    ivec2 high = ivec2(int(at.right), int(at.bottom));
    vec3 a = texelFetch(environment_picture, low, 0).rgb;
    vec3 b = texelFetch(environment_picture, ivec2(high.x, low.y), 0).rgb;
    vec3 c = texelFetch(environment_picture, ivec2(low.x, high.y), 0).rgb;
    vec3 d = texelFetch(environment_picture, high, 0).rgb;
    return bilinear(a, b, c, d, at.across, at.down) * environment_levels[31].w;
}

// The radiance that a rough mirror gathers around a direction.
vec3 gathered(vec3 world, float roughness) {
    vec3 direction = environment_direction(world);
    MapPlace place = octahedral_place(direction);
    LevelPosition position = level_position(roughness);
    if (position.below < 0.0) {
        float share = share_of_smoothest(roughness, frame.smoothest_alpha);
        return mixed(picture_light(direction), level_light(0, place), share) * frame.environment_intensity;
    }
    int last = int(frame.environment_levels) - 1;
    vec3 below = level_light(min(int(position.below), last), place);
    vec3 above = level_light(min(int(position.below) + 1, last), place);
    return mixed(below, above, position.share) * frame.environment_intensity;
}
";
