// The named bytes of a page: elements of it, or files beside it.

import { texts } from "./texts";

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

async function fetched(name: string): Promise<ArrayBuffer> {
    const response = await fetch(name);
    if (!response.ok) throw new Error(texts.notFetched(name, response.status));
    return response.arrayBuffer();
}

/** The bytes of this name. */
export async function blob(name: string): Promise<ArrayBuffer> {
    const element = document.getElementById(name);
    if (element instanceof HTMLScriptElement) {
        const bytes = decoded(element.textContent ?? "");
        element.remove();
        return unpacked(bytes);
    }
    return name === "asset" || name === "scan" ? fetched(`${name}.glb`) : unpacked(await fetched(`${name}.bin`));
}
