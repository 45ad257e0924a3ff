// What the command in Node and its thread say to each other.

import type { Progress } from "./lines.js";

/** The work of the thread. */
export interface Task {
    module: WebAssembly.Module;
    args: string[];
    /** One of the states, which both sides change. */
    state: Int32Array<SharedArrayBuffer>;
}

export const STATE = { working: 0, stopped: 1, placing: 2 };

/** A message of the thread: a folder that the program has created, relative to the current one, progress, a line of
 * stderr, the end. */
export type Report = { folder: string } | { progress: Progress } | { line: string } | { code: number } | { trap: string; stderr: string };
