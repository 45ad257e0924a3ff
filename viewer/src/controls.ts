// Fields of the panel, each for one value of the state.

import { make } from "./dom";
import type { State } from "./state";
import type { Viewer } from "./viewer";

let fields = 0;

function labelled(name: string, field: HTMLElement, ...more: HTMLElement[]): HTMLElement {
    field.id = `field-${fields++}`;
    return make("p", { class: "field" }, make("label", { for: field.id }, name), ...more, field);
}

export interface Choice {
    value: string;
    name: string;
    disabled?: boolean;
}

/** Creates a drop-down list. */
export function choice(
    viewer: Viewer,
    name: string,
    all: Choice[],
    of: { get(state: State): string; set(value: string): Partial<State> },
): HTMLElement {
    const options = all.map(({ value, name, disabled }) => {
        return make("option", { value, ...(disabled ? { disabled: "" } : {}) }, name);
    });
    const select = make("select", {}, ...options);
    select.addEventListener("change", () => viewer.move(of.set(select.value)));
    viewer.listen((state) => void (select.value = of.get(state)));
    return labelled(name, select);
}

export interface Range {
    low: number;
    high: number;
    step: number;
    text(value: number): string;
}

/** Creates a slider for a number. */
export function range(
    viewer: Viewer,
    name: string,
    { low, high, step, text }: Range,
    of: { get(state: State): number; set(value: number, state: State): Partial<State> },
): HTMLElement {
    const numbers = { min: String(low), max: String(high), step: String(step) };
    const input = make("input", { type: "range", ...numbers });
    const output = make("output", {});
    input.addEventListener("input", () => viewer.move(of.set(Number(input.value), viewer.state)));
    viewer.listen((state) => {
        const value = of.get(state);
        input.value = String(value);
        output.textContent = text(value);
        input.setAttribute("aria-valuetext", text(value));
    });
    return labelled(name, input, output);
}

/** Creates a switch. */
export function toggle(
    viewer: Viewer,
    name: string,
    of: { get(state: State): boolean; set(value: boolean): Partial<State> },
): HTMLElement {
    const input = make("input", { type: "checkbox" });
    input.addEventListener("change", () => viewer.move(of.set(input.checked)));
    viewer.listen((state) => void (input.checked = of.get(state)));
    return make("p", { class: "field" }, make("label", { class: "switch" }, input, name));
}

export function button(name: string, act: () => void): HTMLButtonElement {
    const made = make("button", { type: "button" }, name);
    made.addEventListener("click", act);
    return made;
}

/** Creates a collapsible part of the panel. */
export function group(title: string, open: boolean, ...content: HTMLElement[]): HTMLElement {
    return make("details", open ? { open: "" } : {}, make("summary", {}, title), ...content);
}
