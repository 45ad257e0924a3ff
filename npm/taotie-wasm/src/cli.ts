#!/usr/bin/env node
// The command in Node, on the files of the machine: `npx taotie bake scan.ply -o scan.glb`.
//
// A thread runs the program, so that signals end it at once.

import { rmSync } from "node:fs";
import { constants } from "node:os";
import { Worker } from "node:worker_threads";
import { PANIC, reasonOf } from "./failure.js";
import { program } from "./installed.js";
import { Line } from "./line.js";
import { type Report, STATE, type Task } from "./task.js";
import source from "worker:machine";

/** The folders of unfinished sets of files. */
const UNFINISHED = /(^|\/)\.taotie-[^/]*\.part$/;

const module = await program();
const state = new Int32Array(new SharedArrayBuffer(Int32Array.BYTES_PER_ELEMENT));
const task: Task = { module, args: process.argv.slice(2), state };
// Without the warning that the interface is experimental.
const worker = new Worker(source, { eval: true, workerData: task, execArgv: ["--disable-warning=ExperimentalWarning"] });
const line = new Line(process.stderr);
const folders: string[] = [];

function exit(code: number): void {
    line.clear();
    process.exit(code);
}

/** Ends the work, unless its files are being put in place: that is finished first. */
async function stop(signal: "SIGINT" | "SIGTERM"): Promise<void> {
    if (Atomics.compareExchange(state, 0, STATE.working, STATE.stopped) === STATE.placing) return;
    await worker.terminate();
    for (const folder of folders) rmSync(folder, { recursive: true, force: true });
    exit(128 + constants.signals[signal]);
}

for (const signal of ["SIGINT", "SIGTERM"] as const) process.on(signal, () => void stop(signal));
worker.on("message", (report: Report) => {
    if ("folder" in report) UNFINISHED.test(report.folder) && folders.push(report.folder);
    else if ("progress" in report) line.show(report.progress);
    else if ("line" in report) line.print(report.line);
    else if ("code" in report) exit(report.code);
    else {
        line.print(`taotie: error: ${reasonOf(report.trap, report.stderr)}`);
        exit(PANIC);
    }
});
worker.on("error", (error) => {
    line.print(`taotie: error: ${error.message}`);
    exit(PANIC);
});
