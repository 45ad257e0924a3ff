// Where a viewer lives: what gives it its bytes, and what keeps the link to what it shows.

import { texts } from "./texts";

/** Gives the bytes of a name. */
export type Blobs = (name: string) => Promise<ArrayBuffer>;

/** Keeps the link to what is shown. */
export interface Address {
    read(): string;
    write(link: string): void;
    /** Calls back when somebody else has written it. */
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

/** The bytes that elements of the page hold; each is read once. */
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

/** The bytes of the files that `taotie view --folder` writes: models as they are, all else compressed. */
const ofNamed =
    (read: (file: string) => Promise<ArrayBuffer>): Blobs =>
    async (name) => {
        if (name === "asset" || name === "scan") return read(`${name}.glb`);
        return unpacked(await read(`${name}.bin`));
    };

/** The bytes of such files in a folder of a server. */
export const ofFolder = (folder: URL): Blobs => ofNamed((file) => fetched(new URL(file, folder)));

/** The bytes of such files in memory. */
export const ofFiles = (files: Record<string, BlobPart>): Blobs =>
    ofNamed(async (file) => {
        const bytes = files[file];
        if (bytes === undefined) throw new Error(texts.notGiven(file));
        return new Blob([bytes]).arrayBuffer();
    });

/** The fragment of the page's own address. */
export const pageAddress: Address = {
    read: () => location.hash,
    write: (link) => {
        const address = location.href.split("#")[0] + (link && `#${link}`);
        if (address !== location.href) history.replaceState(null, "", address);
    },
    listen: (heard) => addEventListener("hashchange", heard),
};
