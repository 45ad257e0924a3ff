// The values of a state: what each accepts, and what is wrong with one that does not.

import type { State } from "../taotie-viewer";
import type { Data } from "./data";

const MODES = [
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
/** The choices right of the wipe handle: nothing, the model without its map, and the scan. */
const BESIDE = ["none", "smooth", "scan"] as const;

/** The modes available on a page: errors need a scan. */
export const modes = ({ errors }: Data): string[] => MODES.filter((mode) => mode !== "error" || errors !== null);
/** The choices available right of the wipe handle. */
export const besides = ({ models }: Data): string[] => BESIDE.filter((each) => each !== "scan" || models.length > 1);

/** A number: its name and range. Without a range it is an angle, which wraps around. */
interface Quantity {
    name: string;
    range?: [low: number, high: number];
}

/** The values that a member of the state accepts: one number, a list of numbers, one of several names, or a switch. */
type Field =
    | { number: Quantity }
    | { numbers: Quantity[] }
    | { names(data: Data): readonly string[] }
    | { isSwitch: true };

const turn = (name: string): Quantity => ({ name: `${name} in degrees` });
const elevation: Quantity = { name: "elevation in degrees", range: [-90, 90] };
const radiance = (name: string): Quantity => ({ name, range: [0, 1000] });
/** The largest coordinate. */
const FAR = 1e18;
const coordinate = (name: string): Quantity => ({ name, range: [-FAR, FAR] });

/** The members of a state. */
export const FIELDS: Record<keyof State, Field> = {
    view: { numbers: [turn("azimuth"), elevation, { name: "distance", range: [1e-9, FAR] }] },
    target: { numbers: ["x", "y", "z"].map(coordinate) },
    shading: { names: ({ shadings }) => shadings },
    surface: { names: ({ methods }) => [BEST, ...methods] },
    mode: { names: modes },
    wireframe: { isSwitch: true },
    rays: { isSwitch: true },
    light: { names: () => LIGHTS },
    from: { numbers: [turn("azimuth"), elevation] },
    fixed: { names: () => FIXED },
    strength: { number: radiance("strength") },
    fill: { number: radiance("ambient radiance") },
    shadows: { isSwitch: true },
    environment: { numbers: [turn("rotation"), radiance("intensity")] },
    exposure: { number: { name: "stops", range: [-20, 20] } },
    tone: { names: () => TONES },
    beside: { names: besides },
    split: { number: { name: "fraction of the width", range: [0, 1] } },
};

const isMember = (name: string): name is keyof State => Object.hasOwn(FIELDS, name);

/** Degrees in (−180, 180]. */
const wrapped = (value: number): number => value - 360 * Math.ceil((value - 180) / 360);

/** The nearest number in the range of a quantity. */
function held(value: number, { range }: Quantity): number {
    return range ? Math.min(Math.max(value, range[0]), range[1]) : wrapped(value);
}

const isIn = (value: unknown, { range }: Quantity): boolean =>
    typeof value === "number" && Number.isFinite(value) && (!range || (value >= range[0] && value <= range[1]));

/** The state with its numbers clamped to their ranges. */
export function bounded(state: State): State {
    const entries = Object.entries(state).map(([name, value]) => {
        const field = FIELDS[name as keyof State];
        if ("number" in field) return [name, held(value as number, field.number)];
        if ("numbers" in field) return [name, (value as number[]).map((each, i) => held(each, field.numbers[i]!))];
        return [name, value];
    });
    return Object.fromEntries(entries) as State;
}

/** The numbers of a list such as `30,20`; undefined if one is missing or not finite. */
export function numbersOf(text: string): number[] | undefined {
    const numbers = text.split(",").map((each) => (each.trim() === "" ? NaN : Number(each)));
    return numbers.every(Number.isFinite) ? numbers : undefined;
}

/** The value of a member as a text in a link; undefined if invalid. Numbers are clamped later. */
export function parsed(name: string, text: string, data: Data): unknown {
    if (!isMember(name)) return undefined;
    const field = FIELDS[name];
    if ("isSwitch" in field) return text === "true";
    if ("names" in field) return field.names(data).includes(text) ? text : undefined;
    const numbers = numbersOf(text);
    if (!numbers) return undefined;
    if ("number" in field) return numbers.length === 1 ? numbers[0] : undefined;
    return numbers.length === field.numbers.length ? numbers : undefined;
}

function isAccepted(value: unknown, field: Field, data: Data): boolean {
    if ("isSwitch" in field) return typeof value === "boolean";
    if ("names" in field) return field.names(data).includes(value as string);
    if ("number" in field) return isIn(value, field.number);
    const { numbers } = field;
    return Array.isArray(value) && value.length === numbers.length && numbers.every((each, i) => isIn(value[i], each));
}

function rangeText({ name, range }: Quantity): string {
    const short = (value: number) => (Math.abs(value) < 1e6 ? String(value) : value.toExponential().replace("+", ""));
    return range ? `${name} from ${short(range[0])} to ${short(range[1])}` : name;
}

/** The values that a member accepts. */
export function acceptedText(field: Field, data: Data): string {
    if ("isSwitch" in field) return "true or false";
    if ("names" in field) return `one of: ${field.names(data).join(", ")}`;
    if ("number" in field) return `a number, ${rangeText(field.number)}`;
    return `${field.numbers.length} numbers: ${field.numbers.map(rangeText).join(", ")}`;
}

/** The longest text of a value in a message. */
const LONGEST = 60;

/** A value as text for a message. */
export function shownValue(value: unknown): string {
    const replaced = (_: string, each: unknown) => (typeof each === "number" && !Number.isFinite(each) ? String(each) : each);
    let text: string | undefined;
    try {
        text = typeof value === "number" ? String(value) : JSON.stringify(value, replaced);
    } catch {
        // Values with cycles or big integers have no JSON.
    }
    const shown = text ?? String(value);
    return `\`${shown.length > LONGEST ? `${shown.slice(0, LONGEST)}…` : shown}\``;
}

/** What is wrong with a change of the state, in one sentence; undefined if it can be applied. */
export function fault(part: unknown, data: Data): string | undefined {
    if (typeof part !== "object" || part === null || Array.isArray(part)) {
        return `invalid change ${shownValue(part)}: expected an object, such as { mode: "clay" }`;
    }
    for (const [name, value] of Object.entries(part)) {
        if (!isMember(name)) return `unknown property \`${name}\`: expected one of: ${Object.keys(FIELDS).join(", ")}`;
        const field = FIELDS[name];
        if (!isAccepted(value, field, data)) {
            return `invalid \`${name}\` ${shownValue(value)}: expected ${acceptedText(field, data)}`;
        }
    }
    return undefined;
}
