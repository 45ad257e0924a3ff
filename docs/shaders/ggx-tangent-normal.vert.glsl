#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;

// The uniforms of a frame.
struct FrameUniforms {
    // Transforms world space to the host's clip space.
    mat4 clip_from_world;
    // The viewer's position and 1, or the unit direction to the viewer and 0; world space.
    vec4 eye;
    // Ambient radiance from all directions, linear RGB.
    vec3 ambient;
    // The distance between two samples in pixels: 1/2 with four samples per pixel.
    float spacing;
    // The sine of the environment's rotation about +y.
    float environment_sin;
    // The cosine of the environment's rotation about +y.
    float environment_cos;
    // The factor of the environment's radiance, at least 0.
    float environment_intensity;
    // The number of environment levels.
    float environment_levels;
    // The α of the environment's smoothest level, (0, 1].
    float smoothest_alpha;
    // The number of lights.
    float light_count;
};

// The uniforms of the frame.
layout(std140) uniform FrameBlock {
    FrameUniforms frame;
};

// The position: world space, model units.
layout(location = 0) in vec3 position;
// The normal: unit, world space.
layout(location = 1) in vec3 normal;
// The tangent: unit, world space; the fourth number is the sign of the bitangent, ±1.
layout(location = 2) in vec4 tangent;
// Texture coordinates; the origin is the top left.
layout(location = 3) in vec2 uv0;

out vec3 interpolated_position;
out vec3 interpolated_normal;
out vec3 interpolated_tangent;
flat out float interpolated_handedness;
out vec2 interpolated_uv0;

void main() {
    interpolated_position = position;
    interpolated_normal = normal;
    interpolated_tangent = tangent.xyz;
    interpolated_handedness = tangent.w;
    interpolated_uv0 = uv0;
    gl_Position = frame.clip_from_world * vec4(position, 1.0);
}
