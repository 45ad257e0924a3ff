//! A whole pixel of a surface as a shader: the recorded stages, and the text that joins them.

mod bindings;
mod fetch;
mod pixel;

use crate::interface::Interface;
use crate::language::{Language, translated};
use crate::pixel::PixelProgram;
use crate::program::Formula;
use crate::shader::{commented, has_structure, written_formulas, written_structure};
use crate::variant::Variant;
use bindings::{
    HEADER_GLSL, bindings, entry_points, frame_structure, interface, interpolated, material_structure,
    vertex_glsl,
};
use pixel::HOST_LIGHTS;
use taotie_engine::names::Named;

/// A whole pixel shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PixelShader {
    /// The source text: in WGSL with `vertex_main` and `fragment_main`, in GLSL ES the fragment shader.
    pub text: String,
    /// The vertex shader in GLSL ES; `None` in WGSL, whose vertex shader is part of `text`.
    pub vertex_text: Option<String>,
    /// The inputs that its host binds.
    pub interface: Interface,
}

/// Writes the shader of a variant, from interpolated vertices to linear RGB radiance and alpha.
///
/// The formulas are recordings of `taotie_engine::pixel`; only the code that joins them is separate text. With
/// [`VariantOptions::shadows`](crate::VariantOptions::shadows) the text calls a function `visibility` that the host
/// adds: the visible fraction of light number `light` (an `i32` or `int`) at `position`; `n` is the triangle's
/// normal.
///
/// In GLSL ES a host may define `HOST_LIGHTS`: then there is no block of lights, and the text calls a function that the
/// host adds, `vec3 host_lights(SurfacePoint p, vec3 position)`. It returns the radiance from all of its lights, with
/// shadows, as the sum of `reflect_light` times irradiance.
///
/// ```
/// use taotie_engine::scene::Material;
/// use taotie_shader::{Language, Variant, VariantOptions, pixel_shader};
///
/// let variant = Variant::new(&Material::default(), &VariantOptions::default());
/// let shader = pixel_shader(&variant, Language::Wgsl);
/// assert!(shader.text.contains("fn fragment_main("));
/// ```
pub fn pixel_shader(variant: &Variant, language: Language) -> PixelShader {
    let program = PixelProgram::new(variant);
    let interface = interface(&program, variant);
    let glue = glue(&program, variant, language);
    let formulas = needed(&program, &glue);
    let pieces = [
        header(variant, language),
        structures(&program, &formulas, &glue, language),
        frame_structure(&interface, language),
        material_structure(&interface, language),
        bindings(&interface, language),
        interpolated(&interface, language),
        written_formulas(&formulas, program.program(), language).join("\n"),
        prototypes(variant, language),
        translated(&glue, language),
        entry_points(&interface, language),
    ];
    let text = wrapped(&joined(&pieces));
    let vertex_text = (language == Language::GlslEs).then(|| vertex_glsl(&interface));
    PixelShader { text, vertex_text, interface }
}

/// The text that joins the recorded functions.
fn glue(program: &PixelProgram, variant: &Variant, language: Language) -> String {
    let pieces = [
        fetch::fetches(program, variant),
        fetch::geometry(program),
        pixel::tables(program),
        pixel::environment(program),
        pixel::pixel(program, variant, language),
    ];
    joined(&pieces)
}

/// Joins the pieces that are not empty with blank lines.
fn joined(pieces: &[String]) -> String {
    let pieces: Vec<&str> = pieces.iter().map(String::as_str).filter(|piece| !piece.is_empty()).collect();
    pieces.join("\n")
}

/// The functions called by the glue, and all that they call in turn.
fn needed<'p>(program: &'p PixelProgram, glue: &str) -> Vec<&'p Formula> {
    let formulas = program.program().formulas();
    let is_called = |name: &str| {
        glue.match_indices(&format!("{name}("))
            .any(|(at, _)| !glue[..at].ends_with(|before: char| before.is_alphanumeric() || before == '_'))
    };
    let names: Vec<&str> =
        formulas.iter().map(|formula| formula.name.as_str()).filter(|name| is_called(name)).collect();
    program.program().needed(&names)
}

/// The structures passed by functions and glue.
fn structures(program: &PixelProgram, formulas: &[&Formula], glue: &str, language: Language) -> String {
    let all = program.program().structures.iter();
    let is_used = |name: &str| glue.contains(&format!("{name} ")) || glue.contains(&format!("{name}("));
    let used = all.filter(|structure| {
        structure.name != "MaterialUniforms"
            && (is_used(structure.name) || formulas.iter().any(|formula| has_structure(formula, structure)))
    });
    let mut written: Vec<String> = used.map(|structure| written_structure(structure, language)).collect();
    if is_used("Coordinates") {
        written.push(coordinates(language));
    }
    written.join("\n")
}

/// The structure of texture coordinates.
fn coordinates(language: Language) -> String {
    match language {
        Language::Wgsl => format!("{COORDINATES}    uv: vec2f,\n    d_x: vec2f,\n    d_y: vec2f,\n}}\n"),
        Language::GlslEs => format!("{COORDINATES}    vec2 uv;\n    vec2 d_x;\n    vec2 d_y;\n}};\n"),
    }
}

const COORDINATES: &str = "// Texture coordinates, and their changes to the next samples to the right and above or below.\n\
     struct Coordinates {\n";

fn header(variant: &Variant, language: Language) -> String {
    let comment = format!(
        "A surface with the reflectance model `{}`, generated by Taotie from the formulas that it renders with.\n\
         Directions are unit vectors that leave the surface, in world space; colours are linear RGB; cosines are of\n\
         angles between directions; distributions are in sr⁻¹; lengths are in model units.",
        variant.shading.name()
    );
    match language {
        Language::Wgsl => commented(&comment, ""),
        Language::GlslEs => format!("{HEADER_GLSL}\n{}", commented(&comment, "")),
    }
}

/// The declarations of the host's functions, which GLSL ES requires.
fn prototypes(variant: &Variant, language: Language) -> String {
    if variant.unlit || language == Language::Wgsl {
        return String::new();
    }
    let visibility = if variant.shadows { VISIBILITY } else { "" };
    format!("#ifdef {HOST_LIGHTS}\n{LIGHTS}#endif\n{visibility}")
}

const LIGHTS: &str = "// Linear RGB radiance to the viewer from the host's lights at a position; written by the host.\n\
     vec3 host_lights(SurfacePoint p, vec3 position);\n";

const VISIBILITY: &str = "// The visible fraction of a light at a position, [0, 1]; written by the host.\n\
     float visibility(int light, vec3 position, vec3 n);\n";

/// The maximum length of a line in characters.
const WIDTH: usize = 120;

/// Returns the text with long calls wrapped between their arguments.
fn wrapped(text: &str) -> String {
    text.lines().map(|line| wrapped_line(line) + "\n").collect()
}

fn wrapped_line(line: &str) -> String {
    let is_long = line.chars().count() > WIDTH && !line.trim_start().starts_with("//");
    let call = line.strip_suffix(");").filter(|_| is_long).and_then(opening);
    let Some((head, arguments)) = call else { return line.into() };
    let indent = " ".repeat(line.len() - line.trim_start().len());
    let mut text = format!("{head}(");
    let mut width = usize::MAX;
    for argument in split(arguments) {
        let length = argument.chars().count() + 2;
        if width.saturating_add(length) > WIDTH {
            text = format!("{}\n{indent}   ", text.trim_end());
            width = indent.len() + 4;
        }
        width += length;
        text += &format!(" {argument},");
    }
    format!("{}\n{indent});", text.trim_end_matches(','))
}

/// The statement up to the parenthesis that the last one closes, and the text between them.
fn opening(statement: &str) -> Option<(&str, &str)> {
    let mut depth = 1;
    for (at, letter) in statement.char_indices().rev() {
        depth += match letter {
            ')' => 1,
            '(' => -1,
            _ => 0,
        };
        if depth == 0 {
            return Some((&statement[..at], &statement[at + 1..]));
        }
    }
    None
}

/// The arguments of a call.
fn split(arguments: &str) -> Vec<&str> {
    let (mut depth, mut from, mut parts) = (0, 0, Vec::new());
    for (at, letter) in arguments.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(arguments[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
    }
    parts.push(arguments[from..].trim());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_calls_are_wrapped_between_their_arguments() {
        let argument = "some_function(with, arguments)";
        let line = format!("    return Structure({});", [argument; 6].join(", "));
        let text = wrapped(&line);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(
            text.starts_with("    return Structure(\n        some_function(with, arguments), some"),
            "{text}"
        );
        assert!(text.ends_with("arguments)\n    );\n"), "{text}");
        assert_eq!(text.split_whitespace().collect::<String>(), line.split_whitespace().collect::<String>());
        assert_eq!(wrapped("    return short(a, b);"), "    return short(a, b);\n");
    }
}
