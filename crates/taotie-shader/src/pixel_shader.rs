//! A whole pixel of a surface as a shader.

use crate::binding::interface;
use crate::interface::Interface;
use crate::language::Language;
use crate::pixel::PixelProgram;
use crate::program::Formula;
use crate::shader::{commented, has_structure, written_formulas, written_structure};
use crate::text::declarations::{bindings, frame_structure, material_structure};
use crate::text::entry::{HEADER_GLSL, entry_points, interpolated, vertex_glsl};
use crate::text::{environment, fetch, geometry, pixel, translated, wrapped};
use crate::variant::Variant;
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
    let glue = glue(&program, variant);
    let formulas = needed(&program, &glue);
    let pieces = [
        header(variant, language),
        structures(&program, &formulas, &glue, language),
        frame_structure(&interface, language),
        material_structure(&interface, language),
        bindings(&interface, language),
        interpolated(&interface, language),
        written_formulas(&formulas, program.program(), language).join("\n"),
        prototype(variant, language),
        translated(&glue, language),
        entry_points(&interface, language),
    ];
    let text = wrapped(&joined(&pieces));
    let vertex_text = (language == Language::GlslEs).then(|| vertex_glsl(&interface));
    PixelShader { text, vertex_text, interface }
}

/// The text that joins the recorded functions.
fn glue(program: &PixelProgram, variant: &Variant) -> String {
    let pieces = [
        fetch::fetches(program, variant),
        geometry::geometry(program),
        environment::tables(program),
        environment::environment(program),
        pixel::pixel(program, variant),
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

/// The declaration of the host's function, which GLSL ES requires.
fn prototype(variant: &Variant, language: Language) -> String {
    match (variant.shadows && !variant.unlit, language) {
        (true, Language::GlslEs) => VISIBILITY.into(),
        _ => String::new(),
    }
}

const VISIBILITY: &str = "// The visible fraction of a light at a position, [0, 1]; written by the host.\n\
     float visibility(int light, vec3 position, vec3 n);\n";
