// The state: camera, light, surface and film. A link contains it, and the picture depends on nothing else.

import type { State } from "../taotie-viewer";
import type { Data } from "./data";
import { BEST, bounded, parsed } from "./fields";

export type { State };

/** The number of digits of the state's numbers in a link. */
const DIGITS = 6;
const round = (value: number): number => Number(value.toPrecision(DIGITS));

/** The state of a page opened without a link. */
export function firstState({ camera, light, film, shading, method }: Data): State {
    const { environment } = light;
    return rounded({
        view: [camera?.azimuth ?? 0, camera?.elevation ?? 0, camera?.distance ?? 1],
        target: camera?.target ?? [0, 0, 0],
        shading,
        surface: method ?? BEST,
        mode: "shaded",
        wireframe: false,
        rays: false,
        light: "given",
        from: [-60, 20],
        fixed: "viewer",
        strength: 3,
        fill: 0.05,
        shadows: false,
        environment: [environment?.rotation ?? 0, environment?.intensity ?? 1],
        exposure: film.exposure,
        tone: film.tone,
        beside: "none",
        split: 0.5,
    });
}

/** The state with its numbers rounded as in a link. */
function rounded(state: State): State {
    const entries = Object.entries(state).map(([name, value]) => {
        if (typeof value === "number") return [name, round(value)];
        if (Array.isArray(value)) return [name, value.map(round)];
        return [name, value];
    });
    return Object.fromEntries(entries) as State;
}

/** The fragment of a link: all differences from the initial state. */
export function fragment(state: State, first: State): string {
    const names = Object.keys(state) as (keyof State)[];
    const changed = names.filter((name) => String(state[name]) !== String(first[name]));
    return changed.map((name) => `${name}=${encodeURIComponent(String(state[name])).replaceAll("%2C", ",")}`).join("&");
}

/** The state in a link; missing and invalid values are taken from the initial state. */
export function ofFragment(text: string, first: State, data: Data): State {
    const state: Record<string, unknown> = { ...first };
    for (const [name, value] of new URLSearchParams(text.replace(/^#/, ""))) {
        const read = parsed(name, value, data);
        if (read !== undefined) state[name] = read;
    }
    return clamped(state as unknown as State);
}

/** The state with its numbers clamped to their ranges, and rounded. */
export const clamped = (state: State): State => rounded(bounded(state));
