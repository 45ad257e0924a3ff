// The line of progress on a terminal.

import type { WriteStream } from "node:tty";
import type { Progress } from "./lines.js";

const ERASE = "\r\x1b[K";

/** Returns a duration in words. */
function words(seconds: number): string {
    const whole = Math.max(1, Math.round(seconds));
    return whole < 90 ? `${whole} s` : `${Math.round(whole / 60)} min`;
}

/** A line that each progress replaces; nothing without a terminal. */
export class Line {
    private isShown = false;

    constructor(private readonly stream: WriteStream) {}

    show({ stage, fraction, left }: Progress): void {
        if (!this.stream.isTTY) return;
        const rest = left === null ? "" : `, ${words(left)} left`;
        this.stream.write(`${ERASE}${stage} ${Math.floor(fraction * 100)} %${rest}`);
        this.isShown = true;
    }

    print(text: string): void {
        this.clear();
        this.stream.write(`${text}\n`);
    }

    clear(): void {
        if (this.isShown) this.stream.write(ERASE);
        this.isShown = false;
    }
}
