// Text chunks in a PNG.

/** The length of the signature and the IHDR chunk, bytes. */
const HEAD = 33;

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
    let c = n;
    for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
    return c;
});

function crc(bytes: Uint8Array): number {
    let c = 0xffffffff;
    for (const byte of bytes) c = TABLE[(c ^ byte) & 0xff]! ^ (c >>> 8);
    return (c ^ 0xffffffff) >>> 0;
}

/** Builds an iTXt chunk. Source: PNG specification, 11.3.3.4. */
function chunk(keyword: string, text: string): Uint8Array<ArrayBuffer> {
    const content = new TextEncoder().encode(`iTXt${keyword}\0\0\0\0\0${text}`);
    const bytes = new Uint8Array(content.length + 8);
    const view = new DataView(bytes.buffer);
    view.setUint32(0, content.length - 4);
    bytes.set(content, 4);
    view.setUint32(bytes.length - 4, crc(content));
    return bytes;
}

/** Adds a text with a keyword to a PNG. */
export function withText(png: Blob, keyword: string, text: string): Blob {
    return new Blob([png.slice(0, HEAD), chunk(keyword, text), png.slice(HEAD)], { type: "image/png" });
}
