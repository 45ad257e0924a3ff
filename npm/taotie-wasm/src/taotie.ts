// The command as functions. Each run has a worker, so that it can be cancelled and its memory is freed.

import { type Options, toArguments } from "./arguments.js";
import { failureOf } from "./failure.js";
import type { Ended, Job, Message } from "./job.js";
import type { Progress } from "./lines.js";

export type { Options, OptionValue } from "./arguments.js";
export { TaotieError } from "./failure.js";
export type { Progress } from "./lines.js";

/** A file in memory. */
export type FileData = Uint8Array | ArrayBuffer | Blob | string;

/** The files and the course of a run. */
export interface Running {
    /** The files that the command reads, by path. */
    files?: Readonly<Record<string, FileData>>;
    /** Receives the progress. */
    onProgress?: (progress: Progress) => void;
    /** Cancels the run, which is rejected with the signal's reason, an `AbortError`. */
    signal?: AbortSignal;
}

/** The result of a run. */
export interface Result<Printed = unknown> {
    /** 0 success, 1 a requirement that is not met or a difference above the given limit, 2 an error. */
    code: number;
    /** What the command printed: the parsed JSON with `--json`, otherwise text. */
    stdout: Printed;
    /** Messages and warnings. */
    stderr: string;
    /** The files that the command wrote, by path. */
    files: Record<string, Uint8Array<ArrayBuffer>>;
}

/** The report of a command, as JSON: docs/json.md. */
export type Report = Record<string, unknown>;

/** A worker, in a browser or Node. @internal */
export interface Thread {
    post(job: Job): void;
    /** Calls back with each message, or with an error that ended the worker. */
    listen(heard: (message: Message) => void, failed: (error: Error) => void): void;
    terminate(): void;
}

function bytesOf(file: FileData): ArrayBuffer | Blob {
    if (file instanceof Blob || file instanceof ArrayBuffer) return file;
    const bytes = typeof file === "string" ? new TextEncoder().encode(file) : file;
    // The bytes of a view, not those around it.
    return bytes.slice().buffer as ArrayBuffer;
}

function resultOf({ code, stdout, stderr, files }: Ended, args: readonly string[]): Result {
    const isJson = args.includes("--json") && stdout !== "";
    return { code: code!, stdout: isJson ? JSON.parse(stdout) : stdout, stderr, files };
}

/** The command. */
export class Taotie {
    /** @internal */
    constructor(
        private readonly module: WebAssembly.Module,
        private readonly start: () => Thread,
    ) {}

    /**
     * Runs the command with these arguments, as in a shell: `["bake", "scan.ply", "-o", "scan.glb"]`.
     * Rejected only if it is cancelled, or if the program stops in mid-work, for want of memory for instance.
     */
    async run(args: readonly string[], running: Running = {}): Promise<Result> {
        const ended = await this.work(args, running);
        const failure = ended.trap === undefined ? undefined : failureOf(ended);
        if (failure) throw failure;
        return resultOf(ended, args);
    }

    /** Bakes a scan: `bake("scan.ply", { output: "scan.glb", triangles: 2000 }, { files })`. */
    readonly bake = this.command("bake");
    /** Compares an asset with its scan: `verify("asset.glb", { scan: "scan.ply" }, { files })`. */
    readonly verify = this.command("verify");
    /** Renders a model: `render("asset.glb", { output: "asset.png" }, { files })`. */
    readonly render = this.command("render");
    /** Lists the content of a model: `inspect("asset.glb", {}, { files })`. */
    readonly inspect = this.command("inspect");

    /** A subcommand that prints its report as JSON; errors of the command are rejected as a `TaotieError`. */
    private command(name: string) {
        return async (input: string, options: Options = {}, running: Running = {}): Promise<Result<Report>> => {
            const args = [name, ...toArguments({ ...options, json: true }), "--", input];
            const ended = await this.work(args, running);
            const failure = failureOf(ended);
            if (failure) throw failure;
            return resultOf(ended, args) as Result<Report>;
        };
    }

    private work(args: readonly string[], { files = {}, onProgress, signal }: Running): Promise<Ended> {
        const job = { module: this.module, args: [...args], files: mapped(files, bytesOf) };
        return new Promise<Ended>((done, failed) => {
            signal?.throwIfAborted();
            const thread = this.start();
            const end = (act: () => void): void => {
                thread.terminate();
                signal?.removeEventListener("abort", cancel);
                act();
            };
            const cancel = (): void => end(() => failed(signal!.reason));
            signal?.addEventListener("abort", cancel);
            const heard = (message: Message): void => {
                if ("progress" in message) onProgress?.(message.progress);
                else end(() => done(message.ended));
            };
            thread.listen(heard, (error) => end(() => failed(error)));
            thread.post(job);
        });
    }
}

const mapped = <A, B>(record: Readonly<Record<string, A>>, act: (value: A) => B): Record<string, B> =>
    Object.fromEntries(Object.entries(record).map(([name, value]) => [name, act(value)]));

/** Loads the command once; later calls return the same. */
export declare function load(): Promise<Taotie>;
