// The progress of a run: stage, bar and time left.

import type { Progress } from "../../npm/taotie-wasm/src/lines.js";
import { byId } from "./dom.js";
import { sentence, time } from "./words.js";

/** The fraction of a stage to finish before its time left is estimated. */
const LEAST = 0.03;
/** Seconds between announcements to screen readers. */
const PAUSE = 10;

/** The work that is shown on the page. */
export class Work {
    private readonly start = performance.now();
    private stage = "";
    private stageStart = this.start;
    private shown = 0;
    private announced = 0;

    constructor() {
        byId("work").hidden = false;
        this.say("Starting", "");
        byId<HTMLProgressElement>("progress").removeAttribute("value");
    }

    readonly hear = ({ stage, done: fraction, left_s: left }: Progress): void => {
        if (stage !== this.stage) [this.stage, this.stageStart, this.shown] = [stage, performance.now(), left === null ? 0 : this.shown];
        const elapsed = (performance.now() - (left === null ? this.stageStart : this.start)) / 1e3;
        const rest = left ?? (fraction > LEAST ? (elapsed * (1 - fraction)) / fraction : null);
        const done = left === null ? fraction : elapsed / Math.max(elapsed + left, 1e-3);
        // A bar that goes back says nothing.
        this.shown = Math.max(this.shown, done);
        byId<HTMLProgressElement>("progress").value = this.shown;
        this.say(sentence(stage), rest === null ? "" : `About ${time(rest)} left${left === null ? " in this stage" : ""}`);
    };

    end(): void {
        byId("work").hidden = true;
    }

    private say(stage: string, left: string): void {
        byId("stage").textContent = stage;
        byId("left").textContent = left;
        const now = (performance.now() - this.start) / 1e3;
        if (now - this.announced < PAUSE) return;
        this.announced = now;
        byId("status").textContent = [stage, left].filter(Boolean).join(". ");
    }
}
