// The imports of the program.

import { type Fd, type WASI } from "@bjorn3/browser_wasi_shim";

/** Returns the imports. The shim counts the characters of arguments, but writes their bytes. */
export function importsOf(wasi: WASI): Record<string, (...values: number[]) => number> {
    const args_sizes_get = (count: number, bytes: number): number => {
        const view = new DataView(wasi.inst.exports.memory.buffer);
        view.setUint32(count, wasi.args.length, true);
        view.setUint32(bytes, wasi.args.reduce((sum, arg) => sum + new TextEncoder().encode(arg).length + 1, 0), true);
        return 0;
    };
    return { ...(wasi.wasiImport as Record<string, (...values: number[]) => number>), args_sizes_get };
}

/** Returns imports that act on two paths, given what they do with the folders and paths. */
export function onTwoPaths(wasi: WASI, act: (from: [Fd, string], to: [Fd, string]) => number) {
    const text = (start: number, length: number): string =>
        new TextDecoder().decode(new Uint8Array(wasi.inst.exports.memory.buffer, start, length));
    return (fd: number, start: number, length: number, other: number, otherStart: number, otherLength: number): number =>
        act([wasi.fds[fd]!, text(start, length)], [wasi.fds[other]!, text(otherStart, otherLength)]);
}
