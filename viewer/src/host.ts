// The host of a viewer: the source of its bytes, and the address that keeps the link to its state.

import { texts } from "./texts";

/** Returns the bytes with a name. */
export type Blobs = (name: string) => Promise<ArrayBuffer>;

/** Keeps the link to the current state. */
export interface Address {
    read(): string;
    write(link: string): void;
    /** Calls back when something else has changed the link. */
    listen(heard: () => void): void;
}

async function unpacked(bytes: BlobPart): Promise<ArrayBuffer> {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
}

function decoded(base64: string): Uint8Array<ArrayBuffer> {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return bytes;
}

/** Reads bytes from elements of the page; each is read only once. */
export const ofPage: Blobs = (name) => {
    const element = document.getElementById(`taotie-${name}`);
    const bytes = decoded(element?.textContent ?? "");
    element?.remove();
    return unpacked(bytes);
};

async function fetched(address: URL): Promise<ArrayBuffer> {
    const response = await fetch(address);
    if (!response.ok) throw new Error(texts.notFetched(address.pathname.split("/").at(-1)!, response.status));
    return response.arrayBuffer();
}

/** Reads the files written by `taotie view --folder`: models are stored unchanged, everything else is compressed. */
const ofNamed =
    (read: (file: string) => Promise<ArrayBuffer>): Blobs =>
    async (name) => {
        if (name === "asset" || name === "scan") return read(`${name}.glb`);
        return unpacked(await read(`${name}.bin`));
    };

/** Reads such files from a folder on a server. */
export const ofFolder = (folder: URL): Blobs => ofNamed((file) => fetched(new URL(file, folder)));

/** Reads such files from memory. */
export const ofFiles = (files: Record<string, BlobPart>): Blobs =>
    ofNamed(async (file) => {
        const bytes = files[file];
        if (bytes === undefined) throw new Error(texts.notGiven(file));
        return new Blob([bytes]).arrayBuffer();
    });

/** The fragment of the page's address. */
export const pageAddress: Address = {
    read: () => location.hash,
    write: (link) => {
        const address = location.href.split("#")[0] + (link && `#${link}`);
        if (address !== location.href) history.replaceState(null, "", address);
    },
    listen: (heard) => addEventListener("hashchange", heard),
};
