//! The interface of a variant: what its stages read, the bindings it uses, and the text that declares them and the
//! entry points.

use super::fetch::textures;
use super::pixel::{HOST_LIGHTS, TABLES, reads_tables};
use crate::factors::{fields, transform_names};
use crate::interface::{
    BufferSlot, Interface, MOST_LEVELS, MOST_LIGHTS, TextureSlot, UniformField, ValueKind, VertexInput,
    frame_fields, laid_out,
};
use crate::language::Language;
use crate::pixel::{PixelProgram, reads};
use crate::shader::commented;
use crate::variant::{Alpha, Placement, Variant};
use std::collections::BTreeSet;
use taotie_engine::scene::TextureRole;

/// The inputs of a variant's shader.
pub(super) fn interface(pixel: &PixelProgram, variant: &Variant) -> Interface {
    let textures = textures(pixel, variant);
    let is_read = |name: &str| is_factor_read(name, pixel, variant) || is_transform(name, &textures);
    let material = laid_out(&fields(is_read));
    Interface {
        vertex: vertex(pixel, variant, &textures),
        frame: frame_fields(),
        buffers: buffers(pixel, variant, !material.is_empty()),
        material,
        textures: slots(pixel, &textures),
    }
}

/// Returns true if a stage, or the code that joins the stages, reads a factor.
fn is_factor_read(name: &str, pixel: &PixelProgram, variant: &Variant) -> bool {
    match name {
        "cutoff" => variant.alpha == Alpha::Mask,
        "height_last_level" => pixel.read.contains("t.height_du"),
        _ => pixel.fields("MaterialUniforms").contains(&name),
    }
}

/// Returns true if this is a transform field of a texture that is read.
fn is_transform(name: &str, textures: &[(TextureRole, Placement)]) -> bool {
    let transformed = textures.iter().filter(|(_, placement)| placement.transformed);
    transformed.flat_map(|(role, _)| transform_names(*role)).any(|each| each == name)
}

fn vertex(
    pixel: &PixelProgram,
    variant: &Variant,
    textures: &[(TextureRole, Placement)],
) -> Vec<VertexInput> {
    let input = |name: &str, location: u32, kind: ValueKind, meaning: &'static str| VertexInput {
        name: name.into(),
        location,
        kind,
        meaning,
    };
    let read = |paths: &[&str]| paths.iter().any(|path| pixel.read.contains(path));
    let mut inputs = vec![input("position", 0, ValueKind::Vec3, "The position: world space, model units.")];
    if read(&["g.normal", "g.normal_dx", "g.normal_dy"]) {
        let meaning = match variant.method {
            taotie_engine::surface::SurfaceMethod::BumpPrinted => "The normal: unit, object space.",
            _ => "The normal: unit, world space.",
        };
        inputs.push(input("normal", 1, ValueKind::Vec3, meaning));
    }
    if read(&["g.tangent", "g.handedness"]) {
        let meaning = "The tangent: unit, world space; the fourth number is the sign of the bitangent, ±1.";
        inputs.push(input("tangent", 2, ValueKind::Vec4, meaning));
    }
    let sets: BTreeSet<usize> = textures.iter().filter_map(|(_, placement)| placement.uv_set).collect();
    for set in sets {
        let location = if set < 2 { 3 + set as u32 } else { 4 + set as u32 };
        let meaning = "Texture coordinates; the origin is the top left.";
        inputs.push(input(&format!("uv{set}"), location, ValueKind::Vec2, meaning));
    }
    if read(&["t.color", "t.color_alpha"]) {
        inputs.push(input("color", 5, ValueKind::Vec4, "The vertex colour: linear RGB and alpha."));
    }
    inputs
}

fn buffers(pixel: &PixelProgram, variant: &Variant, has_factors: bool) -> Vec<BufferSlot> {
    let slot = |name, block, binding, meaning| BufferSlot {
        name,
        block,
        group: 0,
        binding,
        storage: false,
        meaning,
    };
    let mut buffers = vec![slot("frame", "FrameBlock", 0, "The uniforms of the frame.")];
    if !variant.unlit {
        let meaning = "The lights, `light_count` of them; in GLSL ES at most 16.";
        buffers.push(BufferSlot { storage: true, ..slot("lights", "LightBlock", 1, meaning) });
    }
    if reads(&pixel.read, "e") {
        buffers.push(slot("environment_levels", "EnvironmentBlock", 4, LEVELS));
    }
    if has_factors {
        let material = slot("material", "MaterialBlock", 0, "The factors of the surface.");
        buffers.push(BufferSlot { group: 1, ..material });
    }
    buffers
}

const LEVELS: &str = "The maps of the environment's levels, the smoothest first: x and y of the first texel of the border in
`environment_maps`, texels across without the border, and the factor of the texels. The last, number 31, has the factor
of `environment_picture` as its fourth number.";

fn slots(pixel: &PixelProgram, textures: &[(TextureRole, Placement)]) -> Vec<TextureSlot> {
    let frame = |name, binding, meaning| TextureSlot {
        name,
        group: 0,
        binding,
        sampler: None,
        uv_set: None,
        meaning,
    };
    let mut slots = Vec::new();
    if reads_tables(pixel) {
        slots.push(frame("albedo_tables", 2, TABLES));
    }
    if reads(&pixel.read, "e") {
        slots.push(frame("environment_maps", 3, MAPS));
    }
    if ["e.specular", "e.coat"].iter().any(|field| pixel.read.contains(field)) {
        slots.push(frame("environment_picture", 5, PICTURE));
    }
    slots.extend(textures.iter().enumerate().map(|(number, (role, placement))| {
        let binding = 1 + 2 * number as u32;
        TextureSlot {
            name: role.name(),
            group: 1,
            binding,
            sampler: Some(binding + 1),
            uv_set: placement.uv_set,
            meaning: role.meaning(),
        }
    }));
    slots
}

const MAPS: &str =
    "The environment's levels side by side, each an unfolded octahedron with a border of one texel.";

const PICTURE: &str = "The equirectangular image of the environment.";

/// The name of a type.
fn type_name(kind: ValueKind, language: Language) -> &'static str {
    match (language, kind) {
        (Language::Wgsl, ValueKind::Number) => "f32",
        (Language::Wgsl, ValueKind::Vec2) => "vec2f",
        (Language::Wgsl, ValueKind::Vec3) => "vec3f",
        (Language::Wgsl, ValueKind::Vec4) => "vec4f",
        (Language::Wgsl, ValueKind::Mat4) => "mat4x4f",
        (Language::GlslEs, ValueKind::Number) => "float",
        (Language::GlslEs, ValueKind::Vec2) => "vec2",
        (Language::GlslEs, ValueKind::Vec3) => "vec3",
        (Language::GlslEs, ValueKind::Vec4) => "vec4",
        (Language::GlslEs, ValueKind::Mat4) => "mat4",
    }
}

/// A structure of uniforms.
fn uniform_structure(name: &str, doc: &str, fields: &[UniformField], language: Language) -> String {
    let end = if language == Language::Wgsl { ',' } else { ';' };
    let mut text = format!("{}struct {name} {{\n", commented(doc, ""));
    for field in fields {
        let declared = language.declared(&field.name, type_name(field.kind, language));
        text += &format!("{}    {declared}{end}\n", commented(field.meaning, "    "));
    }
    text + language.structure_end()
}

/// The structure of a frame's uniforms.
pub(super) fn frame_structure(interface: &Interface, language: Language) -> String {
    uniform_structure("FrameUniforms", "The uniforms of a frame.", &interface.frame, language)
}

/// The structure of a surface's uniforms.
pub(super) fn material_structure(interface: &Interface, language: Language) -> String {
    let doc = "The factors of a surface, the same at all its points.";
    uniform_structure("MaterialUniforms", doc, &interface.material, language)
}

/// The declarations of all bindings.
pub(super) fn bindings(interface: &Interface, language: Language) -> String {
    let buffers = interface.buffers.iter().map(|slot| buffer(slot, language));
    let textures = interface.textures.iter().map(|slot| texture(slot, language));
    buffers.chain(textures).collect()
}

/// The type of a buffer's variable, and the length of an array.
fn content(slot: &BufferSlot) -> (&'static str, Option<usize>) {
    match slot.name {
        "frame" => ("FrameUniforms", None),
        "material" => ("MaterialUniforms", None),
        "lights" => ("Light", Some(MOST_LIGHTS)),
        _ => ("vec4", Some(MOST_LEVELS)),
    }
}

/// The declaration of a buffer.
fn buffer(slot: &BufferSlot, language: Language) -> String {
    let BufferSlot { name, block, group, binding, storage, meaning } = slot;
    let (kind, count) = content(slot);
    let comment = commented(meaning, "");
    match language {
        Language::Wgsl => {
            let kind = kind.replace("vec4", "vec4f");
            let kind = match count {
                None => kind,
                Some(_) if *storage => format!("array<{kind}>"),
                Some(count) => format!("array<{kind}, {count}>"),
            };
            let space = if *storage { "storage, read" } else { "uniform" };
            format!("{comment}@group({group}) @binding({binding}) var<{space}> {name}: {kind};\n")
        }
        Language::GlslEs => {
            let count = count.map_or(String::new(), |count| format!("[{count}]"));
            let text =
                format!("{comment}layout(std140) uniform {block} {{\n    {kind} {name}{count};\n}};\n");
            if *name == "lights" { format!("#ifndef {HOST_LIGHTS}\n{text}#endif\n") } else { text }
        }
    }
}

fn texture(slot: &TextureSlot, language: Language) -> String {
    let TextureSlot { name, group, binding, sampler, meaning, .. } = slot;
    let comment = commented(meaning, "");
    match language {
        Language::Wgsl => {
            let sampler = sampler.map_or(String::new(), |sampler| {
                format!("@group({group}) @binding({sampler}) var {name}_sampler: sampler;\n")
            });
            format!("{comment}@group({group}) @binding({binding}) var {name}: texture_2d<f32>;\n{sampler}")
        }
        Language::GlslEs => format!("{comment}uniform sampler2D {name};\n"),
    }
}

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
pub(super) fn interpolated(interface: &Interface, language: Language) -> String {
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
pub(super) fn entry_points(interface: &Interface, language: Language) -> String {
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
pub(super) fn vertex_glsl(interface: &Interface) -> String {
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
pub(super) const HEADER_GLSL: &str =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";
