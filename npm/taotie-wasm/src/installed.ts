// The program in the package's folder.

import { readFile } from "node:fs/promises";
import { PROGRAM, compiled, once } from "./program.js";

/** Reads and compiles the program. */
export const program = once(async () => {
    const { buffer, byteOffset, byteLength } = await readFile(new URL(`./${PROGRAM}`, import.meta.url));
    return compiled(buffer.slice(byteOffset, byteOffset + byteLength) as ArrayBuffer);
});
