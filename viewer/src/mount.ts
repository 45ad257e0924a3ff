// Adds a viewer and its controls to an element.

import { bookmarks } from "./bookmarks";
import { button } from "./controls";
import type { Data } from "./data";
import { make, save } from "./dom";
import { listenToGestures } from "./gestures";
import type { Address, Source } from "./host";
import { listenToKeys } from "./keys";
import { Layout } from "./layout";
import { legend } from "./legend";
import { Measure } from "./measure";
import { panel } from "./panel";
import { messageOf, report } from "./report";
import { Stage } from "./stage";
import { texts } from "./texts";
import { Viewer } from "./viewer";
import { sides, wipe } from "./wipe";

/** Milliseconds that a browser has to restore lost graphics resources before the viewer reports that it cannot draw. */
const PATIENCE = 10_000;
/** The width below which controls are initially hidden, pixels. */
const NARROW = 704;

/** The host of a viewer. */
export interface Host {
    /** The element in the page; its `data-state` is the condition of the viewer. */
    element: HTMLElement;
    /** The root of its content. */
    root: HTMLElement;
    source: Source;
    address: Address | undefined;
    /** True if controls are initially hidden. */
    isFolded: boolean;
    /** False once another model has replaced this one. */
    isCurrent(): boolean;
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

function build(host: Host, viewer: Viewer, layout: Layout): void {
    const drags = new DragsLight();
    const measure = new Measure(viewer);
    const copyLink = (): void => {
        const copied = navigator.clipboard?.writeText(location.href) ?? Promise.reject();
        copied.then(() => layout.say(texts.linked)).catch(() => layout.say(texts.notLinked));
    };
    const savePicture = async (): Promise<void> => {
        await viewer.picture().then(
            (png) => save(`${viewer.data.title}.png`, png),
            (error: unknown) => layout.say(messageOf(error)),
        );
    };
    const actions = {
        movesLight: drags.get,
        toggleLight: drags.toggle,
        reset: () => viewer.move(viewer.first),
        save: () => void savePicture(),
        copyLink: host.address && copyLink,
        light: drags.element,
        measure: measure.panel,
        bookmarks: bookmarks(viewer, `${host.source.key}|${viewer.data.title}`),
    };
    listenToGestures(viewer, drags.get);
    listenToKeys(viewer, actions);
    layout.head.append(folder(host));
    layout.picture.before(sides(viewer));
    layout.picture.append(measure.element, wipe(viewer));
    const errors = legend(viewer);
    if (errors) layout.foot.append(errors);
    layout.foot.append(places(viewer));
    layout.root.append(panel(viewer, actions));
}

/** Shows why the model cannot be drawn, and reports it to the page. */
function fail(host: Host, layout: Layout, error: unknown): void {
    if (!host.isCurrent()) return;
    host.element.dataset["state"] = "failed";
    const why = texts.failed(messageOf(error));
    layout.explain(why, host.source.still());
    report(host.element, why, error);
}

/** Keeps the state while the browser has taken the graphics resources away, and draws it when they are back. */
function watchContext(host: Host, viewer: Viewer, layout: Layout): void {
    let timer = 0;
    layout.canvas.addEventListener("webglcontextlost", (event) => {
        // Otherwise the browser does not restore it.
        event.preventDefault();
        if (!host.isCurrent()) return;
        viewer.lose();
        host.element.dataset["state"] = "loading";
        layout.say(texts.lost);
        timer = window.setTimeout(() => fail(host, layout, new Error(texts.notRestored)), PATIENCE);
    });
    layout.canvas.addEventListener("webglcontextrestored", () => {
        clearTimeout(timer);
        layout.resume();
        viewer.restore();
    });
}

/** Loads the data and shows it; undefined on failure, which the element reports. */
export async function mount(host: Host): Promise<Viewer | undefined> {
    const { element, root, source } = host;
    element.dataset["state"] = "loading";
    const layout = new Layout(root);
    layout.say(texts.loading);
    try {
        const data = JSON.parse(new TextDecoder().decode(await source.blobs("data"))) as Data;
        layout.name(data.title);
        const viewer = new Viewer(await Stage.load(layout.canvas, data, source.blobs), host, layout.canvas);
        // After the listeners of three.js, which create what a new context lacks.
        watchContext(host, viewer, layout);
        layout.say("");
        build(host, viewer, layout);
        viewer.request();
        return viewer;
    } catch (error) {
        fail(host, layout, error);
        return undefined;
    }
}
