#!/usr/bin/env node
// The command in Node, on the files of the machine: `npx taotie bake scan.ply -o scan.glb`.
//
// A second process does the work, so that a signal ends it at once; this one then removes what is unfinished.

import { spawn } from "node:child_process";
import { rmSync } from "node:fs";
import { constants } from "node:os";
import { fileURLToPath } from "node:url";

/** The folders of unfinished sets of files. */
const UNFINISHED = /[/\\]\.taotie-[^/\\]*\.part$/;

const program = fileURLToPath(new URL("./machine.js", import.meta.url));
const child = spawn(process.execPath, [program, ...process.argv.slice(2)], { stdio: ["inherit", "inherit", "inherit", "ipc"] });

const folders: string[] = [];
// Folders that the command has created.
child.on("message", (folder: string) => UNFINISHED.test(folder) && folders.push(folder));
for (const signal of ["SIGINT", "SIGTERM"] as const) process.on(signal, () => child.kill(signal));
child.on("close", (code, signal) => {
    if (signal) for (const folder of folders) rmSync(folder, { recursive: true, force: true });
    process.exitCode = code ?? 128 + constants.signals[signal!];
});
