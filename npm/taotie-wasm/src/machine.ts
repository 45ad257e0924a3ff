// The process that does the work of the command in Node.

import { type Fd, WASI } from "@bjorn3/browser_wasi_shim";
import fs from "node:fs";
import path from "node:path";
import { DiskFile, DiskFolder, tried } from "./disk.js";
import { PANIC, reasonOf } from "./failure.js";
import { importsOf, onTwoPaths } from "./imports.js";
import { program } from "./installed.js";
import { messageOf } from "./lines.js";

/** Makes an absolute path relative, also as the value of an option: the program does not tell `/a` from `a`. */
function local(argument: string): string {
    const [, option, value] = /^(-[^=]*=)?(.*)$/s.exec(argument)!;
    if (!path.isAbsolute(value!)) return argument;
    return `${option ?? ""}${path.relative("", value!).replaceAll(path.sep, "/") || "."}`;
}

/** stderr, which is remembered in case the program stops. */
class Messages extends DiskFile {
    text = "";

    override fd_write(data: Uint8Array) {
        this.text += new TextDecoder().decode(data);
        return super.fd_write(data);
    }
}

/** Reports the folders that the program creates. */
class Folder extends DiskFolder {
    override path_create_directory(name: string): number {
        process.send?.(this.at(name));
        return super.path_create_directory(name);
    }
}

let isPlacing = false;

/** Files are being put in place: that is finished first, whatever the signal. */
function place(): void {
    if (!isPlacing) for (const signal of ["SIGINT", "SIGTERM"] as const) process.on(signal, () => {});
    isPlacing = true;
}

const pathOf = ([folder, name]: [Fd, string]): string => (folder as DiskFolder).at(name);

/** The imports that act on two paths. */
function overridden(wasi: WASI) {
    const rename = onTwoPaths(wasi, (from, to) => tried(() => fs.renameSync(pathOf(from), pathOf(to))));
    const link = onTwoPaths(wasi, (from, to) => tried(() => fs.linkSync(pathOf(from), pathOf(to))));
    return {
        path_rename: (...values: Parameters<typeof rename>) => {
            place();
            return rename(...values);
        },
        path_link: (fd: number, _: number, ...rest: [number, number, number, number, number]) => link(fd, ...rest),
    };
}

function end(code: number): void {
    process.exitCode = code;
    if (process.connected) process.disconnect();
}

const args = ["taotie", ...process.argv.slice(2).map(local)];
const env = Object.entries(process.env).map((pair) => pair.join("="));
const stderr = new Messages(2, true);
const streams = [new DiskFile(0, true), new DiskFile(1, true), stderr];
const wasi = new WASI(args, env, [...streams, new Folder(process.cwd(), ".")], { debug: false });
const imports = { ...importsOf(wasi), ...overridden(wasi) };
const instance = await WebAssembly.instantiate(await program(), { wasi_snapshot_preview1: imports });
try {
    end(wasi.start(instance as Parameters<WASI["start"]>[0]));
} catch (error) {
    end(PANIC);
    console.error(`taotie: error: ${reasonOf(messageOf(error), stderr.text)}`);
}
