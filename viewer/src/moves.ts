// Changes of the state by mouse, touch and keys.

import { Vector3 } from "three";
import type { Orbit } from "./data";
import { axes, radians } from "./orbit";
import type { State } from "./state";

type Move = (state: State) => Partial<State>;

/** Turns the model by degrees to the right and up, following the hand. */
export const turn =
    (right: number, up: number): Move =>
    ({ view: [azimuth, elevation, distance] }) => ({ view: [azimuth - right, elevation + up, distance] });

/** Moves the light by degrees and switches to the raking light. */
export const moveLight =
    (right: number, up: number): Move =>
    ({ from: [azimuth, elevation] }) => ({ light: "raking", from: [azimuth + right, elevation + up] });

/** Zooms in for factors above 1. */
export const zoom =
    (factor: number): Move =>
    ({ view: [azimuth, elevation, distance] }) => ({ view: [azimuth, elevation, distance / factor] });

/** Pans by fractions of the picture's height, following the hand. */
export const pan =
    (right: number, down: number, lens: Orbit): Move =>
    (state) => {
        const [x, y] = axes(state);
        const height = 2 * state.view[2] * Math.tan(radians(lens.fov_y) / 2);
        const target = new Vector3(...state.target).addScaledVector(x, -right * height).addScaledVector(y, down * height);
        return { target: target.toArray() };
    };

/** Returns the value after this one, cyclically. */
export function next<T>(all: readonly T[], value: T): T {
    return all[(all.indexOf(value) + 1) % all.length]!;
}
