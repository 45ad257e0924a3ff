// Runs the command once, on files in memory.

import { ConsoleStdout, File, OpenFile, PreopenDirectory, WASI, wasi as definitions } from "@bjorn3/browser_wasi_shim";
import { type Bytes, changedFiles, folderOf } from "./folders.js";
import { importsOf } from "./imports.js";
import { Lines, OPTION, type Progress, messageOf, progressOf } from "./lines.js";

/** A run of the command. */
export interface Job {
    module: WebAssembly.Module;
    args: string[];
    files: Record<string, ArrayBuffer | Blob>;
}

/** The end of a run. */
export interface Ended {
    /** The exit code; undefined if the program stopped in mid-work, for the reason in `trap`. */
    code?: number;
    trap?: string;
    stdout: string;
    stderr: string;
    files: Record<string, Uint8Array<ArrayBuffer>>;
}

/** A message of a worker. */
export type Message = { progress: Progress } | { ended: Ended };

/** A stream that is not a terminal. */
class Stream extends ConsoleStdout {
    override fd_fdstat_get() {
        return { ret: 0, fdstat: new definitions.Fdstat(definitions.FILETYPE_UNKNOWN, 0) };
    }
}

async function read(files: Job["files"]): Promise<Bytes> {
    const bytes = async (file: ArrayBuffer | Blob) => (file instanceof Blob ? file.arrayBuffer() : file);
    return Object.fromEntries(await Promise.all(Object.entries(files).map(async ([path, file]) => [path, await bytes(file)])));
}

function start(wasi: WASI, instance: WebAssembly.Instance): Pick<Ended, "code" | "trap"> {
    try {
        return { code: wasi.start(instance as Parameters<WASI["start"]>[0]) };
    } catch (error) {
        return { trap: messageOf(error) };
    }
}

/** Runs the command; `send` receives its progress while it works. */
export async function run({ module, args, files }: Job, send: (progress: Progress) => void): Promise<Ended> {
    const given = await read(files);
    const folder = folderOf(given);
    const [printed, messages] = [[] as string[], [] as string[]];
    const stdout = new Lines((line) => printed.push(line));
    const stderr = new Lines((line) => {
        const progress = progressOf(line);
        if (progress) send(progress);
        else messages.push(line);
    });
    const output = (lines: Lines) => new Stream((bytes) => lines.add(bytes));
    const named = ["taotie", OPTION, ...args];
    // Relative and absolute paths are the same.
    const folders = [".", "/"].map((name) => new PreopenDirectory(name, folder));
    const wasi = new WASI(named, [], [new OpenFile(new File([])), output(stdout), output(stderr), ...folders], { debug: false });
    const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: importsOf(wasi) });
    const outcome = start(wasi, instance);
    stdout.end();
    stderr.end();
    const text = (lines: string[]) => lines.join("\n");
    return { ...outcome, stdout: text(printed), stderr: text(messages), files: changedFiles(folder, given) };
}
