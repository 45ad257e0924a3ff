// Begins when the page is there.

import "./viewer.css";
import { blob } from "./blobs";
import { button } from "./controls";
import type { Data } from "./data";
import { make, save } from "./dom";
import { listenToGestures } from "./gestures";
import { listenToKeys } from "./keys";
import { legend } from "./legend";
import { Measure } from "./measure";
import { panel } from "./panel";
import { Stage } from "./stage";
import { texts } from "./texts";
import { Viewer } from "./viewer";
import { wipe } from "./wipe";

declare global {
    interface Window {
        /** The viewer of the page, for scripts and tests. */
        taotie?: Viewer;
    }
}

function say(root: HTMLElement, text: string): HTMLElement {
    const line = make("p", { class: "message", role: "status" }, text);
    root.append(line);
    return line;
}

/** A switch of what a plain drag moves. */
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

/** Where camera and light are, told when the picture stands still. */
function places(viewer: Viewer): HTMLElement {
    const line = make("p", { class: "places", role: "status" });
    let timer = 0;
    viewer.listen(({ view, light, from }) => {
        const told = [texts.viewPlace(view[0], view[1])];
        if (light === "raking") told.push(texts.lightPlace(...from));
        clearTimeout(timer);
        timer = window.setTimeout(() => void (line.textContent = told.join(" · ")), 200);
    });
    return line;
}

/** The button that hides the panel and shows it. */
function folder(root: HTMLElement): HTMLButtonElement {
    const made = button(texts.close, () => fold(!root.classList.contains("folded")));
    made.className = "fold";
    made.setAttribute("aria-controls", "panel");
    const fold = (folded: boolean): void => {
        root.classList.toggle("folded", folded);
        made.textContent = folded ? texts.open : texts.close;
        made.setAttribute("aria-expanded", String(!folded));
    };
    fold(matchMedia("(max-width: 44rem)").matches);
    return made;
}

function build(root: HTMLElement, viewer: Viewer): void {
    const drags = new DragsLight();
    const measure = new Measure(viewer);
    const message = say(root, "");
    const tell = (text: string): void => void (message.textContent = text);
    const actions = {
        movesLight: drags.get,
        toggleLight: drags.toggle,
        reset: () => viewer.show(viewer.first),
        save: () => void viewer.picture().then((png) => save(`${viewer.data.title}.png`, png)),
        copyLink: () => {
            const copied = navigator.clipboard?.writeText(location.href) ?? Promise.reject();
            copied.then(() => tell(texts.linked)).catch(() => tell(texts.notLinked));
        },
        light: drags.element,
        measure: measure.panel,
    };
    listenToGestures(viewer, drags.get);
    listenToKeys(viewer, actions);
    root.append(measure.element, wipe(viewer), folder(root), panel(viewer, actions), places(viewer));
    const errors = legend(viewer);
    if (errors) root.append(errors);
}

async function main(): Promise<void> {
    const root = document.getElementById("viewer");
    if (!root) return;
    root.dataset["state"] = "loading";
    const heading = make("h1", {}, document.title);
    const canvas = make("canvas", { tabindex: "0", role: "application", "aria-label": texts.canvas(document.title) });
    root.replaceChildren(heading, canvas);
    const message = say(root, texts.loading);
    const fail = (error: unknown): void => {
        root.dataset["state"] = "failed";
        message.setAttribute("role", "alert");
        message.textContent = texts.failed(error instanceof Error ? error.message : String(error));
        if (!message.isConnected) root.append(message);
    };
    canvas.addEventListener("webglcontextlost", () => fail(new Error(texts.lost)));
    try {
        const data = JSON.parse(new TextDecoder().decode(await blob("data"))) as Data;
        const stage = await Stage.load(canvas, data);
        const viewer = new Viewer(data, stage, root, canvas);
        window.taotie = viewer;
        message.remove();
        build(root, viewer);
        viewer.request();
    } catch (error) {
        fail(error);
    }
}

void main();
