// Converts attributes of the element to parts of a state.

import type { Data } from "./data";
import type { State } from "./state";

/** The attributes that control the state. */
export const SHOWN = ["light", "camera", "shading"] as const;
type Shown = (typeof SHOWN)[number];

function numbers(value: string): number[] {
    const all = value.split(",").map(Number);
    return all.every(Number.isFinite) ? all : [];
}

function light(value: string): Partial<State> {
    const [azimuth, elevation, strength] = numbers(value);
    if (azimuth === undefined || elevation === undefined) return { light: "given" };
    return { light: "raking", from: [azimuth, elevation], ...(strength === undefined ? {} : { strength }) };
}

function camera(value: string, { view }: State): Partial<State> {
    const [azimuth, elevation, distance] = numbers(value);
    if (azimuth === undefined || elevation === undefined) return {};
    return { view: [azimuth, elevation, distance ?? view[2]] };
}

/** The part of the state that an attribute sets; empty if its value is invalid. */
export function said(name: Shown, value: string, { first, data }: { first: State; data: Data }): Partial<State> {
    if (name === "light") return light(value);
    if (name === "camera") return camera(value, first);
    return data.shadings.includes(value) ? { shading: value } : {};
}
