// The package in browsers.

import { PROGRAM, compiled, once } from "./program.js";
import { Taotie } from "./taotie.js";
import { thread } from "./thread.js";

export * from "./taotie.js";

export const load = once(async () => {
    const response = await fetch(new URL(`./${PROGRAM}`, import.meta.url));
    if (!response.ok) throw new Error(`${response.url}: ${response.status} ${response.statusText}`);
    return new Taotie(await compiled(await response.arrayBuffer()), thread);
});
