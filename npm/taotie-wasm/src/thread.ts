// A worker of a page.

import type { Thread } from "./taotie.js";
import source from "worker:web";

let url: string | undefined;

/** Starts a worker of the page. A Blob works from every origin, and in pages from disk. */
export function thread(): Thread {
    url ??= URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    const worker = new Worker(url);
    return {
        post: (job) => worker.postMessage(job),
        listen: (heard, failed) => {
            worker.onmessage = ({ data }) => heard(data);
            worker.onmessageerror = () => failed(new Error("the browser could not pass the result on"));
            worker.onerror = (event) => failed(new Error(event.message || "the worker could not be started"));
        },
        terminate: () => worker.terminate(),
    };
}
