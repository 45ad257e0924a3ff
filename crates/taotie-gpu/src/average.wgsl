// Adds a sample of every pixel to the sum of the previous ones, in linear light.

@group(0) @binding(0) var sum: texture_2d<f32>;
@group(0) @binding(1) var seen: texture_2d<f32>;
// The weight of a sample in its pixel, in the first component.
@group(0) @binding(2) var<uniform> weight: vec4<f32>;

// A triangle that covers the image.
@vertex
fn vertex_main(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    let x = f32(corner & 1u) * 4.0 - 1.0;
    let y = f32(corner >> 1u) * 4.0 - 1.0;
    return vec4<f32>(x, y, 0.0, 1.0);
}

@fragment
fn fragment_main(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(place.xy);
    return textureLoad(sum, pixel, 0) + textureLoad(seen, pixel, 0) * weight.x;
}
