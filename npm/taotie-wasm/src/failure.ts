// The errors of a run, in words.

import type { Ended } from "./job.js";

/** A run that failed: `message` states why, `stderr` is everything that the command reported. */
export class TaotieError extends Error {
    override readonly name = "TaotieError";

    constructor(
        message: string,
        /** The exit code; 101 if the program stopped in mid-work. */
        readonly code: number,
        readonly stderr: string,
    ) {
        super(message);
    }
}

/** The exit code of a program that panicked. */
export const PANIC = 101;

const OUT_OF_MEMORY = /memory allocation of (\d+) bytes failed|out of memory|capacity overflow/i;
const PANICKED = /panicked at ([^\n]*)\n?([^\n]*)/;

/** Returns why a program stopped in mid-work. */
export function reasonOf(trap: string, stderr: string): string {
    if (OUT_OF_MEMORY.test(stderr) || OUT_OF_MEMORY.test(trap)) {
        return "out of memory: WebAssembly has at most 4 GB, and the browser may allow less. Use a smaller scan or smaller maps, or the native program";
    }
    const [, where, what] = PANICKED.exec(stderr) ?? [];
    if (where !== undefined) return `an error in Taotie itself; please report it: ${what || "panic"} (${where.replace(/:$/, "")})`;
    return `the program stopped: ${trap}`;
}

/** Returns the error of a run that failed; undefined if it ended as it should. */
export function failureOf({ code, trap, stderr }: Ended): TaotieError | undefined {
    if (trap !== undefined) return new TaotieError(reasonOf(trap, stderr), PANIC, stderr);
    if (code === undefined || code < 2) return undefined;
    const line = stderr.split("\n").findLast((line) => /^(taotie: )?error: /.test(line));
    const message = line ? stderr.slice(stderr.lastIndexOf(line)) : stderr;
    return new TaotieError(message.replace(/^(taotie: )?error: /, "").trim() || `exit code ${code}`, code, stderr);
}
