// The parts of the viewer: a line above the picture, the picture, and lines below it, so that nothing covers the model.

import { make } from "./dom";
import { texts } from "./texts";

export class Layout {
    /** The title and the button for the controls. */
    readonly head = make("header", { class: "head" });
    readonly canvas = make("canvas", { tabindex: "0", role: "application" });
    /** The canvas and what is drawn on it. */
    readonly picture = make("div", { class: "picture" }, this.canvas);
    readonly message = make("p", { class: "message", role: "status" });
    /** Messages, legend and positions. */
    readonly foot = make("footer", { class: "foot" }, this.message);
    private still: HTMLImageElement | undefined;

    constructor(readonly root: HTMLElement) {
        root.replaceChildren(this.head, this.picture, this.foot);
    }

    /** Adds the title, as the page's heading if the page has none. */
    name(title: string): void {
        this.canvas.setAttribute("aria-label", texts.canvas(title));
        this.head.append(make(document.querySelector("h1") ? "p" : "h1", { class: "title" }, title));
    }

    /** Shows a message below the picture. */
    say(text: string): void {
        this.message.setAttribute("role", "status");
        this.message.textContent = text;
    }

    /** Explains why the model cannot be drawn, next to a still picture of it if there is one. */
    explain(why: string, still: string | undefined): void {
        this.message.setAttribute("role", "alert");
        this.message.textContent = why;
        if (still === undefined || this.still) return;
        const image = make("img", { class: "still", alt: texts.still });
        image.addEventListener("load", () => {
            URL.revokeObjectURL(still);
            if (image !== this.still) return;
            this.canvas.hidden = true;
            this.picture.append(image);
            this.message.textContent = `${why} ${texts.stillShown}`;
        });
        image.src = still;
        this.still = image;
    }

    /** Returns from the still picture to the model. */
    resume(): void {
        this.still?.remove();
        this.still = undefined;
        this.canvas.hidden = false;
        this.say("");
    }
}
