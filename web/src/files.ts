// The files of a scan: chosen, dropped, or all of a folder.

/** Files by their path. */
export type Files = Record<string, Blob>;

/** Formats of scans, such as `.ply`; taken from the command's help. */
declare const FORMATS: string[];

const isScan = (path: string): boolean => FORMATS.some((ending) => path.toLowerCase().endsWith(ending));

/** Returns the paths of all files that may be the scan, the largest first. */
export function scansIn(files: Files): string[] {
    const paths = Object.keys(files).filter(isScan);
    return paths.sort((a, b) => files[b]!.size - files[a]!.size);
}

/** Returns why no file is a scan. */
export const noScan = (files: Files): string =>
    `None of the files is a scan: ${Object.keys(files).slice(0, 5).join(", ") || "no files"}. Expected one of: ${FORMATS.join(", ")}`;

/** Returns the files that a person has chosen. */
export function ofList(list: FileList): Files {
    return Object.fromEntries([...list].map((file) => [file.webkitRelativePath || file.name, file]));
}

const fileOf = (entry: FileSystemFileEntry): Promise<File> => new Promise((done, failed) => entry.file(done, failed));

async function entriesOf(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
    const reader = folder.createReader();
    const all: FileSystemEntry[] = [];
    // Each reading returns some of them; the last none.
    for (;;) {
        const some = await new Promise<FileSystemEntry[]>((done, failed) => reader.readEntries(done, failed));
        if (some.length === 0) return all;
        all.push(...some);
    }
}

async function add(files: Files, entry: FileSystemEntry): Promise<void> {
    if (entry.isFile) files[entry.fullPath.slice(1)] = await fileOf(entry as FileSystemFileEntry);
    else for (const inner of await entriesOf(entry as FileSystemDirectoryEntry)) await add(files, inner);
}

/** Returns the files that a person has dropped, and those of dropped folders. */
export async function ofDrop({ items, files }: DataTransfer): Promise<Files> {
    // They must be asked for before anything is awaited.
    const entries = [...items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
    if (entries.length === 0) return ofList(files);
    const found: Files = {};
    for (const entry of entries) await add(found, entry);
    return found;
}
