// The thread of the command in Node: the program with Node's own WASI.

import path from "node:path";
import { WASI } from "node:wasi";
import { parentPort, workerData } from "node:worker_threads";
import { ENVIRONMENT, Lines, progressOf } from "./lines.js";
import { type Report, STATE, type Task } from "./task.js";

const { module, args, state } = workerData as Task;
const STDERR = 2;
const send = (report: Report): void => parentPort!.postMessage(report);

/** Returns the folders that the program may use: the current one and those around it, by relative path. */
function folders(): Record<string, string> {
    const found: Record<string, string> = {};
    let [name, folder] = [".", process.cwd()];
    for (; folder !== path.dirname(folder); folder = path.dirname(folder)) {
        found[name] = folder;
        name = name === "." ? ".." : `../${name}`;
    }
    return { ...found, [name]: folder };
}

/** Makes an absolute path relative, also as the value of an option: WASI's programs do not tell `/a` from `a`. */
function local(argument: string): string {
    const [, option, value] = /^(-[^=]*=)?(.*)$/s.exec(argument)!;
    if (!path.isAbsolute(value!)) return argument;
    return `${option ?? ""}${path.relative("", value!).replaceAll(path.sep, "/") || "."}`;
}

const env = { ...process.env, ...Object.fromEntries([ENVIRONMENT.split("=")]) };
const wasi = new WASI({ version: "preview1", args: ["taotie", ...args.map(local)], env, preopens: folders() });
const imports = wasi.wasiImport as Record<string, (...numbers: number[]) => number>;
const messages: string[] = [];
const stderr = new Lines((line) => {
    const progress = progressOf(line);
    if (!progress) messages.push(line);
    send(progress ? { progress } : { line });
});
let memory: WebAssembly.Memory;

/** Takes what the program writes to stderr. */
function write(parts: number, count: number, written: number): number {
    const view = new DataView(memory.buffer);
    let all = 0;
    for (let at = parts; at < parts + 8 * count; at += 8) {
        const [start, length] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
        stderr.add(new Uint8Array(memory.buffer, start, length));
        all += length;
    }
    view.setUint32(written, all, true);
    return 0;
}

/** Waits for the end if the command has been stopped; from now on it cannot be. */
function place(): void {
    if (Atomics.compareExchange(state, 0, STATE.working, STATE.placing) === STATE.stopped) Atomics.wait(state, 0, STATE.stopped);
}

const watched = {
    ...imports,
    fd_write: (fd: number, parts: number, count: number, written: number) =>
        fd === STDERR ? write(parts, count, written) : imports["fd_write"]!(fd, parts, count, written),
    path_create_directory: (fd: number, start: number, length: number) => {
        send({ folder: new TextDecoder().decode(new Uint8Array(memory.buffer, start, length)) });
        return imports["path_create_directory"]!(fd, start, length);
    },
    path_rename: (...numbers: number[]) => {
        place();
        return imports["path_rename"]!(...numbers);
    },
};

try {
    const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: watched });
    memory = instance.exports["memory"] as WebAssembly.Memory;
    const code = wasi.start(instance) as unknown as number;
    stderr.end();
    send({ code });
} catch (error) {
    stderr.end();
    send({ trap: error instanceof Error ? error.message : String(error), stderr: messages.join("\n") });
}
