// The wipe handle over the picture.

import { make } from "./dom";
import { texts } from "./texts";
import type { Viewer } from "./viewer";

/** The fraction of the width by which a key press moves the handle. */
const STEP = 0.02;

/** Creates the handle, which is visible while something is shown next to the model. */
export function wipe(viewer: Viewer): HTMLElement {
    const handle = make("div", { class: "wipe", role: "slider", tabindex: "0", "aria-label": texts.wipe });
    handle.setAttribute("aria-valuemin", "0");
    handle.setAttribute("aria-valuemax", "100");
    const { canvas } = viewer;
    const put = (): void => {
        const { beside, split } = viewer.state;
        handle.hidden = beside === "none";
        handle.style.left = `${split * canvas.clientWidth}px`;
        handle.setAttribute("aria-valuenow", String(Math.round(split * 100)));
        handle.setAttribute("aria-valuetext", texts.wiped(split));
    };
    viewer.listen(put);
    new ResizeObserver(put).observe(canvas);
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const { left, width } = canvas.getBoundingClientRect();
        viewer.change({ split: (event.clientX - left) / width });
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
        viewer.change({ split: to });
    });
    return handle;
}
