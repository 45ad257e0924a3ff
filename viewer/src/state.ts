// The state: camera, light, surface and film. A link contains it, and the picture depends on nothing else.

import type { State } from "../taotie-viewer";
import type { Data } from "./data";

export const MODES = [
    "shaded",
    "clay",
    "base-color",
    "normals",
    "tangent-normals",
    "roughness",
    "metallic",
    "occlusion",
    "uv",
    "error",
] as const;
export const LIGHTS = ["given", "raking"] as const;
export const FIXED = ["viewer", "object"] as const;
export const TONES = ["neutral", "linear", "reinhard", "aces", "agx"] as const;
/** The method chosen by the material. */
export const BEST = "best";

export type { State };

/** The choices right of the wipe handle: nothing, the model without its map, and the scan. */
export const BESIDE = ["none", "smooth", "scan"] as const;

/** The modes available on a page: errors need a scan. */
export const modes = ({ errors }: Data): string[] => MODES.filter((mode) => mode !== "error" || errors !== null);
/** The choices available right of the wipe handle. */
export const besides = ({ models }: Data): string[] => BESIDE.filter((each) => each !== "scan" || models.length > 1);

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
export function rounded(state: State): State {
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

type Choices = Partial<Record<keyof State, readonly string[]>>;

/** The state in a link; missing and invalid values are taken from the initial state. */
export function ofFragment(text: string, first: State, data: Data): State {
    const choices: Choices = {
        shading: data.shadings,
        surface: [BEST, ...data.methods],
        mode: modes(data),
        beside: besides(data),
        light: LIGHTS,
        fixed: FIXED,
        tone: TONES,
    };
    const state: Record<string, unknown> = { ...first };
    for (const [name, value] of new URLSearchParams(text.replace(/^#/, ""))) {
        const before = first[name as keyof State];
        const numbers = value.split(",").map(Number);
        const sound = value !== "" && numbers.every(Number.isFinite);
        if (typeof before === "boolean") state[name] = value === "true";
        else if (typeof before === "string" && choices[name as keyof State]?.includes(value)) state[name] = value;
        else if (typeof before === "number" && sound) state[name] = numbers[0];
        else if (Array.isArray(before) && sound && numbers.length === before.length) state[name] = numbers;
    }
    return bounded(state as unknown as State);
}

const within = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
/** Degrees in (−180, 180]. */
export const wrapped = (value: number): number => value - 360 * Math.ceil((value - 180) / 360);

/** The state with its numbers clamped to their ranges. */
export function bounded(state: State): State {
    const [azimuth, elevation, distance] = state.view;
    return rounded({
        ...state,
        view: [wrapped(azimuth), within(elevation, -90, 90), within(distance, 1e-9, 1e18)],
        from: [wrapped(state.from[0]), within(state.from[1], -90, 90)],
        strength: within(state.strength, 0, 1000),
        fill: within(state.fill, 0, 1000),
        environment: [wrapped(state.environment[0]), within(state.environment[1], 0, 1000)],
        exposure: within(state.exposure, -20, 20),
        split: within(state.split, 0, 1),
    });
}
