// The wipe handle over the picture.

import { make } from "./dom";
import { texts } from "./texts";
import type { Viewer } from "./viewer";

/** The fraction of the width by which a key press moves the handle. */
const STEP = 0.02;

const sideNames = (content: string): [string, string] => texts.sides[content] ?? ["", ""];

/** Creates the line above the picture that names what is left and right of the handle. */
export function sides(viewer: Viewer): HTMLElement {
    const [left, right] = [make("span"), make("span")];
    // The handle states the same to assistive technology.
    const line = make("p", { class: "sides", "aria-hidden": "true" }, left, right);
    viewer.listen(({ beside: content, split }) => {
        line.hidden = content === "none";
        [left.textContent, right.textContent] = sideNames(content);
        line.style.gridTemplateColumns = `minmax(0, ${split}fr) minmax(0, ${1 - split}fr)`;
    });
    return line;
}

/** Creates the handle, which is visible while something is shown next to the model. */
export function wipe(viewer: Viewer): HTMLElement {
    const handle = make("div", { class: "wipe", role: "slider", tabindex: "0", "aria-label": texts.wipe });
    handle.setAttribute("aria-valuemin", "0");
    handle.setAttribute("aria-valuemax", "100");
    const { canvas } = viewer;
    const put = (): void => {
        const { beside: content, split } = viewer.state;
        handle.hidden = content === "none";
        handle.style.left = `${split * 100}%`;
        handle.setAttribute("aria-valuenow", String(Math.round(split * 100)));
        handle.setAttribute("aria-valuetext", texts.wiped(split, sideNames(content)));
    };
    viewer.listen(put);
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const { left, width } = canvas.getBoundingClientRect();
        viewer.move({ split: (event.clientX - left) / width });
    });
    handle.addEventListener("keydown", (event) => {
        const { split } = viewer.state;
        const places: Record<string, number> = {
            ArrowLeft: split - STEP,
            ArrowRight: split + STEP,
            Home: 0,
            End: 1,
        };
        const to = places[event.key];
        if (to === undefined) return;
        event.preventDefault();
        viewer.move({ split: to });
    });
    return handle;
}
