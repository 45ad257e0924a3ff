// A checker pattern that shows the uv layout.

import type { RawShaderMaterial } from "three";
import { plain } from "./plain";

const FRAGMENT = `void main() {
    vec2 square = floor(place * 16.0);
    float light = mod(square.x + square.y, 2.0) < 0.5 ? 1.0 : 0.55;
    vec2 cell = fract(place);
    color = vec4(vec3(cell.x, cell.y, 1.0 - 0.5 * (cell.x + cell.y)) * light, 1.0);
}
`;

/** Squares of 1/16 of the map, red along u and green along v. */
export const checker = (): RawShaderMaterial => plain(FRAGMENT);
