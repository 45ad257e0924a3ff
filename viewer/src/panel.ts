// The panel next to the picture.

import { button, choice, group, range, toggle } from "./controls";
import { make } from "./dom";
import { BEST, FIXED, LIGHTS, TONES, besides, modes } from "./fields";
import { refixed } from "./light";
import { texts } from "./texts";
import type { Viewer } from "./viewer";

/** The actions of the buttons. */
export interface Buttons {
    reset(): void;
    /** Undefined if no address keeps the link. */
    copyLink: (() => void) | undefined;
    save(): void;
    /** The switch for what a drag moves. */
    light: HTMLElement;
    /** The part of the panel for measuring. */
    measure: HTMLElement;
    bookmarks: HTMLElement;
}

const TURN = { low: -180, high: 180, step: 0.5, text: texts.degrees };
const factor = (high: number) => ({ low: 0, high, step: 0.01, text: (value: number) => value.toFixed(2) });

function surface(viewer: Viewer): HTMLElement {
    const { data } = viewer;
    const shadings = data.shadings.map((value) => ({ value, name: value }));
    // A method without a map on any surface is drawn smooth.
    const lacks = (number: number) => data.models[0]!.surfaces.every(({ drawn }) => drawn[number] !== number);
    const methods = data.methods.map((value, number) => {
        return { value, name: value + (lacks(number) ? texts.lacking : ""), disabled: lacks(number) };
    });
    const best = { value: BEST, name: texts.best };
    const named = data.errors?.quantity === "uncertainty" ? { ...texts.modes, error: texts.uncertainty } : texts.modes;
    const shown = modes(data).map((value) => ({ value, name: named[value] ?? value }));
    const contents = besides(data).map((value) => ({ value, name: texts.besides[value] ?? value }));
    return group(
        texts.surface,
        true,
        choice(viewer, texts.mode, shown, { get: ({ mode }) => mode, set: (mode) => ({ mode }) }),
        choice(viewer, texts.shading, shadings, { get: ({ shading }) => shading, set: (shading) => ({ shading }) }),
        choice(viewer, texts.method, [best, ...methods], {
            get: ({ surface }) => surface,
            set: (surface) => ({ surface }),
        }),
        choice(viewer, texts.beside, contents, { get: (state) => state.beside, set: (beside) => ({ beside }) }),
        toggle(viewer, texts.wireframe, { get: ({ wireframe }) => wireframe, set: (wireframe) => ({ wireframe }) }),
        ...(data.rays === null ? [] : [toggle(viewer, texts.rays, { get: ({ rays }) => rays, set: (rays) => ({ rays }) })]),
    );
}

/** The part of the panel for the raking light. */
function raking(viewer: Viewer): HTMLElement {
    const all = make(
        "div",
        {},
        range(viewer, texts.azimuth, TURN, {
            get: ({ from }) => from[0],
            set: (azimuth, { from }) => ({ from: [azimuth, from[1]] }),
        }),
        range(viewer, texts.elevation, { ...TURN, low: -90, high: 90 }, {
            get: ({ from }) => from[1],
            set: (elevation, { from }) => ({ from: [from[0], elevation] }),
        }),
        range(viewer, texts.strength, factor(10), { get: ({ strength }) => strength, set: (strength) => ({ strength }) }),
        range(viewer, texts.fill, factor(1), { get: ({ fill }) => fill, set: (fill) => ({ fill }) }),
        toggle(viewer, texts.shadows, { get: ({ shadows }) => shadows, set: (shadows) => ({ shadows }) }),
        choice(viewer, texts.fixed, FIXED.map((value) => ({ value, name: texts.fixedTo[value]! })), {
            get: ({ fixed }) => fixed,
            set: (fixed) => refixed(viewer.state, fixed),
        }),
    );
    viewer.listen(({ light }) => void (all.hidden = light !== "raking"));
    return all;
}

function light(viewer: Viewer, drag: HTMLElement): HTMLElement {
    const kinds = LIGHTS.map((value) => ({ value, name: texts.lights[value]! }));
    const all = [
        choice(viewer, texts.lightKind, kinds, { get: ({ light }) => light, set: (light) => ({ light }) }),
        drag,
        raking(viewer),
    ];
    if (viewer.data.light.environment) {
        const turn = range(viewer, `${texts.environment}: ${texts.turn.toLowerCase()}`, TURN, {
            get: ({ environment }) => environment[0],
            set: (degrees, { environment }) => ({ environment: [degrees, environment[1]] }),
        });
        const strength = range(viewer, `${texts.environment}: ${texts.strength.toLowerCase()}`, factor(4), {
            get: ({ environment }) => environment[1],
            set: (times, { environment }) => ({ environment: [environment[0], times] }),
        });
        all.push(turn, strength);
    }
    return group(texts.light, true, ...all);
}

function picture(viewer: Viewer): HTMLElement {
    return group(
        texts.picture,
        false,
        range(viewer, texts.exposure, { low: -4, high: 4, step: 0.1, text: texts.stops }, {
            get: ({ exposure }) => exposure,
            set: (exposure) => ({ exposure }),
        }),
        choice(viewer, texts.tone, TONES.map((value) => ({ value, name: value })), {
            get: ({ tone }) => tone,
            set: (tone) => ({ tone }),
        }),
    );
}

function list(pairs: [string, string][]): HTMLElement {
    const rows = pairs.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value)));
    return make("dl", {}, ...rows);
}

/** The panel of a viewer. */
export function panel(viewer: Viewer, buttons: Buttons): HTMLElement {
    const { facts, version } = viewer.data;
    const actions = make(
        "p",
        { class: "actions" },
        button(texts.reset, buttons.reset),
        ...(buttons.copyLink ? [button(texts.link, buttons.copyLink)] : []),
        button(texts.screenshot, buttons.save),
    );
    const about = list(facts.map(({ name, value }) => [name, value]));
    return make(
        "section",
        { id: "panel", "aria-label": texts.controls },
        surface(viewer),
        light(viewer, buttons.light),
        picture(viewer),
        buttons.measure,
        buttons.bookmarks,
        actions,
        group(texts.about, true, about),
        group(texts.keys, false, list(texts.keyList)),
        make("p", { class: "made" }, texts.made(version)),
    );
}
