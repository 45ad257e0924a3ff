//! Entry points, and the values interpolated between them.

use super::declarations::{buffer, frame_structure, type_name};
use crate::interface::{Interface, ValueKind};
use crate::language::Language;
use crate::shader::commented;

/// An interpolated value: its name, its type, and the vertex value that it comes from.
struct Varying {
    name: String,
    kind: ValueKind,
    vertex: String,
    /// Whether it takes the value of the triangle's first vertex.
    flat: bool,
}

/// The interpolated values of a shader. Positions, normals and tangents are interpolated as the vertices have them; a
/// tangent's handedness is constant over a triangle.
fn varyings(interface: &Interface) -> Vec<Varying> {
    let mut varyings = Vec::new();
    for input in &interface.vertex {
        let name = input.name.clone();
        if name == "tangent" {
            varyings.push(Varying { kind: ValueKind::Vec3, vertex: "tangent.xyz".into(), name, flat: false });
            let handedness = Varying {
                name: "handedness".into(),
                kind: ValueKind::Number,
                vertex: "tangent.w".into(),
                flat: true,
            };
            varyings.push(handedness);
        } else {
            varyings.push(Varying { kind: input.kind, vertex: name.clone(), name, flat: false });
        }
    }
    varyings
}

const INTERPOLATED: &str = "// The interpolated values of the vertices: world space.\n";

/// The structure `Interpolated`, with its inputs.
pub(crate) fn interpolated(interface: &Interface, language: Language) -> String {
    let mut text = String::new();
    if language == Language::GlslEs {
        for Varying { name, kind, flat, .. } in varyings(interface) {
            let flat = if flat { "flat " } else { "" };
            text += &format!("{flat}in {} interpolated_{name};\n", type_name(kind, language));
        }
        text += "\n";
    }
    text += INTERPOLATED;
    text += "struct Interpolated {\n";
    if language == Language::Wgsl {
        text += "    @builtin(position) clip: vec4f,\n";
    }
    for (location, Varying { name, kind, flat, .. }) in varyings(interface).iter().enumerate() {
        let kind = type_name(*kind, language);
        text += &match language {
            Language::Wgsl => {
                let flat = if *flat { "@interpolate(flat) " } else { "" };
                format!("    @location({location}) {flat}{name}: {kind},\n")
            }
            Language::GlslEs => format!("    {kind} {name};\n"),
        };
    }
    text + language.structure_end()
}

/// The entry points in WGSL; in GLSL ES only that of the fragment shader.
pub(crate) fn entry_points(interface: &Interface, language: Language) -> String {
    match language {
        Language::Wgsl => format!("{}\n{FRAGMENT_WGSL}", vertex_wgsl(interface)),
        Language::GlslEs => {
            let values =
                varyings(interface).iter().map(|each| format!("interpolated_{}", each.name)).collect();
            fragment_glsl(values)
        }
    }
}

const FRAGMENT_WGSL: &str = "// Linear RGB radiance, not multiplied by alpha, and alpha.
@fragment
fn fragment_main(i: Interpolated, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return pixel(i, front);
}
";

fn fragment_glsl(values: Vec<String>) -> String {
    format!(
        "// Linear RGB radiance, not multiplied by alpha, and alpha.\n\
         layout(location = 0) out vec4 pixel_color;\n\n\
         void main() {{\n    pixel_color = pixel(Interpolated({}), gl_FrontFacing);\n}}\n",
        values.join(", ")
    )
}

fn vertex_wgsl(interface: &Interface) -> String {
    let mut text = "// The attributes of a vertex.\nstruct Vertex {\n".to_owned();
    for input in &interface.vertex {
        let kind = type_name(input.kind, Language::Wgsl);
        text += &commented(input.meaning, "    ");
        text += &format!("    @location({}) {}: {kind},\n", input.location, input.name);
    }
    let values: Vec<String> =
        varyings(interface).iter().map(|each| format!("vertex.{}", each.vertex)).collect();
    text + &format!(
        "}}\n\n@vertex\nfn vertex_main(vertex: Vertex) -> Interpolated {{\n    \
         let clip = frame.clip_from_world * vec4f(vertex.position, 1.0);\n    \
         return Interpolated(clip, {});\n}}\n",
        values.join(", ")
    )
}

/// The vertex shader in GLSL ES.
pub(crate) fn vertex_glsl(interface: &Interface) -> String {
    let language = Language::GlslEs;
    let frame = interface.buffers.iter().find(|slot| slot.name == "frame");
    let mut text = format!("{HEADER_GLSL}\n{}\n", frame_structure(interface, language));
    text += &frame.map_or(String::new(), |slot| buffer(slot, language));
    text += "\n";
    for input in &interface.vertex {
        let kind = type_name(input.kind, language);
        text += &commented(input.meaning, "");
        text += &format!("layout(location = {}) in {kind} {};\n", input.location, input.name);
    }
    text += "\n";
    let mut body = String::new();
    for Varying { name, kind, vertex, flat } in varyings(interface) {
        let flat = if flat { "flat " } else { "" };
        text += &format!("{flat}out {} interpolated_{name};\n", type_name(kind, language));
        body += &format!("    interpolated_{name} = {vertex};\n");
    }
    text + &format!(
        "\nvoid main() {{\n{body}    gl_Position = frame.clip_from_world * vec4(position, 1.0);\n}}\n"
    )
}

/// The first lines of a shader in GLSL ES.
pub(crate) const HEADER_GLSL: &str =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";
