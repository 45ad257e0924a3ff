// Adds a viewer and its controls to an element.

import { button } from "./controls";
import type { Data } from "./data";
import { make, save } from "./dom";
import { listenToGestures } from "./gestures";
import type { Address, Blobs } from "./host";
import { listenToKeys } from "./keys";
import { legend } from "./legend";
import { Measure } from "./measure";
import { panel } from "./panel";
import { Stage } from "./stage";
import { texts } from "./texts";
import { Viewer } from "./viewer";
import { wipe } from "./wipe";

/** The width below which controls are initially hidden, pixels. */
const NARROW = 704;

/** The host of a viewer. */
export interface Host {
    /** The element in the page; its `data-state` is the condition of the viewer. */
    element: HTMLElement;
    /** The root of its content. */
    root: HTMLElement;
    blobs: Blobs;
    address: Address | undefined;
    /** True if controls are initially hidden. */
    isFolded: boolean;
}

function say(root: HTMLElement, text: string): HTMLElement {
    const line = make("p", { class: "message", role: "status" }, text);
    root.append(line);
    return line;
}

/** A switch for what a plain drag moves. */
class DragsLight {
    private on = false;
    readonly button = button(texts.dragLight, () => this.toggle());
    readonly element = make("p", { class: "field" }, this.button);

    constructor() {
        this.button.setAttribute("aria-pressed", "false");
    }

    readonly get = (): boolean => this.on;

    readonly toggle = (): void => {
        this.on = !this.on;
        this.button.setAttribute("aria-pressed", String(this.on));
    };
}

/** The positions of camera and light, announced when they stop changing. */
function places(viewer: Viewer): HTMLElement {
    const line = make("p", { class: "places", role: "status" });
    let timer = 0;
    viewer.listen(({ view, light, from }) => {
        const parts = [texts.viewPlace(view[0], view[1])];
        if (light === "raking") parts.push(texts.lightPlace(...from));
        clearTimeout(timer);
        timer = window.setTimeout(() => void (line.textContent = parts.join(" · ")), 200);
    });
    return line;
}

/** The button that hides and shows the panel. */
function folder({ element, root, isFolded }: Host): HTMLButtonElement {
    const made = button(texts.close, () => fold(!root.classList.contains("folded")));
    made.className = "fold";
    made.setAttribute("aria-controls", "panel");
    const fold = (folded: boolean): void => {
        root.classList.toggle("folded", folded);
        made.textContent = folded ? texts.open : texts.close;
        made.setAttribute("aria-expanded", String(!folded));
    };
    fold(isFolded || element.clientWidth < NARROW);
    return made;
}

function build(host: Host, viewer: Viewer): void {
    const { root } = host;
    const drags = new DragsLight();
    const measure = new Measure(viewer);
    const message = say(root, "");
    const announce = (text: string): void => void (message.textContent = text);
    const copyLink = (): void => {
        const copied = navigator.clipboard?.writeText(location.href) ?? Promise.reject();
        copied.then(() => announce(texts.linked)).catch(() => announce(texts.notLinked));
    };
    const actions = {
        movesLight: drags.get,
        toggleLight: drags.toggle,
        reset: () => viewer.show(viewer.first),
        save: () => void viewer.picture().then((png) => save(`${viewer.data.title}.png`, png)),
        copyLink: host.address && copyLink,
        light: drags.element,
        measure: measure.panel,
    };
    listenToGestures(viewer, drags.get);
    listenToKeys(viewer, actions);
    root.append(measure.element, wipe(viewer), folder(host), panel(viewer, actions), places(viewer));
    const errors = legend(viewer);
    if (errors) root.append(errors);
}

/** The title, as the page's heading if the page has none. */
function heading(title: string): HTMLElement {
    return make(document.querySelector("h1") ? "p" : "h1", { class: "title" }, title);
}

/** Loads the data and shows it; undefined on failure, which the element reports. */
export async function mount(host: Host): Promise<Viewer | undefined> {
    const { element, root, blobs } = host;
    element.dataset["state"] = "loading";
    const canvas = make("canvas", { tabindex: "0", role: "application" });
    root.replaceChildren(canvas);
    const message = say(root, texts.loading);
    const fail = (error: unknown): void => {
        element.dataset["state"] = "failed";
        message.setAttribute("role", "alert");
        message.textContent = texts.failed(error instanceof Error ? error.message : String(error));
        if (!message.isConnected) root.append(message);
    };
    canvas.addEventListener("webglcontextlost", () => fail(new Error(texts.lost)));
    try {
        const data = JSON.parse(new TextDecoder().decode(await blobs("data"))) as Data;
        canvas.setAttribute("aria-label", texts.canvas(data.title));
        canvas.before(heading(data.title));
        const viewer = new Viewer(await Stage.load(canvas, data, blobs), host, canvas);
        message.remove();
        build(host, viewer);
        viewer.request();
        return viewer;
    } catch (error) {
        fail(error);
        return undefined;
    }
}
