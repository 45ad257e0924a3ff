//! The interface of a variant: what its stages read, and the bindings it uses.

use crate::factors::{fields, transform_names};
use crate::frame::frame_fields;
use crate::interface::{BufferSlot, Interface, TextureSlot, ValueKind, VertexInput, laid_out};
use crate::pixel::{PixelProgram, reads};
use crate::text::fetch::textures;
use crate::variant::{Alpha, Placement, Variant};
use std::collections::BTreeSet;
use taotie_engine::scene::TextureRole;

/// The inputs of a variant's shader.
pub(crate) fn interface(pixel: &PixelProgram, variant: &Variant) -> Interface {
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
    if ["dfg", "coat_dfg", "sheen_table"].iter().any(|argument| reads(&pixel.read, argument)) {
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

const TABLES: &str = "Directional albedos, 64 texels of four 32-bit floats a row: 48 rows of GGX, 48 of Cook-Torrance, 48 of sheen in red.";

const MAPS: &str =
    "The environment's levels side by side, each an unfolded octahedron with a border of one texel.";

const PICTURE: &str = "The equirectangular image of the environment.";
