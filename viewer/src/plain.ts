// Materials that show the uvs of a surface, without shading or any part of the pixel program.

import { DoubleSide, GLSL3, RawShaderMaterial } from "three";

const vertex = (set: number): string => `precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 modelViewMatrix;
in vec3 position;
in vec2 uv${set};
out vec2 place;
void main() {
    place = uv${set};
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`;

const HEAD = `precision highp float;
in vec2 place;
layout(location = 0) out vec4 color;
`;

/** A material whose `fragment` shader writes `color` for a `place` in a uv set. */
export const plain = (fragment: string, uniforms: RawShaderMaterial["uniforms"] = {}, set = 0): RawShaderMaterial =>
    new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: vertex(set),
        fragmentShader: HEAD + fragment,
        uniforms,
        side: DoubleSide,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
    });
