// The light of a state, in the form that shaders read.

import { Vector3 } from "three";
import type { Light } from "./data";
import { angles, axes, direction, radians } from "./orbit";
import type { State } from "./state";

/** The range of a light without a limit. */
const NO_RANGE = 1e18;

/** The unit direction to the raking light in world space. */
export function toLight(state: State): Vector3 {
    const local = direction(...state.from);
    if (state.fixed === "object") return local;
    const [right, up, back] = axes(state);
    const world = right.multiplyScalar(local.x).addScaledVector(up, local.y);
    return world.addScaledVector(back, local.z).normalize();
}

/** The state with its light fixed to another frame, shining from the same direction. */
export function refixed(state: State, fixed: string): State {
    const to = toLight(state);
    const [right, up, back] = axes(state);
    const seen = new Vector3(to.dot(right), to.dot(up), to.dot(back));
    return { ...state, fixed, from: angles(fixed === "object" ? to : seen) };
}

/** Sixteen numbers per light. */
export function lights(state: State, { lights }: Light): number[][] {
    if (state.light === "given") return lights;
    const to = toLight(state);
    const color = [state.strength, state.strength, state.strength];
    return [[to.x, to.y, to.z, 0, ...color, NO_RANGE, 0, 0, 1, -2, -3, 0, 0, 0]];
}

/** Ambient radiance. */
export function ambient(state: State, light: Light): number[] {
    return state.light === "given" ? light.ambient : [state.fill, state.fill, state.fill];
}

/** Sine and cosine of the environment's rotation, and its intensity factor. */
export function environment({ environment: [turn, intensity] }: State): [number, number, number] {
    return [Math.sin(radians(turn)), Math.cos(radians(turn)), intensity];
}
