// The legend of the errors, and the value under the pointer.

import { make } from "./dom";
import { lengthText } from "./lengths";
import { messageOf } from "./report";
import { texts } from "./texts";
import type { Viewer } from "./viewer";

/** Creates the legend, which is visible while errors are shown. */
export function legend(viewer: Viewer): HTMLElement | undefined {
    const { errors, in_metres } = viewer.data;
    if (!errors) return undefined;
    const bar = make("div", { class: "bar" });
    bar.style.background = `linear-gradient(to right, ${errors.stops.map((stop) => `rgb(${stop.join()})`).join()})`;
    const here = make("output", {}, "");
    const { distance } = errors;
    const shape = distance && texts.shape(lengthText(distance.rms, in_metres), lengthText(distance.hausdorff, in_metres));
    const all = make(
        "div",
        { class: "legend" },
        bar,
        make("p", { class: "ends" }, make("span", {}, texts.degrees(0)), here, make("span", {}, texts.atLeast(errors.top))),
        make("p", { class: "text" }, texts.legend(errors.quantity, errors.top, errors.mean)),
        ...(shape ? [make("p", { class: "text" }, shape)] : []),
    );
    viewer.listen(({ mode }) => void (all.hidden = mode !== "error"));
    let asked = 0;
    viewer.canvas.addEventListener("pointermove", (event) => {
        if (viewer.state.mode !== "error" || event.buttons) return;
        cancelAnimationFrame(asked);
        asked = requestAnimationFrame(() => {
            const found = viewer.errorUnder(event.clientX, event.clientY);
            void found.then(texts.errorHere, messageOf).then((text) => void (here.textContent = text));
        });
    });
    return all;
}
