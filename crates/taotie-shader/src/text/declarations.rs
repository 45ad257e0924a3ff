//! Structures of uniforms, and all bindings.

use crate::frame::{MOST_LEVELS, MOST_LIGHTS};
use crate::interface::{BufferSlot, Interface, TextureSlot, UniformField, ValueKind};
use crate::language::Language;
use crate::shader::commented;

/// The name of a type.
pub(crate) fn type_name(kind: ValueKind, language: Language) -> &'static str {
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
pub(crate) fn uniform_structure(
    name: &str,
    doc: &str,
    fields: &[UniformField],
    language: Language,
) -> String {
    let end = if language == Language::Wgsl { ',' } else { ';' };
    let mut text = format!("{}struct {name} {{\n", commented(doc, ""));
    for field in fields {
        let declared = language.declared(&field.name, type_name(field.kind, language));
        text += &format!("{}    {declared}{end}\n", commented(field.meaning, "    "));
    }
    text + language.structure_end()
}

/// The structure of a frame's uniforms.
pub(crate) fn frame_structure(interface: &Interface, language: Language) -> String {
    uniform_structure("FrameUniforms", "The uniforms of a frame.", &interface.frame, language)
}

/// The structure of a surface's uniforms.
pub(crate) fn material_structure(interface: &Interface, language: Language) -> String {
    let doc = "The factors of a surface, the same at all its points.";
    uniform_structure("MaterialUniforms", doc, &interface.material, language)
}

/// The declarations of all bindings.
pub(crate) fn bindings(interface: &Interface, language: Language) -> String {
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
pub(crate) fn buffer(slot: &BufferSlot, language: Language) -> String {
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
            format!("{comment}layout(std140) uniform {block} {{\n    {kind} {name}{count};\n}};\n")
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
