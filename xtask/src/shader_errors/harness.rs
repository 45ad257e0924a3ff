//! Generated shaders with an entry point that reads the vertex values of each pixel from a picture.
//!
//! The text is that of [`pixel_shader`], with only the entry point changed.

use super::cases::Case;
use super::points::BLOCKS;
use taotie_shader::{Interface, Language, PixelShader, pixel_shader};

/// Returns a shader over points in WGSL, with the entry points `points_vertex` and `points_fragment`.
pub fn wgsl(case: &Case) -> PixelShader {
    let mut shader = pixel_shader(&case.variant(), Language::Wgsl);
    let arguments = arguments(&shader.interface);
    shader.text += &format!(
        "
@group(2) @binding(0) var point_inputs: texture_2d<f32>;

fn point_input(at: vec2i, block: i32) -> vec4f {{
    let rows = i32(textureDimensions(point_inputs).y) / {BLOCKS};
    return textureLoad(point_inputs, vec2i(at.x, at.y + rows * block), 0);
}}

@vertex
fn points_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {{
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}}

@fragment
fn points_fragment(@builtin(position) clip: vec4f) -> @location(0) vec4f {{
    let at = vec2i(clip.xy);
    let a = point_input(at, 0);
    let b = point_input(at, 1);
    let c = point_input(at, 2);
    let d = point_input(at, 3);
    let e = point_input(at, 4);
    return pixel(Interpolated(clip, {arguments}), 0.5 < b.w);
}}
"
    );
    shader
}

/// The vertex shader that covers all pixels, in GLSL ES.
pub const VERTEX_GLSL: &str = "#version 300 es
void main() {
    gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
";

/// Returns a fragment shader over points in GLSL ES.
pub fn glsl(case: &Case) -> PixelShader {
    let mut shader = pixel_shader(&case.variant(), Language::GlslEs);
    let arguments = arguments(&shader.interface);
    let before = shader.text.split("void main()").next().unwrap_or_default();
    shader.text = format!(
        "{before}uniform sampler2D point_inputs;

vec4 point_input(int block) {{
    ivec2 at = ivec2(gl_FragCoord.xy);
    int rows = textureSize(point_inputs, 0).y / {BLOCKS};
    return texelFetch(point_inputs, ivec2(at.x, at.y + rows * block), 0);
}}

void main() {{
    vec4 a = point_input(0);
    vec4 b = point_input(1);
    vec4 c = point_input(2);
    vec4 d = point_input(3);
    vec4 e = point_input(4);
    pixel_color = pixel(Interpolated({arguments}), 0.5 < b.w);
}}
"
    );
    shader
}

/// Returns the values that are normally interpolated.
fn arguments(interface: &Interface) -> String {
    let argument = |name: &str| match name {
        "position" => "a.xyz",
        "normal" => "b.xyz",
        "tangent" => "c.xyz, a.w",
        "color" => "e",
        _ => "d.xy",
    };
    let all: Vec<&str> = interface.vertex.iter().map(|input| argument(&input.name)).collect();
    all.join(", ")
}
