// Folders in memory, as the command sees them.

import { Directory, File, type Inode } from "@bjorn3/browser_wasi_shim";

/** The bytes of files by their path, with `/` between folders. */
export type Bytes = Record<string, ArrayBuffer>;

type Entries = Map<string, Inode>;

/** Returns the path's parts; throws if it leaves the folder. */
function partsOf(path: string): string[] {
    const parts = path.split("/").filter((part) => part !== "" && part !== ".");
    if (parts.length === 0 || parts.includes("..")) throw new Error(`invalid file name \`${path}\`: expected a relative path within the folder`);
    return parts;
}

function folderIn(entries: Entries, name: string): Entries {
    const found = entries.get(name);
    if (found instanceof Directory) return found.contents;
    const made: Entries = new Map();
    entries.set(name, new Directory(made));
    return made;
}

/** Returns a folder with these files. */
export function folderOf(files: Bytes): Entries {
    const root: Entries = new Map();
    for (const [path, bytes] of Object.entries(files)) {
        const parts = partsOf(path);
        const name = parts.pop()!;
        parts.reduce(folderIn, root).set(name, new File(bytes));
    }
    return root;
}

/** Returns all files of a folder by path. */
function* filesOf(entries: Entries, prefix = ""): Generator<[string, Uint8Array<ArrayBuffer>]> {
    for (const [name, entry] of entries) {
        if (entry instanceof File) yield [prefix + name, entry.data as Uint8Array<ArrayBuffer>];
        else if (entry instanceof Directory) yield* filesOf(entry.contents, `${prefix}${name}/`);
    }
}

/** Returns the files of a folder that are new, or that have been replaced since it was made of `before`. */
export function changedFiles(entries: Entries, before: Bytes): Record<string, Uint8Array<ArrayBuffer>> {
    return Object.fromEntries([...filesOf(entries)].filter(([path, data]) => before[path] !== data.buffer));
}
