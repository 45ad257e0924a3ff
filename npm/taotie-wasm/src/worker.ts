// The worker: does one job and reports its progress and its end. It runs in browsers, and as a thread of Node.

import { type Ended, type Job, type Message, run } from "./job.js";
import { messageOf } from "./lines.js";

interface Port {
    post(message: Message, transfer: ArrayBuffer[]): void;
    listen(heard: (job: Job) => void): void;
}

declare const require: (name: string) => typeof import("node:worker_threads");

function port(): Port {
    if (typeof self !== "undefined" && "postMessage" in self) {
        return {
            post: (message, transfer) => self.postMessage(message, { transfer }),
            listen: (heard) => void (self.onmessage = ({ data }) => heard(data)),
        };
    }
    const parent = require("node:worker_threads").parentPort!;
    return { post: (message, transfer) => parent.postMessage(message, transfer), listen: (heard) => void parent.once("message", heard) };
}

const own = port();

own.listen((job) => {
    const end = (ended: Ended): void => own.post({ ended }, Object.values(ended.files).map(({ buffer }) => buffer));
    const fail = (error: unknown): void => end({ trap: messageOf(error), stdout: "", stderr: "", files: {} });
    run(job, (progress) => own.post({ progress }, [])).then(end, fail);
});
