// Squares that show how the uvs lie: no shading, and no part of the pixel program.

import { DoubleSide, GLSL3, RawShaderMaterial, type UniformsGroup } from "three";

const VERTEX = `precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 modelViewMatrix;
in vec3 position;
in vec2 uv0;
out vec2 place;
void main() {
    place = uv0;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`;

const FRAGMENT = `precision highp float;
in vec2 place;
layout(location = 0) out vec4 color;
void main() {
    vec2 square = floor(place * 16.0);
    float light = mod(square.x + square.y, 2.0) < 0.5 ? 1.0 : 0.55;
    vec2 cell = fract(place);
    color = vec4(vec3(cell.x, cell.y, 1.0 - 0.5 * (cell.x + cell.y)) * light, 1.0);
}
`;

/** Squares of 1/16 of the map, red along u and green along v. */
export const checker = (): RawShaderMaterial =>
    new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        side: DoubleSide,
        uniformsGroups: [] as UniformsGroup[],
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
    });
