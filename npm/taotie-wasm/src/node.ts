// The package in Node.

import { Worker } from "node:worker_threads";
import { program } from "./installed.js";
import { once } from "./program.js";
import { Taotie, type Thread } from "./taotie.js";
import source from "worker:web";

export * from "./taotie.js";

function thread(): Thread {
    const worker = new Worker(source, { eval: true });
    return {
        post: (job) => worker.postMessage(job),
        listen: (heard, failed) => {
            worker.on("message", heard);
            worker.on("error", failed);
        },
        terminate: () => void worker.terminate(),
    };
}

export const load = once(async () => new Taotie(await program(), thread));
