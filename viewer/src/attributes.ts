// Converts attributes of the element to parts of a state.

import type { Data } from "./data";
import { FIELDS, acceptedText, fault, numbersOf, shownValue } from "./fields";
import type { State } from "./state";

/** Returns the part of the state that a value sets; undefined if its form is wrong. */
type Reader = (value: string, first: State) => Partial<State> | undefined;

/** An attribute that controls the state, and the values that it accepts. */
interface Attribute {
    read: Reader;
    accepts(data: Data): string;
}

const light: Reader = (value) => {
    if (value === "given") return { light: "given" };
    const [azimuth, elevation, strength, ...more] = numbersOf(value) ?? [];
    if (azimuth === undefined || elevation === undefined || more.length > 0) return undefined;
    return { light: "raking", from: [azimuth, elevation], ...(strength === undefined ? {} : { strength }) };
};

const camera: Reader = (value, { view }) => {
    const [azimuth, elevation, distance, ...more] = numbersOf(value) ?? [];
    if (azimuth === undefined || elevation === undefined || more.length > 0) return undefined;
    return { view: [azimuth, elevation, distance ?? view[2]] };
};

const ATTRIBUTES = {
    light: {
        read: light,
        accepts: () => "`given`, or azimuth, elevation from -90 to 90 and optionally strength from 0 to 1000: `-75,10,4`",
    },
    camera: {
        read: camera,
        accepts: () => "azimuth, elevation from -90 to 90 and optionally distance above 0: `30,20,0.5`",
    },
    shading: {
        read: (shading) => ({ shading }),
        accepts: (data) => acceptedText(FIELDS.shading, data),
    },
} satisfies Record<string, Attribute>;

/** The names of attributes that control the state. */
export const SHOWN = Object.keys(ATTRIBUTES) as Shown[];
export type Shown = keyof typeof ATTRIBUTES;

export const isShown = (name: string): name is Shown => Object.hasOwn(ATTRIBUTES, name);

/** The part of the state that an attribute sets, or what is wrong with its value. */
export function said(name: Shown, value: string, { first, data }: { first: State; data: Data }): Partial<State> | string {
    const attribute: Attribute = ATTRIBUTES[name];
    const part = attribute.read(value, first);
    if (part && !fault(part, data)) return part;
    return `invalid attribute \`${name}\` ${shownValue(value)}: expected ${attribute.accepts(data)}`;
}

/** The attributes of the element other than those that control the state. */
const OTHERS = ["src", "linked"];
/** Names of data, accessibility and frameworks. */
const FOREIGN = /^(aria|data|hx|ng|v|x)-|[^a-z0-9-]/;
/** Attributes of every element that are not properties of the same name. */
const GLOBAL = ["class", "exportparts", "is", "itemid", "itemprop", "itemref", "itemscope", "itemtype", "role"];

let inherited: Set<string> | undefined;

/** What is wrong with the name of an attribute; undefined if it is known, or of every element, or of a framework. */
export function unknown(name: string): string | undefined {
    if (isShown(name) || OTHERS.includes(name) || FOREIGN.test(name)) return undefined;
    if (!inherited) {
        inherited = new Set(GLOBAL);
        for (const property in HTMLElement.prototype) inherited.add(property.toLowerCase());
    }
    if (inherited.has(name)) return undefined;
    return `unknown attribute \`${name}\`: expected one of: ${[...OTHERS, ...SHOWN].join(", ")}`;
}
