//! The function `pixel`, which runs the stages.

use crate::pixel::{PixelProgram, reads};
use crate::variant::{Alpha, Variant};
use taotie_engine::pixel::is_cook_torrance;

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

/// The functions from incident light to the pixel.
pub(crate) fn pixel(pixel: &PixelProgram, variant: &Variant) -> String {
    let incidence = if variant.unlit { "" } else { INCIDENCE };
    let (texels, geometry) = (!pixel.fields("Texels").is_empty(), !pixel.fields("Geometry").is_empty());
    let mut text = format!("{incidence}// Linear RGB radiance to the viewer, and opacity.\n");
    text += "vec4 pixel(Interpolated i, bool front) {\n";
    text += if texels { "    Texels t = texels(i);\n" } else { "" };
    text += if geometry { "    Geometry g = geometry(i, front);\n" } else { "" };
    text += &opacity(pixel, variant);
    text += &if variant.unlit { unlit(pixel) } else { lit(pixel, variant) };
    let alpha = if variant.alpha == Alpha::Blend { "alpha" } else { "1.0" };
    text + &format!("    return vec4(radiance, {alpha});\n}}\n")
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

fn lit(pixel: &PixelProgram, variant: &Variant) -> String {
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
        text += &environment(pixel);
    }
    text + &lights(pixel, variant)
}

fn environment(pixel: &PixelProgram) -> String {
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
