// The host of a viewer: the source of its bytes, and the address that keeps the link to its state.

import { texts } from "./texts";

/** Returns the bytes with a name. */
export type Blobs = (name: string) => Promise<ArrayBuffer>;

/** The source of a model. */
export interface Source {
    blobs: Blobs;
    /** The address of a still picture of the model; undefined if there is none. */
    still(): string | undefined;
    /** Identifies the model among those that this browser has shown. */
    key: string;
}

/** Keeps the link to the current state. */
export interface Address {
    read(): string;
    write(link: string): void;
    /** Calls back when something else has changed the link. */
    listen(heard: () => void): void;
}

async function unpacked(bytes: BlobPart): Promise<ArrayBuffer> {
    if (typeof DecompressionStream === "undefined") throw new Error(texts.noDecompression);
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
}

function decoded(base64: string): Uint8Array<ArrayBuffer> {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return bytes;
}

/** The address of the page, without its fragment. */
const pageUrl = (): string => location.href.split("#")[0]!;

/** Reads from elements of the page; each is read only once. */
export const ofPage = (): Source => ({
    blobs: async (name) => {
        const element = document.getElementById(`taotie-${name}`);
        const bytes = await unpacked(decoded(element?.textContent ?? ""));
        element?.remove();
        return bytes;
    },
    still: () => {
        const text = document.getElementById("taotie-still")?.textContent;
        return text ? `data:image/jpeg;base64,${text}` : undefined;
    },
    key: pageUrl(),
});

/** The file of the still picture. */
const STILL = "still.jpg";

async function fetched(address: URL): Promise<ArrayBuffer> {
    const response = await fetch(address).catch((error: unknown) => {
        throw address.protocol === "file:" ? new Error(texts.fromDisk) : error;
    });
    if (!response.ok) throw new Error(texts.notFetched(address.pathname.split("/").at(-1)!, response.status));
    return response.arrayBuffer();
}

/** Reads the files written by `taotie view --folder`: models and the still
 * picture are stored unchanged, everything else is compressed. */
const ofNamed =
    (read: (file: string) => Promise<ArrayBuffer>): Blobs =>
    async (name) => {
        if (name === "asset" || name === "scan") return read(`${name}.glb`);
        return unpacked(await read(`${name}.bin`));
    };

/** Reads such files from a folder on a server. */
export function ofFolder(path: string): Source {
    const folder = new URL(path.endsWith("/") ? path : `${path}/`, document.baseURI);
    return {
        blobs: ofNamed((file) => fetched(new URL(file, folder))),
        still: () => new URL(STILL, folder).href,
        key: folder.href,
    };
}

/** Reads such files from memory. */
export function ofFiles(files: Record<string, BlobPart>): Source {
    return {
        blobs: ofNamed(async (file) => {
            const bytes = files[file];
            if (bytes === undefined) throw new Error(texts.notGiven(file));
            return new Blob([bytes]).arrayBuffer();
        }),
        still: () => {
            const bytes = files[STILL];
            return bytes === undefined ? undefined : URL.createObjectURL(new Blob([bytes], { type: "image/jpeg" }));
        },
        key: pageUrl(),
    };
}

/** The fragment of the page's address. */
export const pageAddress: Address = {
    read: () => location.hash,
    write: (link) => {
        const address = pageUrl() + (link && `#${link}`);
        if (address !== location.href) history.replaceState(null, "", address);
    },
    listen: (heard) => addEventListener("hashchange", heard),
};
